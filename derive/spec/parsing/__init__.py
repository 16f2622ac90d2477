"""Single values of a specification: names, numbers, polynomials, functions of time, and the faults found in them."""

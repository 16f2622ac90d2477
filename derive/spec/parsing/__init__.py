"""Single values of a specification: names, numbers, polynomials, functions of time, and their faults."""

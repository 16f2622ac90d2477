"""Numbers that a specification keeps in other files: the arrays of a finite-element body, and reference curves."""

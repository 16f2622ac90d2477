"""Bodies given by finite-element nodes: their files, arrays, units and checks."""

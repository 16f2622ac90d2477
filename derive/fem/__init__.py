"""Flexible bodies from finite-element programs: readers of their files, and the body that one describes."""

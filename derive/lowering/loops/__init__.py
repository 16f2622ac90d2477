"""Lowering to loops over the assumed modes: the size of the code does not depend on the number of modes."""

"""The lowering of a mechanism to loops over its bodies and joints, whose code does not grow with their number."""

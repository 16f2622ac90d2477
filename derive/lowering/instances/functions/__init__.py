"""The functions of a mechanism, each in loops over its bodies and joints."""

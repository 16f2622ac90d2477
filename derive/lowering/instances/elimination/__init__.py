"""The elimination of joints from the system that is left of a mechanism without the coordinates of its bodies."""

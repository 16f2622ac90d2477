"""Trees of rigid bodies in relative coordinates in loops over their links, whose code does not grow with these."""

"""Trees of rigid bodies in space: the coordinates of joints between bodies that move, and recursions along them."""

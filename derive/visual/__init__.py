"""Pictures: sparsity patterns, line charts, and the player of a motion."""

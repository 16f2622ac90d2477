"""C99 source and header of a model."""

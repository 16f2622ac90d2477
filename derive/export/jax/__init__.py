"""Models as functions of JAX, on arrays."""

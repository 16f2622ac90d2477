"""The stability of methods: limits of steps, drift, formulations, conditioning, and how each failure is avoided."""

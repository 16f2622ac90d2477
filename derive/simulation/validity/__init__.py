"""Whether the model of a beam is valid in a run: what is monitored, its limits, and the errors they imply."""

"""Notes for the user on a model: its limits, the properties of its bodies, and what is eliminated from it."""

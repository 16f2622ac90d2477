"""Parts from ANSYS."""

"""Parts from Abaqus."""

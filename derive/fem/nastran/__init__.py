"""Parts from Nastran."""

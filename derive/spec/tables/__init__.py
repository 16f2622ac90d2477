"""The tables of a specification as pydantic models: the keys and their meaning."""

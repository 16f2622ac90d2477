"""The tables of a specification as pydantic models: which keys there are, and what each of them means."""

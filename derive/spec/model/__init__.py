"""Specifications as frozen data: what `read` returns and `derive` takes. Imports no other package."""

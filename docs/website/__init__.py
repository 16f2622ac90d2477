"""The site of Tisserand: its pages are put together from the repository, and Sphinx is extended by what they need."""

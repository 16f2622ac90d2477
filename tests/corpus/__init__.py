"""Random valid scenes, each from a seed, on which every command runs: see `run.py`."""

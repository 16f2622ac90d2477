"""Studies of scenes: what the frame of the beams costs, and what it does to pivots."""

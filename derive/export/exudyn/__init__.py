"""Bodies of Exudyn: its generic second-order objects, and its floating-frame bodies."""

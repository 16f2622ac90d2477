"""Analysis of constraints: scaling, redundancy, neighbouring states, projection."""

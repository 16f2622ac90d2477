"""Classes and groups of bodies, joints, forces and outputs that have one code, and the equations of each."""

"""The motion of bodies in the plane and in space: kinematics, moments of fields over the mass, material points."""

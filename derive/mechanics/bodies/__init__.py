"""Kinds of bodies: the planar beam, the planar rigid body, and the body in space given by its modes."""

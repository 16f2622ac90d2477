"""Legitimate refusals of a valid scene by a command: parts of its message, each with the reason why it does not apply.

Anything else that ends with exit code 2 is a finding.
"""

from __future__ import annotations

import re

REFUSALS: dict[str, str] = {
    r"(SUNDIALS|SuiteSparse) with KLU was not found": "the machine lacks a library; the message says how to install it",
    r"a scene is needed, and this is a single (body|beam)": "studies compare models of scenes",
    r"a planar scene is needed, and this is a scene in space": "studies compare models of planar scenes",
    r"a sweep runs scenes and single beams": "bodies in space are swept from Python",
    r"a ladder compares a plot; add one": "a ladder of models is compared by a plot",
    r"which each model has in its own way": "a plot against the floating frame of a beam is not the same in each model",
    r"this ends each run at its own; leave `until` out": "models are compared over the same time",
    r"integrates scenes; for the body \w+ choose": "integrators of scenes do not take bodies in space",
    r'there is no column or plot "\w+_phi"': "the corpus guesses one; this beam is carried by a drive",
    r"all numbers of this body are parameters": "a symbolic body has nothing to simulate",
    r"in the frame \w+: .* shapes do not fulfil": "a study of frames needs shapes that fit both",
    r"in the frame \w+: the ansatz is empty after the conditions": "likewise",
    r"families of shape functions are for beams in one piece": "they bend as a whole",
    r"hold beams along( or about)? their axes more often": "the message names the frame in which they do not resist",
    r"binaries for other platforms need Zig": "the machine lacks a compiler; the message says how to install it",
    r"no static equilibrium is found at t": "modes are those about an equilibrium; the message names --at",
    r"Their multipliers have no unique value": "the message names what computes reactions of least norm",
    r"a pivot vanishes in every order": "a study of pivots compares none where joints are redundant",
    r"solves for reactions, which have to be unique": "redundant joints in implicit methods; the message names others",
    r"all motion is prescribed; nothing is left to be computed": "there is no motion to compute",
    r"is not that of a rigid rotation of the whole scene": "the stability is that of steady motions",
    r"no model has a steady motion": "likewise",
    r"no motion is steady, since these functions of time never come to rest": "stability is that of a steady motion",
    r"loops have no derivatives by parameters": "the message names the lowering that has them",
    r"loops in relative coordinates( of more than \d+ velocities)? have": "likewise",
    r"trees of more than \d+ velocities in loops have no angular velocities": "likewise",
    r"an export for arrays or symbols has straight-line code": "likewise",
    r"the steady motion that Newton's method finds is far from the initial state": "the message says what to write",
    r"the mass matrix is no longer positive definite": "truncated beams bend too far; the message says what to write",
    r"the mechanism is at a dead centre at t = ": "its motion comes there; the message says what to change",
    r"needs a reference that differs by at most a third of it from coarser models": "none that is tried does",
    r"With rk4 a step shorter than \S+ s may pass, such as --step": "its steps are those of the initial state",
    r"vanishes all the time, so that no error of it is known": "a plot of a beam that nothing bends",
    r"there is no beam( and no finite-element body)? here": "there is no flexible body whose models could differ",
    r"a simulation needs its value; write one, such as": "an input without a function can be exported, not simulated",
    r"the floating-frame body of Exudyn is one in space": "the interface is for bodies given by their nodes",
    r"export the scene with --to exudyn, or leave this out": "the message names the interface for all scenes",
    r"the links of a URDF are rigid|a URDF describes rigid bodies in space": "rigid bodies in space alone",
    r"a URDF (has no|prescribes no)|a link of a URDF needs|a URDF is a tree": "the message says what a URDF can have",
    r"Exudyn has no joint that removes": "the message names those that it has",
    r"body of Exudyn (needs mass|has modes|has displacements)": "the message says what to write",
}


def refusal(message: str) -> str | None:
    """The pattern of the list that a message meets; None if it is no legitimate refusal."""
    return next((pattern for pattern in REFUSALS if re.search(pattern, message)), None)

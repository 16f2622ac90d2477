"""Modes of a body that cannot be had of what its files give."""

import numpy as np
import pytest
from bodies import LUMPED_BODY, MODAL_BODY, MODES, POSITIONS, STIFFNESS, N, without
from test_body_faults import problems

from derive.spec.construction.bodies import nodal_body

NO_MODES = (
    "there is nothing to take modes from: add modes and modal_stiffness, or a stiffness to compute them with mass, "
    "or write modes = 0 for a rigid body"
)
NO_STIFFNESS = "the modes have no stiffness: add modal_stiffness, or stiffness"
COMPUTED = "modes that are computed are orthonormal; leave this out, or give the modes"


@pytest.mark.parametrize(
    ("arrays", "keywords", "path", "message"),
    [
        (without(LUMPED_BODY, "stiffness"), {}, "body.nodes", NO_MODES),
        (without(LUMPED_BODY, "stiffness"), {"modes": 1}, "body.modes", NO_MODES),
        (
            LUMPED_BODY,
            {},
            "body.modes",
            "this key is missing; write modes = 8 to have so many computed from mass and stiffness",
        ),
        (
            LUMPED_BODY,
            {"modes": 7},
            "body.modes",
            "7 modes are too many: 4 nodes have 12 displacements, of which 6 are rigid motion, so that there are 6 at "
            "most",
        ),
        (
            MODAL_BODY | {"modes": np.ones((7, N, 3)), "modal_stiffness": np.ones(7)},
            {},
            "body.modes",
            "7 modes are too many: 4 nodes have 12 displacements, of which 6 are rigid motion, so that there are 6 at "
            "most",
        ),
        (
            {"positions": POSITIONS[:1], "mass": [1.0], "stiffness": STIFFNESS[:3, :3]},
            {"modes": 1},
            "body.modes",
            "1 modes are too many: 1 nodes have 3 displacements, of which 6 are rigid motion, so that there are 0 at "
            "most",
        ),
        (
            {
                "positions": np.ones((110, 3)),
                "mass": np.ones(110),
                "modes": np.ones((301, 110, 3)),
                "modal_stiffness": np.ones(301),
            },
            {},
            "body.modes",
            "there are 301 modes in the files, and 300 are allowed; keep fewer: modes = 8",
        ),
        (without(MODAL_BODY, "modal_stiffness"), {}, "body.nodes", NO_STIFFNESS),
        (LUMPED_BODY, {"modes": 2, "orthonormal": False}, "body.orthonormal", COMPUTED),
    ],
)
def test_modes_that_cannot_be_had(arrays, keywords, path, message):
    arrays = {key: np.asarray(array) for key, array in arrays.items()}
    assert problems(nodal_body, "b", arrays, units="SI", **keywords) == [(path, message)]


def test_no_modes_of_those_given_need_no_stiffness():
    assert nodal_body("b", without(MODAL_BODY, "modal_stiffness"), units="SI", modes=0).modes == 0
    assert nodal_body("b", MODAL_BODY | {"modes": MODES}, units="SI", modes=1).modes == 1

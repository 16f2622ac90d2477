"""Outputs that loops over instances compute with one code have descriptions of their own, as in straight-line code."""

from __future__ import annotations

from typing import Any

import derive
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances

BEAM = {
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "bending_stiffness": 3,
    "mass": 1,
    "length": 1,
    "markers": {"left": -1, "middle": 0, "right": 1},
}


def of_beam(k: int) -> dict[str, Any]:
    """Outputs that name a beam, its bearing and its spring."""
    beam, middle = f"link[{k}]", f"link[{k}].middle"
    return {
        f"moment_{k}": {"kind": "bending_moment", "section": middle},
        f"shear_{k}": {"kind": "shear_force", "section": middle},
        f"rate_{k}": {"kind": "velocity", "marker": middle, "frame": f"{beam}.left"},
        f"angle_{k}": {"kind": "angle", "between": [f"{beam}.left", f"{beam}.right"]},
        f"chord_{k}": {"kind": "deflection", "marker": middle, "chord": [f"{beam}.left", f"{beam}.right"]},
        f"bearing_{k}": {"kind": "reaction", "joint": f"bearing_{k}"},
        f"spring_{k}": {"kind": "spring", "spring": f"spring_{k}"},
    }


def test_descriptions_name_what_each_output_names() -> None:
    scene = derive.scene(
        "twins",
        ground={"a0": [0, 0], "a1": [3, 0]},
        bodies={"link": {**BEAM, "count": 2}},
        joints={f"bearing_{k}": {"kind": "revolute", "between": [f"ground.a{k}", f"link[{k}].left"]} for k in (0, 1)},
        springs={f"spring_{k}": {"between": [f"ground.a{k}", f"link[{k}].right"], "stiffness": 2} for k in (0, 1)},
        outputs={**of_beam(0), **of_beam(1)},
    )
    mechanism = derive.derive(scene)
    texts = [
        {output.name: output.doc for output in model.outputs}
        for model in (lower_flat(mechanism.expanded()), lower_instances(mechanism))
    ]
    assert texts[0] == texts[1]
    assert texts[1]["moment_1"] == "bending moment at link[1].middle, from equilibrium"
    assert texts[1]["spring_1_1"] == "force of spring spring_1 on link[1].right along e1"

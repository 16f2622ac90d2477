"""Imported robots are the mechanisms that Pinocchio makes of their descriptions; it reads those that are exported."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from pinocchio_models import Array, PinocchioModel, pinocchio_model
from programs import package
from scipy.spatial.transform import Rotation

from derive.export.urdf.description import urdf_text
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot
from derive.urdf.written_scene import Base, written_scene

pytestmark = pytest.mark.hosts

LIMIT = 1e-12
"""The largest difference, relative to the largest number."""
OWN = Path(__file__).parents[1] / "urdf" / "arm.urdf"
ROBOTS: dict[str, Base] = {
    "ur_description/urdf/ur5_robot.urdf": "fixed",
    "panda_description/urdf/panda.urdf": "fixed",
    "baxter_description/urdf/baxter.urdf": "fixed",
    "solo_description/robots/solo12.urdf": "free",
    "simple_humanoid_description/urdf/simple_humanoid.urdf": "free",
    "talos_data/robots/talos_full_v2.urdf": "free",
    "centauro_description/urdf/centauro.urdf": "free",
}
"""Robots of others, with 6 to 44 joints, and how their roots are held."""


@pytest.fixture(scope="module")
def pin() -> ModuleType:
    return package("pinocchio")


def robot_file(name: str) -> Path:
    """A robot of the package example-robot-data of the extra `hosts`."""
    try:
        data = distribution("example-robot-data")
    except PackageNotFoundError:
        pytest.skip("example-robot-data is missing: pip install tisserand[hosts]")
    return Path(str(data.locate_file(f"cmeel.prefix/share/example-robot-data/robots/{name}")))


def read_by_pinocchio(pin: ModuleType, path: Path, base: Base) -> Any:
    """The model that Pinocchio makes of a description."""
    free = (pin.JointModelFreeFlyer(),) if base == "free" else ()
    return pin.buildModelFromUrdf(str(path), *free)


def written(path: Path, base: Base) -> str:
    """The specification of a robot, with its angles as they are written, since Pinocchio rounds none."""
    return written_scene(read_robot(path, keep_angles=True), base, str(path)).text


def joints_of(own: PinocchioModel, other: Any) -> list[tuple[int, int]]:
    """The numbers of the joints of the scene, and of those with their names in the other model."""
    names = {table["between"][1].split(".")[0]: name for name, table in own.scene["joints"].items()}
    every = {name: i for i, name in enumerate(other.names)}
    pairs = []
    for body, number in own.joints.items():
        if number:  # a free body of the scene has no joint by whose name it could be found
            free = next((n for n in ("root_joint", "loose", f"{body}_free") if n in every), "")
            pairs.append((number, every[names.get(body, free)]))
    return pairs


def neutral(own: PinocchioModel) -> Array:
    """The coordinates in which joints are in their zero positions and free bodies where they start."""
    q = own.pin.neutral(own.model)
    for body, table in own.scene["bodies"].items():
        if "start" in table:
            axes = {name: np.array(axis, float) for name, axis in table["start"]["rotation"].items()}
            matrix = np.column_stack([axes["x"], np.cross(axes["z"], axes["x"]), axes["z"]])
            place = np.concatenate([table["start"]["position"], Rotation.from_matrix(matrix).as_quat()])
            first = own.model.joints[own.joints[body]].idx_q
            q[first : first + 7] = place
    return np.asarray(q)


def differences(own: PinocchioModel, other: Any, count: int) -> list[float]:
    """Differences of mass matrices, of bias and gravity, and of accelerations in random states."""
    pin, model, rng = own.pin, own.model, np.random.default_rng(5)
    columns = np.zeros(model.nv, int)
    for mine, theirs in joints_of(own, other):
        first, second = model.joints[mine], other.joints[theirs]
        assert first.nv == second.nv
        columns[first.idx_v : first.idx_v + first.nv] = range(second.idx_v, second.idx_v + second.nv)
    assert sorted(columns) == list(range(other.nv))
    data, other_data, result = model.createData(), other.createData(), []
    for _ in range(count):
        w, v, load = rng.uniform(-1.5, 1.5, (3, model.nv))
        there = [np.zeros(model.nv) for _ in range(3)]
        for array, values in zip(there, (w, v, load), strict=True):
            array[columns] = values
        q, q_there = pin.integrate(model, neutral(own), w), pin.integrate(other, pin.neutral(other), there[0])
        results = []
        for m, d, at, speed, force in ((model, data, q, v, load), (other, other_data, q_there, there[1], there[2])):
            mass = pin.crba(m, d, at)
            mass = np.triu(mass) + np.triu(mass, 1).T
            results.append((mass.copy(), pin.nle(m, d, at, speed).copy(), pin.aba(m, d, at, speed, force).copy()))
        (mass, bias, a), (mass_there, bias_there, a_there) = results
        picked = mass_there[np.ix_(columns, columns)], bias_there[columns], a_there[columns]
        for x, y in zip((mass, bias, a), picked, strict=True):
            result.append(float(abs(x - y).max() / abs(y).max()))
    return result


CASES = {"arm": (OWN, "fixed"), **{name.rsplit("/", 1)[1]: (name, base) for name, base in ROBOTS.items()}}


@pytest.mark.parametrize(("path", "base"), CASES.values(), ids=[*CASES])
def test_robots_are_those_of_pinocchio(path: Path | str, base: Base, pin: ModuleType) -> None:
    """Mass matrix, bias, gravity and accelerations of the imported scene are those of the reader of Pinocchio."""
    file = path if isinstance(path, Path) else robot_file(path)
    own, other = pinocchio_model(pin, written(file, base)), read_by_pinocchio(pin, file, base)
    assert max(differences(own, other, 20)) < LIMIT


@pytest.mark.parametrize(("path", "base"), CASES.values(), ids=[*CASES])
def test_pinocchio_reads_what_is_exported(path: Path | str, base: Base, pin: ModuleType, tmp_path: Path) -> None:
    """The description of an imported robot is that of the same robot."""
    text = written(path if isinstance(path, Path) else robot_file(path), base)
    (tmp_path / "robot.urdf").write_text(urdf_text(parse(text)))
    own, other = pinocchio_model(pin, text), read_by_pinocchio(pin, tmp_path / "robot.urdf", "fixed")
    assert max(differences(own, other, 20)) < LIMIT

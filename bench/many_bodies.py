"""Chains of 1 to 1000 hinged beams: seconds to prepare and of a step of the adaptive integrator, against their number.

python bench/many_bodies.py [--sizes 3 10 30 100 300 1000] [--kind revolute] [--duration 0.02]

The last column is the exponent of the seconds per step between a number of beams and the one before. Scenes below the
limit of `derive.lowering.instances.lower` are straight-line code, and those above it loops over the beams.
"""

from __future__ import annotations

import argparse
import math
import resource
import time

import derive
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

LINK = """
[bodies.link_{i}]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
mass = 0.05
length = 0.1
bending_stiffness = 0.2
markers = {{ left = -1, right = 1 }}
start = {{ position = [{x:.3f}, 0] }}
"""


def chain(count: int, kind: str, duration: float) -> Scene:
    """A straight chain of beams that falls from a horizontal position, hinged at one end."""
    text = 'name = "chain"\n[scene]\ngravity = [0, -9.81]\n[ground.markers]\nhook = [0, 0]\n'
    text += "".join(LINK.format(i=i, x=0.05 + 0.1 * i) for i in range(count))
    text += '[joints.hinge]\nkind = "revolute"\nbetween = ["ground.hook", "link_0.left"]\n'
    for i in range(count - 1):
        text += f'[joints.joint_{i}]\nkind = "{kind}"\nbetween = ["link_{i}.right", "link_{i + 1}.left"]\n'
    scene = parse(text + f"[simulation]\nduration = {duration}\noutput = {duration / 4}\n")
    assert isinstance(scene, Scene)
    return scene


def main() -> None:
    """Print a line for each number of beams."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 30, 100, 300, 1000])
    parser.add_argument("--kind", default="revolute")
    parser.add_argument("--duration", type=float, default=0.02)
    options = parser.parse_args()
    print("beams  lowering   prepare, s  run, s  steps  evaluations  us per step  MB  exponent")
    before: tuple[int, float] | None = None
    for count in options.sizes:
        scene = chain(count, options.kind, options.duration)
        began = time.perf_counter()
        run = PreparedRun(scene, complete=False)
        prepared = time.perf_counter()
        trajectory = run.trajectory()
        ended = time.perf_counter()
        cost = trajectory.solution.cost
        step = cost.seconds / cost.steps
        exponent = math.log(step / before[1]) / math.log(count / before[0]) if before else math.nan
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"{count:5}  {run.model.lowering:9}  {prepared - began:10.2f}  {ended - prepared:6.2f}  {cost.steps:5}"
            f"  {cost.evaluations:11}  {step * 1e6:11.1f}  {memory:.0f}  {exponent:.2f}",
            flush=True,
        )
        before = count, step


if __name__ == "__main__":
    print(f"tisserand {derive.__version__}")
    main()

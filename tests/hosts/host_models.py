"""Scenes that the tests of hosts export, with force and motion inputs, outputs and parameters."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import derive
from conftest import ROOT
from derive.export.host_model import HostModel, host_model
from derive.spec.model.specification import Specification
from derive.spec.toml.read import parse

PUSHED = """
name = "pushed"
ground.markers = { pivot = [0, 0] }
scene.gravity = [0, -9.81]

[bodies.rod]
mass = 0.5
length = 1.0
bending_stiffness = { symbol = "EI", default = 10, unit = "N m^2" }
ansatz = ["1", "xi", "xi^2", "xi^3"]
markers = { root = -1, tip = 1 }
start = { angle = -1.2 }

[joints.pivot]
kind = "revolute"
between = ["ground.pivot", "rod.root"]
start = { speed = 2 }

[inputs.push]
unit = "N"
value = "0.3*cos(6*t)"

[forces.push]
at = "rod.tip"
components = [{ input = "push" }, 0]

[outputs.tip]
kind = "position"
marker = "rod.tip"

[outputs.support]
kind = "reaction"
joint = "pivot"

[simulation]
duration = 2
output = 0.005
"""
"""A flexible pendulum with a force as its input."""

STEERED = """
name = "steered"
parameters = { amplitude = { default = 0.5, unit = "rad" } }
ground.markers = { pivot = [0, 0] }
scene.gravity = [0, -9.81]

[bodies.arm]
mass = 2
length = 1
bending_stiffness = 100
ansatz = ["1", "xi", "xi^2"]
markers = { root = -1, tip = 1 }

[joints.pivot]
kind = "revolute"
between = ["ground.pivot", "arm.root"]

[inputs.angle]
unit = "rad"
value = "amplitude*(1 + sin(4*t)) + 3*t^2"

[inputs.side]
unit = "N"

[drives.motor]
joint = "pivot"
motion = { input = "angle" }

[forces.side]
at = "arm.tip"
components = [0, { input = "side" }]

[outputs.torque]
kind = "drive"
drive = "motor"

[simulation]
duration = 1
output = 0.01
"""
"""An arm whose rotation is an input with two time derivatives, and a force that has no value in simulations."""

LINKAGE = """
name = "linkage"
scene.gravity = [0, -9.81]
ground.markers = { a = [0, 0], b = [{ symbol = "distance", default = 1.2 }, 0] }
[bodies.left]
mass = { symbol = "m", default = 1.3 }
length = { symbol = "l", default = 1.0 }
bending_stiffness = { symbol = "EI", default = 200 }
markers = { end = -1, tip = 1 }
start = { position = [0.4, 0.4], angle = 0.8, guess = true }
[bodies.right]
mass = 0.7
length = 0.9
bending_stiffness = 300
markers = { end = 1, tip = -1 }
start = { position = [0.9, 0.6], angle = -0.6, guess = true }
[bodies.slider]
mass = 0.4
inertia = 0.05
markers = { pin = [0, 0] }
start = { position = [1.3, 0.0], guess = true }
[joints.first]
kind = "revolute"
between = ["ground.a", "left.end"]
[joints.middle]
kind = "revolute"
between = ["left.tip", "right.tip"]
[joints.last]
kind = "revolute"
between = ["right.end", "slider.pin"]
[joints.guide]
kind = "translational"
between = ["ground.b", "slider.pin"]
[inputs.push]
value = "2"
unit = "N"
[forces.push]
at = "slider.pin"
components = [{ input = "push" }, 0]
[simulation]
duration = 3
output = 0.01
tolerance = 1e-9
"""
"""Two bodies and a slider, with parameters in the constraints, and a force as its input."""

CHAIN = """
name = "chain_COUNT"
scene.gravity = [0, -9.81]
ground.markers = { hook = [0, 0] }

[bodies.link]
count = COUNT
ansatz = ["1", "xi", "xi^2", "xi^3"]
mass = 0.05
length = 0.1
bending_stiffness = { symbol = "EI", default = 0.2, unit = "N m^2" }
markers = { left = -1, right = 1 }
start = { position = ["0.05 + 0.1*i", 0] }

[joints.hinge]
kind = "revolute"
between = ["ground.hook", "link[0].left"]

[joints.weld]
count = LAST
kind = "weld"
between = ["link[i].right", "link[i+1].left"]

[inputs.push]
value = 0.3
unit = "N"

[forces.push]
at = "link[LAST].right"
components = [{ input = "push" }, 0]

[outputs.tip]
kind = "position"
marker = "link[LAST].right"

[outputs.support]
kind = "reaction"
joint = "hinge"

[simulation]
duration = 0.05
output = 0.005
"""
CHAINS = {f"chain_{count}": CHAIN.replace("COUNT", str(count)).replace("LAST", str(count - 1)) for count in (3, 100)}
"""Chains of flexible beams: a few in straight-line code, many in loops, with a parameter, an input and outputs."""

SPATIAL = """
name = "turning"
scene.gravity = [0, 0, -9.81]

[ground.markers]
bearing = { at = [0, 0.12, 0.1], rotation = { z = [-1, 0, 0], x = [0, 1, 0] } }
guide = { at = [0, 0, 0], rotation = { z = [1, 0, 0], x = [0, 1, 0] } }

[bodies.crank]
mass = 0.12
centre = [0.04, 0, 0]
inertia = [1e-5, 1e-4, 1e-4, 0, 0, 0]
markers = { hub = [0, 0, 0], pin = [0.08, 0, 0] }

[bodies.rod]
mass = { symbol = "m", default = 0.5, unit = "kg" }
inertia = [4e-4, 4e-3, 4e-3, 0, 0, 0]
markers = { ball = [-0.15, 0, 0], yoke = { at = [0.15, 0, 0], rotation = { x = [0, 0, 1], z = [0, 1, 0] } } }
start = { guess = true, position = [0.1, 0.1, 0.05], rotation = { axis = [0, 0, 1], angle = -0.8 } }

[bodies.slider]
mass = 2
inertia = [1e-3, 1e-3, 1e-3, 0, 0, 0]
start = { guess = true, position = [0.2, 0, 0] }

[bodies.slider.markers]
pin = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
shoe = { at = [0, 0, 0], rotation = { z = [1, 0, 0], x = [0, 1, 0] } }

[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.hub"]
start = { angle = 0, speed = 6 }

[joints.ball]
kind = "spherical"
between = ["crank.pin", "rod.ball"]

[joints.yoke]
kind = "universal"
between = ["slider.pin", "rod.yoke"]

[joints.guide]
kind = "prismatic"
between = ["ground.guide", "slider.shoe"]

[inputs.push]
value = 0.3
unit = "N"

[forces.push]
at = "slider.shoe"
force = [{ input = "push" }, 0, 0]

[outputs.pin]
kind = "position"
marker = "crank.pin"

[simulation]
duration = 0.4
output = 0.01
"""
"""A slider-crank in space, with a quaternion among its coordinates, a parameter, an input and an output."""

EVERYWHERE = CHAINS | {"turning": SPATIAL}
"""The scenes that all interfaces take."""

LINK = """
name = "links_COUNT"

[scene]
coordinates = "relative"
lowering = "instances"
gravity = [0, 0.5, { symbol = "g", default = -9.81, unit = "m/s^2" }]

[ground.markers]
pivot = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }

[bodies.link]
count = COUNT
mass = { symbol = "m", default = 1.5, unit = "kg" }
centre = [0.1, 0, 0.02]
inertia = [0.4, 0.5, 0.3, 0.01, 0.02, -0.015]

[bodies.link.markers]
near = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
far = { at = [0.2, 0, 0], rotation = { z = [0, 0.8, 0.6], x = [1, 0, 0] } }

[joints.hinge]
kind = "revolute"
between = ["ground.pivot", "link[0].near"]
start = { angle = 0.3, speed = 1 }

[joints.elbow]
count = LAST
kind = "revolute"
between = ["link[i].far", "link[i+1].near"]

[inputs.push]
value = 0.3
unit = "N m"

[torques.motor]
joint = "hinge"
value = { input = "push" }

[springs.coil]
count = LAST
kind = "rotational"
between = ["link[i].far", "link[i+1].near"]
stiffness = 40
damping = 2

[outputs.angle]
kind = "joint"
joint = "hinge"

[outputs.speed]
kind = "joint_speed"
joint = "elbow[0]"

[simulation]
duration = 0.05
output = 0.005
"""
LINKS = {f"links_{count}": LINK.replace("COUNT", str(count)).replace("LAST", str(count - 1)) for count in (3, 100)}
"""Chains of rigid bodies in relative coordinates, in loops over their links, with parameters, an input and outputs."""

HINGED = """
name = "NAME"
scene.gravity = [0, 0, -9.81]
ground.markers = { pivot = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } } }

[bodies.rod]
BODY

[joints.hinge]
kind = "revolute"
between = ["ground.pivot", "rod.left"]
start = { angle = 0.3, speed = 2 }

[inputs.push]
value = 0.2
unit = "N"

[forces.push]
at = "rod.right"
force = [0, { input = "push" }, 0]

[outputs.tip]
kind = "position"
marker = "rod.right"

[outputs.support]
kind = "reaction"
joint = "hinge"

[simulation]
duration = 0.1
output = 0.01
"""
BEAM = """
length = 3
mass = 8
rotary_inertia = 5e-3
bending_stiffness = { symbol = "EI", default = 3600, unit = "N m^2" }
lateral = { bending_stiffness = 900 }
torsion = { ansatz = ["xi"], stiffness = 950 }
ansatz = ["1", "xi", "xi^2", "xi^3"]
order = 2
markers = { left = { at = -1, rotation = { z = [0, 1, 0], x = [1, 0, 0] } }, right = 1 }
"""
CRAIG_BAMPTON = f"""
nodes = "{ROOT.as_posix()}/examples/spatial_rod.npz"
units = "SI"
modes = 7
interface = ["left", "right"]

[bodies.rod.markers]
left = {{ nodes = [{", ".join(map(str, range(9)))}], rotation = {{ z = [0, 1, 0], x = [1, 0, 0] }} }}
right = {{ nodes = [{", ".join(map(str, range(108, 117)))}] }}
"""
FLEXIBLE_IN_SPACE = {
    name: HINGED.replace("NAME", name).replace("BODY", body)
    for name, body in (("beam_in_space", BEAM), ("component_modes", CRAIG_BAMPTON))
}
"""A hinged rod: a beam in space of second order with a parameter, and a body with Craig-Bampton modes."""

TABLE = """
[tables]
load = { file = "load.csv", x = "t", y = "F" }
[forces.more]
at = "arm.tip"
components = ["load(0.5*t + 0.1) + step(t, 0, 1)", 0]
"""


@cache
def looked_up() -> Specification:
    """The scene STEERED with a force that follows a table."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "load.csv").write_text("t,F\n0,1\n0.4,2\n1,-1\n")
        return parse(STEERED.replace("steered", "looked_up") + TABLE, str(Path(folder) / "given.toml"))


@cache
def prepared(text: str) -> HostModel:
    """The model of a specification, as hosts see it."""
    return host_model(parse(text, "given.toml"))


@cache
def scene(name: str) -> HostModel:
    """The model of a specification in the folder `scenes`."""
    return host_model(derive.read(ROOT / f"scenes/{name}.toml"))

"""Scenes in which everything occurs: joints of each kind in each place, drives, actions, bodies with little left."""

from __future__ import annotations

JOINTS = """
name = "joints"

[scene]
gravity = [{ symbol = "gx", default = 0.7 }, -9.81]

[ground.markers]
a = [0, 0]
b = [{ symbol = "bx", default = 1.5 }, "1/3"]
c = [-1, 0.4]

[bodies.plate]                                             # free, its centre of mass off its origin
mass = { symbol = "mp", default = 1.7 }
inertia = { symbol = "Ip", default = 0.31 }
centre = [0.2, { symbol = "e", default = -0.15 }]
markers = { p = [0.4, -0.1], q = [-0.3, { symbol = "qy", default = 0.25 }], r = [0, 0] }

[bodies.runner]
mass = 0.6
inertia = 0.04
centre = [0, 0.1]
markers = { pin = [0.05, -0.02] }

[bodies.disc]
mass = 0.9
inertia = 0.11
markers = { m = [0.1, 0.2] }

[bodies.rod]
pieces = 3
mass = { symbol = "m", default = 1.3 }
length = { symbol = "l", default = 1.2 }
bending_stiffness = { symbol = "EI", default = 8 }
markers = { left = -1, seam = "-1/3", inside = 0.4, right = 1 }

[bodies.whip]
pieces = 2
frame = "chord"
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]
mass = 0.8
length = 0.9
bending_stiffness = 5
markers = { left = -1, right = 1 }

[bodies.tail]
frame = { kind = "point", at = "1/2" }
mass = 0.7
length = 1.1
bending_stiffness = 6
markers = { left = -1, right = 1 }

[bodies.blade]
frame = { kind = "tangent", at = -1 }
ansatz = ["1", "xi", "xi^2 - xi/3", "xi^3 + xi^2"]
orthogonal = true
mass = 0.5
length = 0.7
bending_stiffness = 4
markers = { right = 1, near = "-1/2" }

[joints.pivot]
kind = "revolute"
between = ["rod.left", "ground.a"]

[joints.clamp]
kind = "weld"
between = ["rod.right", "plate.p"]
angle = 0.3

[joints.hinge]
kind = "revolute"
between = ["plate.q", "whip.left"]

[joints.root]
kind = "fixed"
between = ["ground.b", "tail.left"]
angle = -0.4

[joints.rail]                                              # on a moving body, the axis of no rational length
kind = "translational"
between = ["plate.r", "runner.pin"]
axis = [3, "-1/2"]
angle = 0.2

[joints.line]
kind = "translational"
between = ["ground.c", "blade.right"]
axis = [1, 2]

[joints.sleeve]                                            # the line belongs to the body, the ground slides on it
kind = "translational"
between = ["disc.m", "ground.b"]
axis = [-4, 3]
angle = 0.1

[joints.link]
kind = "revolute"
between = ["whip.right", "tail.right"]

[drives.motor]
joint = "hinge"
speed = { symbol = "Omega", default = 2.5 }
offset = 0.2

[drives.push]
joint = "rail"
motion = "0.1*sin(3*t) + t^2/7"

[drives.pull]
joint = "sleeve"
motion = "sqrt(1 + t^2) - cos(t)/2"
"""

REDUCED = """
name = "reduced"

[scene]
gravity = [0.3, { symbol = "g", default = -9.81 }]

[ground.markers]
a = [0, 0]
b = [{ symbol = "bx", default = 1.5 }, "1/3"]
c = [-1, 0.4]

[bodies.bob]                                               # hangs on the arm, whose motion is prescribed
mass = { symbol = "mb", default = 0.8 }
inertia = { symbol = "Ib", default = 0.05 }
centre = [0.3, -0.1]
markers = { top = [0, { symbol = "ty", default = 0.1 }], end = [0.6, -0.2] }

[bodies.arm]
markers = { hub = [0.1, 0], pin = [0.7, { symbol = "py", default = 0.2 }], tip = [0.9, -0.1] }

[bodies.flag]                                              # welded to the arm, as the first body of the joint
mass = 2
inertia = 1
markers = { root = [0, 0.1], top = [0.1, 0.8] }

[bodies.post]
mass = 1.1
inertia = 0.2
markers = { foot = [0, 0], head = [0.1, 0.9] }

[bodies.swing]                                             # hangs on the post, which stands still
mass = 0.9
inertia = 0.07
centre = [-0.1, -0.3]
markers = { top = [0, 0], end = [0.05, -0.6] }

[bodies.slider]
mass = { symbol = "ms", default = 1.2 }
inertia = 0.3
centre = [0.2, 0.1]
markers = { pin = [-0.1, 0.05], far = [0.4, 0.1] }

[bodies.cart]                                              # on a guide whose direction has a rational length
mass = 0.4
inertia = 0.1
markers = { pin = [0, 0] }

[bodies.pusher]
markers = { foot = [0, 0.1], head = [0.3, 0] }

[bodies.gear]                                              # turns on the pusher, driven against it, as the first body
mass = 0.2
inertia = 0.01
markers = { hub = [0, 0], rim = [0.15, 0] }

[bodies.rod]
pieces = 2
frame = "point"
mass = 0.6
length = 1.4
bending_stiffness = 7
markers = { left = -1, middle = 0, right = 1 }

[bodies.strut]
mass = 0.5
length = 0.8
bending_stiffness = 3
markers = { left = -1, right = 1 }

[joints.shaft]
kind = "revolute"
between = ["ground.a", "arm.hub"]

[joints.hook]
kind = "revolute"
between = ["bob.top", "arm.pin"]

[joints.pole]
kind = "weld"
between = ["flag.root", "arm.tip"]
angle = 0.7

[joints.base]
kind = "fixed"
between = ["ground.b", "post.foot"]
angle = 0.35

[joints.ring]
kind = "revolute"
between = ["post.head", "swing.top"]

[joints.guide]
kind = "translational"
between = ["ground.c", "slider.pin"]
axis = [1, 2]
angle = 0.5

[joints.track]
kind = "translational"
between = ["ground.b", "cart.pin"]
axis = [3, -4]

[joints.press]
kind = "translational"
between = ["ground.c", "pusher.foot"]
axis = ["1/3", -1]
angle = -0.6

[joints.bearing]
kind = "revolute"
between = ["gear.hub", "pusher.head"]

[joints.left]
kind = "revolute"
between = ["slider.far", "rod.left"]

[joints.right]
kind = "revolute"
between = ["rod.right", "bob.end"]

[joints.strut_left]
kind = "weld"
between = ["flag.top", "strut.left"]
angle = -0.2

[joints.strut_right]
kind = "revolute"
between = ["strut.right", "gear.rim"]

[drives.motor]
joint = "shaft"
motion = "2*t - sin(3*t)/4"

[drives.ram]
joint = "press"
speed = { symbol = "w", default = 0.4 }
offset = -0.1

[drives.spin]
joint = "bearing"
motion = "1/(2 + t) - t^3"
"""

ACTIONS = """
name = "actions"

[scene]
gravity = [0, -9.81]

[ground.markers]
a = [0.1, -0.2]
b = [2, 1]

[bodies.block]
mass = 1.5
inertia = 0.2
centre = [-0.1, 0.2]
markers = { p = [0.3, 0.1], q = [-0.4, 0] }

[bodies.wheel]
mass = 0.7
inertia = 0.05
markers = { hub = [0.1, 0], rim = [0.2, 0.3] }

[bodies.rod]
pieces = 2
mass = 1
length = 1.5
bending_stiffness = 9
markers = { left = -1, inside = "0.3", right = 1 }

[joints.axle]
kind = "revolute"
between = ["ground.a", "wheel.hub"]

[joints.pin]
kind = "revolute"
between = ["wheel.rim", "rod.left"]

[forces.wind]
at = "rod.inside"
components = ["3*sin(2*t)", 1.5]

[forces.pull]
at = "block.p"
components = [0, "t^2 - 2"]

[forces.brake]
at = "wheel.rim"
components = [0.4, "-1/(1 + t)"]

[torques.free]
at = "block.q"
value = 0.8

[torques.motor]
at = "rod.right"
against = "block.p"
value = "2*cos(t)"

[torques.grip]
at = "rod.inside"
value = "t"

[torques.stator]
at = "ground.a"
against = "wheel.hub"
value = 0.3

[springs.soft]                                             # no length at rest: linear in the coordinates
between = ["ground.b", "rod.right"]
stiffness = { symbol = "k1", default = 12 }

[springs.stiff]
between = ["rod.inside", "block.p"]
stiffness = 30
damping = { symbol = "d2", default = 0.6 }
rest = 0.25

[springs.longer]
between = ["wheel.rim", "block.q"]
stiffness = { symbol = "k3", default = 7 }
rest = { symbol = "l3", default = 0.4 }

[springs.damper]
between = ["ground.a", "block.q"]
stiffness = 0
damping = 1.3

[springs.coil]
kind = "rotational"
between = ["block.q", "rod.right"]
stiffness = { symbol = "k4", default = 4 }
damping = 0.2
rest = -0.3

[springs.clock]
kind = "rotational"
between = ["wheel.hub", "ground.a"]
stiffness = 2

[springs.curl]
kind = "rotational"
between = ["rod.left", "rod.right"]
stiffness = 1.1
damping = { symbol = "d5", default = 0.07 }
"""

ELEMENTS = """
name = "elements"

[scene]
gravity = [0, -9.81]

[ground.markers]
a = [0.1, -0.2]
b = [2, 1]

[bodies.block]
mass = 1.5
inertia = 0.2
centre = [-0.1, 0.2]
markers = { p = [0.3, 0.1], q = [-0.4, 0] }

[bodies.wheel]                                             # its motion is prescribed
markers = { hub = [0.1, 0], rim = [0.2, 0.3] }

[bodies.rod]
mass = 1
length = 1.5
bending_stiffness = 9
markers = { left = -1, inside = "0.3", right = 1 }

[joints.axle]
kind = "revolute"
between = ["ground.a", "wheel.hub"]

[joints.pin]
kind = "revolute"
between = ["wheel.rim", "rod.left"]

[drives.motor]
joint = "axle"
motion = "sin(t)/2"

[forces.thrust]
at = "block.p"
components = ["2*t", -1.5]
frame = "body"

[forces.follower]
at = "rod.right"
components = [-3, "cos(t)"]
frame = "body"

[forces.weight]
at = "rod.inside"
components = [0, "t"]
frame = "inertial"

[springs.hardening]
between = ["rod.inside", "block.p"]
stiffness = 30
cubic = { symbol = "k3", default = 40 }
quintic = -3
damping = 0.6
rest = 0.25

[springs.asymmetric]
between = ["ground.b", "rod.right"]
stiffness = 0
quadratic = 5

[springs.coil]
kind = "rotational"
between = ["block.q", "rod.right"]
stiffness = { symbol = "k1", default = 4 }
cubic = 2
quartic = { symbol = "k4", default = 0.3 }
damping = 0.2
rest = -0.3

[springs.mount]
kind = "bushing"
between = ["block.q", "rod.inside"]
stiffness_x = { symbol = "kx", default = 20 }
stiffness_y = 7
stiffness_rotation = 3
damping_x = 0.4
damping_y = { symbol = "dy", default = 0.9 }
damping_rotation = 0.3
rest_x = 0.1
rest_y = { symbol = "y0", default = -0.2 }
rest_rotation = 0.5

[springs.rubber]                                           # its first marker is carried along
kind = "bushing"
between = ["wheel.rim", "block.p"]
stiffness_y = 11
damping_x = 2

[springs.foot]
kind = "bushing"
between = ["ground.b", "block.p"]
stiffness_x = 13
stiffness_y = 13
"""

FUNCTIONS = """
name = "functions"

[ground.markers]
a = [0, 0]
b = [2, 1]

[parameters]
A = { default = 0.3, unit = "rad" }
Te = { default = 0.7 }

[bodies.arm]
markers = { hub = [0, 0], tip = [1, 0.2] }

[bodies.bob]
mass = { symbol = "m", default = 1.5 }
inertia = 0.1
centre = [0.2, 0]
markers = { top = [0, 0], end = [0.5, 0.1] }

[bodies.link]
mass = 0.4
inertia = 0.05
markers = { left = [0, 0], right = [0.6, 0] }

[joints.axle]
kind = "revolute"
between = ["ground.a", "arm.hub"]

[joints.pin]
kind = "revolute"
between = ["arm.tip", "bob.top"]

[joints.crank]
kind = "revolute"
between = ["bob.end", "link.left"]

[drives.motor]
joint = "axle"
motion = "A*exp(-(t - 1/2)^2)*tanh(t) + step(1.1*t, 0.2, 3*Te)/3 + abs(sin(t) - 2)"

[drives.servo]
joint = "crank"
motion = "log(2+t)*atan2(t, 1 + A*t) + max(t/3, piecewise(t < 1, t^2, 2*t - 1), Te*step(A*t, 0, 3)) - min(t, abs(-A*t))"

[forces.f]
at = "bob.end"
components = ["m*max(t, Te, 1/3)", "min(cos(t), 0.3) + log(1 + t)"]

[forces.late]
at = "link.right"
frame = "body"
components = ["step(t - 5, 0, 1)", "exp(1) - min(Te, A)"]

[torques.q]
at = "bob.top"
value = "piecewise(t < 0.5, sqrt(2 - t), t < Te, A, atan2(t, 2 - t))"
"""

LOADS = """
name = "loads"

[scene]
gravity = [0.3, -9.81]

[ground.markers]
a = [0.1, -0.2]

[parameters]
F = { default = 1.4, unit = "N/m" }

[bodies.rod]
pieces = 3
mass = { symbol = "m", default = 1.3 }
length = { symbol = "l", default = 1.2 }
bending_stiffness = 9
damping = { mass = 0.3, stiffness = 0.01 }
markers = { left = -1, right = 1 }

[bodies.rod.masses]
first = { at = -0.2, mass = { symbol = "m1", default = 0.3 }, inertia = { symbol = "J1", default = 0.02 } }
last = { at = 1, mass = 0.2 }

[bodies.rod.loads.wind]
force = ["1 - xi", "-10*(1 - xi^2)"]
time = "F*cos(t)"

[bodies.rod.loads.pressure]
force = [0.4, "xi + xi^3"]
frame = "body"

[bodies.whip]
pieces = 2
frame = { kind = "tangent", at = -1 }
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]
mass = 0.8
length = 0.9
bending_stiffness = 5
damping = { ratio = { symbol = "zeta", default = 0.02 } }
markers = { left = -1, right = 1 }
masses.head = { at = 1, mass = 0.25, inertia = 0.03 }
masses.collar = { at = -0.5, mass = { symbol = "m2", default = 0.4 } }
loads = { couple = { force = [0, "xi"] }, push = { force = ["xi^2", 2], time = "t", frame = "body" } }

[joints.pivot]
kind = "revolute"
between = ["rod.left", "ground.a"]

[joints.hinge]
kind = "revolute"
between = ["rod.right", "whip.left"]
"""

KEPT = REDUCED.replace('"reduced"', '"kept"')
for _name in ("bob", "flag", "post", "swing", "slider", "cart", "gear"):
    KEPT = KEPT.replace(f"[bodies.{_name}]", f"[bodies.{_name}]\nkeep_coordinates = true")
for _name in ("arm", "pusher"):  # which do without mass where their motion is prescribed
    KEPT = KEPT.replace(f"[bodies.{_name}]", f"[bodies.{_name}]\nkeep_coordinates = true\nmass = 0.3\ninertia = 0.02")

"""Other words, of engineers and other programs, for keys and choices of a specification: hints on unknown ones."""

from __future__ import annotations

from collections.abc import Collection

OTHER_WORDS = {
    "kind": "type family",
    "count": "n number",
    # bodies
    "mass": "m weight total_mass",
    "component_modes": "mode_type kind_of_modes craig_bampton",
    "interface": "boundary interfaces interface_markers attachments held",
    "inertia": "i j moment_of_inertia rotational_inertia",
    "centre": "center centre_of_mass center_of_mass com cog cg",
    "length": "l",
    "bending_stiffness": "ei stiffness flexural_rigidity bending",
    "axial": "ea axial_stiffness",
    "pieces": "elements segments parts beams divisions",
    "ansatz": "modes shapes shape_functions basis",
    "ends": "supports boundary boundary_conditions",
    "ratio": "zeta xi damping_ratio",
    "gravity": "g acceleration",
    # joints, springs, forces and drives
    "marker": "at of body markers",
    "between": "markers ends bodies points connects",
    "at": "marker point place body x xi position origin location",
    "joint": "at of",
    "axis": "normal direction",
    "stiffness": "k spring_constant constant ea axial_stiffness",
    "damping": "c d damper viscosity damping_constant damping_coefficient zeta ratio damping_ratio",
    "rest": "length rest_length free_length natural_length unstretched_length initial_length l0 angle rest_angle",
    "components": "force vector value direction",
    "force": "components value",
    "value": "torque moment magnitude components function default initial start",
    "motion": "position displacement angle rotation phi function value translation",
    "offset": "phase initial_angle start_angle",
    # initial values
    "position": "x y origin location displacement",
    "angle": "rotation phi orientation attitude",
    "rotation": "angle phi orientation attitude quaternion",
    "displacement": "position translation",
    "spin": "omega angular_velocity angular_speed speed rate",
    "angular_velocity": "omega spin angular_speed",
    "speed": "omega velocity rate spin angular_velocity angular_speed",
    "deflection": "shape column columns curves signals quantity",
    # simulations and what they show
    "duration": "end time end_time t_end tend final_time stop_time length",
    "output": "dt step interval timestep time_step step_size output_interval sampling",
    "tolerance": "tol rtol atol reltol abstol accuracy precision",
    "until": "stop condition",
    "y": "column columns curves signals quantity",
    "default": "value initial",
    "file": "path data csv",
}
"""Other words for each key, in lower case; of two keys of a table with the same word the first counts."""

OTHER_CHOICES = {
    "flat": "unrolled straight_line",
    "loops": "table looped",
    "craig_bampton": "cb craig-bampton fixed fixed_interface",
    "free": "natural normal eigenmodes",
}
"""Other words for the choices of a key."""


def meant_name(word: str, known: Collection[str]) -> str | None:
    """The known key or choice for which `word` is another word; None if there is none."""
    others = OTHER_WORDS | OTHER_CHOICES
    return next((name for name, words in others.items() if name in known and word.lower() in words.split()), None)

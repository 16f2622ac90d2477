"""The failures of methods in small cases: a line for each, with its criterion, the theory, and the measurement."""

from __future__ import annotations

from math import isfinite, pi

from bench.method_failures.small_cases import SmallCases
from bench.method_failures.small_scenes import Driven
from bench.method_failures.step_control import PHASES
from derive.percentages import percent
from derive.study.methods.failures import NEAR, MethodFailure
from derive.study.methods.implicit_steps import Rule
from derive.terminal import magnitude

UNSAFE, SAFE = 100, 3
"""An error of UNSAFE times its estimate or more is not controlled; one of less than SAFE times its estimate is."""
DEGREE = pi / 180


def small_failures(cases: SmallCases) -> tuple[MethodFailure, ...]:
    """The failures of methods, each with the measurement on its small case."""
    first = (_step_control(cases), _dead_centre(cases), *_trapezoidal(cases))
    return (*first, _gimbal_lock(cases), _monomials(cases), _rigid_motion(cases))


def _step_control(cases: SmallCases) -> MethodFailure:
    first, last = cases.controls[0], cases.controls[-1]
    classical, own, rows = ([getattr(c, name) for c in cases.controls] for name in ("classical", "own", "row"))
    measured = (
        f"omega h = {first.product:g} to {last.product:g}, worst of {len(PHASES)} phases: error over estimate "
        f"{magnitude(min(classical))} to {magnitude(max(classical))} by DOP853 of SciPy, {min(own):.1f} to "
        f"{max(own):.1f} by adaptive and dop853, whose rows within a step are off by at most {max(rows):.1f} of the "
        "tolerance"
    )
    agrees = min(classical) > UNSAFE and max(own) < SAFE and max(rows) < SAFE
    return MethodFailure(
        "step control: fast vibrations",
        "an estimate of one order vanishes at two phases of a vibration, and steps beyond the limit are taken",
        measured,
        agrees,
    )


def _dead_centre(cases: SmallCases) -> MethodFailure:
    cases = {(case.driven, case.rod): case for case in cases.dead_centres}
    long, equal, slider = cases[Driven.CRANK, 2.0], cases[Driven.CRANK, 1.0], cases[Driven.SLIDER, 2.0]
    angles = ", ".join(f"{angle / DEGREE:.0f}" for angle in slider.dead if angle < 2 * pi - 1e-9)
    measured = (
        f"smallest singular value of G: {long.singular.min():.2f} with the crank driven and l1 < l2, "
        f"{magnitude(equal.singular.min())} with l1 = l2; slider driven: zero at {angles} deg, and the run stops "
        f"with an error that reports {magnitude(slider.reported)}"
    )
    agrees = not long.dead and not long.failure and bool(equal.dead) and 0 <= slider.reported < 1e-3
    criterion = "crank driven: singular only if l1 >= l2; slider driven: at phi1 = 0, 180 deg"
    return MethodFailure("dead centre", criterion, measured, agrees and angles == "0, 180")


def _trapezoidal(cases: SmallCases) -> tuple[MethodFailure, ...]:
    drift = {rule: [m for m in cases.momentum if m.rule is rule] for rule in (Rule.TRAPEZOIDAL, Rule.MIDPOINT)}
    trapezoidal, midpoint = drift[Rule.TRAPEZOIDAL], drift[Rule.MIDPOINT]
    parts = " / ".join(f"{100 * m.drift:.2g}" for m in trapezoidal)
    worst = max(m.drift for m in midpoint)
    products = " / ".join(f"{m.product:g}" for m in trapezoidal)
    measured = f"{parts} % at omega_1 h = {products}; midpoint rule {100 * worst:.1g} %"
    first = trapezoidal[0]
    momentum = MethodFailure(
        "trapezoidal rule: momentum",
        f"drift of the angular momentum (omega_1 h)^2/4 c8 a^2/C3: {percent(first.small)} at 1",
        measured,
        abs(first.drift / first.small - 1) < 2 * NEAR and worst < 0.005,
    )
    if not cases.ringing:
        return (momentum,)
    factors = ", ".join(f"{r.factor:.2f} (rho {r.rho:g})" for r in cases.ringing)
    last = cases.ringing[0]
    ring = MethodFailure(
        "trapezoidal rule: multipliers",
        "index 3: they ring, by a factor rho per step; not damped if rho = 1",
        f"factor per step {factors}; with rho = 1 ringing grows to {percent(last.amplitude[-1])} of the multipliers",
        all(abs(r.factor / r.rho - 1) < NEAR for r in cases.ringing) and bool(last.amplitude[-1] > last.amplitude[0]),
    )
    return momentum, ring


def _gimbal_lock(cases: SmallCases) -> MethodFailure:
    t = cases.tumble
    pitch, angles, quaternion = abs(t.pitch).max() / DEGREE, float(t.angles.max()), float(t.quaternion.max())
    measured = (
        f"tumbling to a pitch of {pitch:.2f} deg: condition of the kinematics {quaternion:.3g} with the quaternion, "
        f"{magnitude(angles) if isfinite(angles) else 'infinite'} with angles; energy changes by {magnitude(t.energy)}"
    )
    return MethodFailure(
        "gimbal lock",
        "angles: condition 1/cos(pitch), infinite at 90 deg; quaternion: 1 in every attitude",
        measured,
        quaternion < 1 + 1e-6 and angles > 100 and t.energy < 1e-7,
    )


def _monomials(cases: SmallCases) -> MethodFailure:
    first, last = cases.bases[0], cases.bases[-1]
    rate = (last.monomials / first.monomials) ** (1 / (last.count - first.count))
    measured = (
        f"N = {first.count} to {last.count}: monomials {first.monomials:.2g} to {magnitude(last.monomials)}, by "
        f"{rate:.1f} per shape, an error of {magnitude(last.error_monomials)} in c8 x = b; Legendre polynomials "
        f"{first.legendre:.2g} to {last.legendre:.2g}, {magnitude(last.error_legendre)}"
    )
    agrees = rate > 3 and all(abs(b.legendre - (2 * b.count + 3) / 5) < 1e-9 for b in cases.bases)
    return MethodFailure(
        "monomials, many shapes", "cond(c8) grows like that of a Hilbert matrix; Legendre (2N + 3)/5", measured, agrees
    )


def _rigid_motion(cases: SmallCases) -> MethodFailure:
    r = cases.rigid
    measured = (
        f"exact rank {r.rank} of {r.fields} fields; M has rank {r.at_rest} of {r.unknowns} at rest and {r.deformed} "
        f"deformed, with a least eigenvalue of {r.slope:.3f} m alpha^2; refused: {r.error.split(';')[0]}"
    )
    return MethodFailure(
        "rigid motion left in the shapes",
        "exact rank of {1, rotation, phi_i}: M is singular at rest, and seems less so when deformed",
        measured,
        r.rank < r.fields and r.at_rest < r.deformed and "rigid motion is left" in r.error,
    )

"""The error of a beam of first order in space by the coupling of its twist with both bendings, which it leaves out.

A twist theta turns the axes in which a beam resists bending, so that its strain energy is

    1/2 int EI_3 (v'' cos theta + w'' sin theta)^2 + EI_2 (w'' cos theta - v'' sin theta)^2 dx.

Deflections along e2 and e3 twist a beam by it, and a twist moves what bends along one axis along the other. What the
difference from the energy at no twist would do in the motion of a run is a load on the vibrations of the beam, whose
stiffness has its second derivatives; from that follows the error of each. A beam of second order has of this energy
what is linear in theta.

Seen from an end that joints hold, all fields are turned by the twist phi of its section in the frame of the beam: the
model has the deflections v + phi w and w - phi v, the moments M turn alike, and theta counts from that end. Its energy
belongs to v and w, and its forces work along v + phi w and w - phi v: these differences are loads as well. A joint
takes the rotation [phi, -w', v'] of the section as a rotation vector, so that the tangent of the beam is off that of
the section by phi w'/2 along e2 and by -phi v'/2 along e3: M works along these slopes, and the beam is turned by them.
A frame that is tangent at the held end has none of this.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.implied_errors import COARSE, STRAIGHT
from derive.simulation.validity.monitoring_outputs import MOMENT_GAP
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import TWIST, PieceShapes, gauss_points
from derive.simulation.validity.surroundings import Surroundings, surroundings
from derive.simulation.validity.varying_stiffness import responses
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam

ALONG = (2, 3)
"""The axes along which a beam bends."""
MOST_ROWS = 3000
"""The states of a run that are looked at."""


def twist_coupling_errors(scene: SceneWatch, motion: SceneMotion, beam: str) -> Mapping[int, float]:
    """The errors of the deflections of a beam of first order by the axes along which it bends.

    They are root mean squares over the run, relative to the peak. Nothing is known of a beam in pieces, of one that
    joints hold at both ends, and where rows are too coarse to follow its slowest vibration.
    """
    planes = {of.shapes.axis: of for of in scene.beams if of.beam.name == beam}
    if not {*ALONG, TWIST} <= planes.keys() or planes[TWIST].beam.pieces > 1 or len(motion.t) < 2:
        return {}
    motion = _some_rows(motion)
    vibrations = planes[TWIST].vibrations
    slowest = min((of.frequency for of in vibrations), default=np.inf)
    around = {axis: surroundings(motion.scene, of.shapes) for axis, of in planes.items()}
    ends = {of.held for of in around.values()}
    if len(ends) > 1 or len(*ends) > 1 or not slowest * float(np.diff(motion.t).max()) < COARSE:
        return {}
    return _Coupling(scene, motion, planes, around, *ends).errors()


def _some_rows(motion: SceneMotion) -> SceneMotion:
    """The motion in at most `MOST_ROWS` rows, evenly spaced."""
    some = np.unique(np.linspace(0, len(motion.t) - 1, min(len(motion.t), MOST_ROWS)).round().astype(int))
    outputs = None if motion.outputs is None else motion.outputs[some]
    return replace(motion, t=motion.t[some], q=motion.q[some], v=motion.v[some], outputs=outputs)


@dataclass(frozen=True, eq=False)
class _Coupling:
    """A beam with its deflections and its twist by their axes, and the end at which joints hold it, if there is one.

    All its amplitudes are those along e2, those along e3, and those of the twist; fields are (n, .) for each of them.
    """

    scene: SceneWatch
    motion: SceneMotion
    planes: Mapping[int, WatchedBeam]
    around: Mapping[int, Surroundings]
    held: tuple[int, ...]

    def errors(self) -> dict[int, float]:
        """The errors along e2 and e3."""
        own, squares, rows = self._own(self.motions), self.frequencies**2, len(self.motion.t)
        load, late, slopes = self._load(), np.zeros((rows, len(own))), {axis: np.zeros(rows) for axis in ALONG}
        if self.held:
            of_end, slopes = self._of_end()
            load -= of_end
            late += sum(np.outer(slopes[axis], self._part_of_turn(axis)) for axis in ALONG)
        stiffness = np.diag(squares) + np.einsum("mi,tij,nj->tmn", own, self._stiffness(), own)
        errors = responses(self.motion.t, stiffness, load @ own.T + squares * late) - late
        result = {}
        for axis, other, sign in ((2, 3, 1), (3, 2, -1)):
            turned, twist = np.outer(slopes[axis], self._arms), sign * self.turn[:, None]
            model = self._deflections(axis, self.motion.q) + twist * self._deflections(other, self.motion.q) - turned
            error = self._deflections(axis, errors @ self.motions) + turned
            peak = float(max(np.abs(model).max(), np.abs(model + error).max()))
            bent = peak > STRAIGHT * self.planes[axis].length
            result[axis] = float(np.sqrt((error**2).mean(axis=0)).max()) / peak if bent else 0.0
        return result

    def _load(self) -> Matrix:
        """(rows, n): the moments of the forces less those of the sections, and what the turn has of them already."""
        v, w, _ = self._seen
        EI_v, EI_w = self.stiffnesses
        M_v, M_w = self._turned(EI_v * v, EI_w * w, self.turn[:, None])
        kappa_v, kappa_w, c, s = self._sections
        own_v, own_w = EI_v * kappa_v, EI_w * kappa_w
        along = M_v - c * own_v + s * own_w, M_w - s * own_v - c * own_w, (EI_w - EI_v) * kappa_v * kappa_w
        loads = ((EI_w - EI_v) * v * w) @ self.weights
        result: Matrix = np.outer(loads, self._at_end(TWIST, "values"))
        for of, field in zip(along, self.fields, strict=True):
            result += (of * self.weights) @ field.T
        return result

    def _stiffness(self) -> Matrix:
        """(rows, n, n): the second derivatives of the energy of the sections, less those that the model has."""
        EI_v, EI_w = self.stiffnesses
        kappa_v, kappa_w, c, s = self._sections
        less, M_v, M_w = EI_v - EI_w, EI_v * kappa_v, EI_w * kappa_w
        pairs = (
            (0, 0, -less * s**2 / 2),
            (1, 1, less * s**2 / 2),
            (2, 2, less * (kappa_w**2 - kappa_v**2) / 2),
            (0, 1, less * c * s),
            (0, 2, -s * M_v - c * M_w + c * EI_v * kappa_w + s * EI_w * kappa_v),
            (1, 2, c * M_v - s * M_w + s * EI_v * kappa_w - c * EI_w * kappa_v),
        )
        half = np.zeros((len(c), *2 * (len(self.fields[0]),)))
        for i, j, by in pairs:
            half += np.einsum("tp,ip,jp->tij", by * self.weights, self.fields[i], self.fields[j])
        return half + half.transpose(0, 2, 1)

    @property
    def _seen(self) -> tuple[Matrix, Matrix, Matrix]:
        """(rows, POINTS): the curvatures v'' and w'' in the frame of the beam, and the twist from the held end."""
        v, w, theta = (self.amplitudes @ field for field in self.fields)
        return v, w, theta

    @property
    def _sections(self) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """(rows, POINTS): the curvatures in the axes of the sections, the cosine and the sine of their twist."""
        v, w, theta = self._seen
        kappa_v, kappa_w = self._turned(*self._turned(v, w, self.turn[:, None]), theta)
        return kappa_v, kappa_w, np.cos(theta), np.sin(theta)

    @staticmethod
    def _turned(v: Matrix, w: Matrix, by: Matrix) -> tuple[Matrix, Matrix]:
        """Components along e2 and e3 along axes that are turned about e1 by an angle, rad."""
        return v * np.cos(by) + w * np.sin(by), w * np.cos(by) - v * np.sin(by)

    def _of_end(self) -> tuple[Matrix, dict[int, Vector]]:
        """The work (rows, n) of the moments at the held end by the amplitudes, and the slopes (rows,) that miss."""
        (end,) = self.held
        twist, v, w = self._at_end(TWIST, "values"), *(self._at_end(axis, "slopes") for axis in ALONG)
        of_v, of_w = (self.amplitudes @ of for of in (v, w))
        in_frame = [self._moments(axis) for axis in ALONG]
        M_v, M_w = in_frame[0] + self.turn * in_frame[1], in_frame[1] - self.turn * in_frame[0]
        work = np.outer(M_w * of_v - M_v * of_w, twist) + np.outer(M_w * self.turn, v) - np.outer(M_v * self.turn, w)
        return end / 2 * work, {2: -self.turn * of_w / 2, 3: self.turn * of_v / 2}

    @cached_property
    def motions(self) -> Matrix:
        """(vibrations, nq): the motions of the vibrations in all planes."""
        return np.array([of.motion for of in self.planes[TWIST].vibrations])

    @cached_property
    def frequencies(self) -> Vector:
        """The frequencies of the vibrations, rad/s."""
        return np.array([of.frequency for of in self.planes[TWIST].vibrations])

    @cached_property
    def columns(self) -> dict[int, list[int]]:
        """The numbers of the amplitudes among the coordinates, by axes."""
        native = self.motion.native
        return {axis: self._shapes(axis).amplitudes_in(native, self._name) for axis in (*ALONG, TWIST)}

    @cached_property
    def amplitudes(self) -> Matrix:
        """(rows, n): all amplitudes."""
        return self._own(self.motion.q)

    @cached_property
    def turn(self) -> Vector:
        """(rows,): the twist of the section at the held end in the frame of the beam, rad."""
        return np.asarray(self.amplitudes @ self._at_end(TWIST, "values"))

    @cached_property
    def fields(self) -> tuple[Matrix, Matrix, Matrix]:
        """The curvatures v'' and w'', 1/m, and the twist, from the held end, at Gauss points for unit amplitudes."""
        xi, _ = gauss_points()
        v, w = (self._placed(axis, self._shapes(axis).moments(xi)) for axis in ALONG)
        twist = self._placed(TWIST, self._shapes(TWIST).values(xi) * 2 / self._shapes(TWIST).length)
        EI_v, EI_w = self.stiffnesses
        return v / EI_v, w / EI_w, twist - self._at_end(TWIST, "values")[:, None]

    @property
    def stiffnesses(self) -> tuple[float, float]:
        """EI_3 of v and EI_2 of w, N m^2."""
        along, across = (self._shapes(axis).bending_stiffness for axis in ALONG)
        return along, across

    @property
    def weights(self) -> Vector:
        """(POINTS,): the lengths of the axis, m, in integrals."""
        return self._shapes(TWIST).length / 2 * gauss_points()[1]

    @property
    def _name(self) -> str:
        return self.planes[TWIST].beam.name

    def _shapes(self, axis: int) -> PieceShapes:
        return self.planes[axis].shapes

    def _own(self, q: Matrix) -> Matrix:
        """The amplitudes (., n) of coordinates (., nq)."""
        return q[:, [column for columns in self.columns.values() for column in columns]]

    def _placed(self, axis: int, of: Matrix) -> Matrix:
        """(n, .): a field of the shapes of an axis, which the others do not have."""
        return np.vstack(
            [of if other == axis else np.zeros((len(c), of.shape[1])) for other, c in self.columns.items()]
        )

    def _at_end(self, axis: int, of: str) -> Vector:
        """(n,): a field at the held end: `slopes`, `moments`, or `values` of the twist; zero where there is none."""
        shapes = self._shapes(axis)
        field = self._placed(axis, getattr(shapes, of)(np.array(self.held or (0,), float)))[:, 0]
        return field * (2 / shapes.length if axis == TWIST else 1.0) * len(self.held)

    def _moments(self, axis: int) -> Vector:
        """(rows,): the bending moment at the held end in the frame of the beam, from equilibrium, N m."""
        motion, (end,) = self.motion, self.held
        moments: Vector = self.amplitudes @ self._at_end(axis, "moments")
        outputs = self.scene.outputs_of(motion.t, motion.q, motion.v, motion.outputs)
        for (at, kind), output in self.around[axis].gaps.items():
            if at == end and kind == MOMENT_GAP:
                moments = moments + outputs[:, motion.native.outputs.index(output)]
        return moments

    @property
    def _arms(self) -> Vector:
        """(PLACES,): the distances from the held end, m."""
        return self._shapes(TWIST).length / 2 * (places() - sum(self.held))

    def _part_of_turn(self, axis: int) -> Vector:
        """(vibrations,): the part that each vibration has of a turn of the beam about its held end by a unit slope."""
        (end,), shapes, (xi, weights) = self.held, self._shapes(axis), gauss_points()
        motion, half = self.motion, shapes.length / 2
        frames = PieceFrames(motion.native, motion.k, float(motion.t[0]), motion.q[0])
        rise, slope = frames.motion(shapes, self._name, self.motions).T
        attached = [(at, mass) for _, at, mass in self.around[axis].masses]
        every = np.append(xi, [at for at, _ in attached])
        masses = np.append(shapes.mass / 2 * weights, [mass for _, mass in attached])
        along = self.motions[:, self.columns[axis]] @ shapes.values(every) + np.outer(slope, half * every)
        result: Vector = (along + rise[:, None]) @ (masses * half * (every - end))
        return result

    def _deflections(self, axis: int, q: Matrix) -> Matrix:
        """(rows, PLACES): those of the beam, which `WatchedBeam` counts."""
        forms = self.scene.watch.quantities[self.planes[axis].deflection].forms[:, : self.motion.native.nq]
        result: Matrix = q @ forms.T
        return result

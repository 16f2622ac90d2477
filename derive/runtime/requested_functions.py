"""The functions that a compiled model has on request: inverse dynamics, centre of mass, momentum, turning markers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from derive.function_names import OF_MODELS
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.runtime.compiler import CompilerError
from derive.runtime.descriptor import pattern_of
from derive.runtime.native_call import Matrix, Vector

if TYPE_CHECKING:
    from derive.runtime.compiled_function import CompiledFunction
    from derive.runtime.native_markers import NativeMarker


class RequestedFunctions:
    """The functions of a `Native` whose model was lowered with `functions`, and if it has sensitivities, derivatives.

    Matrices come as the values of `patterns`, whose keys are the names of these functions; columns of derivatives are
    those of the arguments, q, v and vdot, and then of the parameters and the inputs.

    Arguments:
        t: the time, s.
        q: the coordinates (nq,).
        v: the generalised velocities (nv,).
        vdot: the accelerations (nv,).
        k: the constants (nk,) of `setup`.
        check: whether a batch, whose states are rows, raises ModelError if a state fails.

    Raises:
        CompilerError: if the model was generated without the function.
        UnknownNameError: for a name that is not in `markers`.

    Examples:
        >>> import derive
        >>> rod = {"mass": 2, "inertia": 1, "markers": {"tip": (0.5, 0)}}
        >>> scene = derive.scene("thrown", gravity=(0, -10), bodies={"rod": rod})
        >>> model = derive.lower(derive.derive(scene), sensitivities=True, functions="all")
        >>> native = derive.load_scene(derive.model_files(model, scene))
        >>> k = native.setup()
        >>> q, v = [3, 4, 0], [1, 0, 2]
        >>> sorted(native.patterns)[:2]
        ['centre_of_mass', 'centre_of_mass_jacobian']
    """

    name: str
    nq: int
    nv: int
    nk: int
    markers: tuple[str, ...]
    _compiled: dict[str, CompiledFunction]
    _marker_of: dict[str, NativeMarker]
    _add: Any
    _batch: Any
    _model: Any
    own_at: Any

    def _add_requested(self, model: Any) -> None:
        """Prepare the functions of a descriptor."""
        self.patterns: dict[str, Pattern] = {}
        state = self.nq, self.nv, self.nk
        for name, marker in self._marker_of.items():
            of = marker.holder
            if marker.number is None and of.rotation:
                nnz = self._add_pattern(f"rotation_{name}", of.rotation_pattern)
                components = self.patterns[f"rotation_{name}"].rows
                self._add(of, "rotation", state, (components, nnz), f"rotation_{name}")
                self._add_derivatives(of, "jacobian_of_rotation", of.derivatives, state, f"rotation_jacobian_{name}")
        if not model.requested:
            return
        of, at_rest, moved = model.requested.contents, (self.nq, self.nk), (self.nq, self.nv, self.nv, self.nk)
        inputs = dict(zip(OF_MODELS, (moved, at_rest, state, state), strict=True))
        self._add(of, "inverse_dynamics", moved, (self.nv,))
        self._add(of, "gravity_compensation", at_rest, (self.nv,))
        if of.centre_of_mass:
            nnz, d = self._add_pattern("centre_of_mass", of.centre_pattern), of.centre_pattern.contents.rows
            self._add(of, "centre_of_mass", state, (d, d, nnz, 1))
        if of.centroidal_momentum:
            nnz = self._add_pattern("centroidal_momentum", of.momentum_pattern)
            self._add(of, "centroidal_momentum", state, (of.momentum_pattern.contents.rows, nnz))
        for name in OF_MODELS:
            self._add_derivatives(of, f"{name}_jacobian", getattr(of, f"of_{name}"), inputs[name])

    def _add_pattern(self, name: str, pattern: Any) -> int:
        self.patterns[name] = pattern_of(pattern.contents)
        return int(pattern.contents.nnz)

    def _add_derivatives(self, of: Any, member: str, pattern: Any, inputs: tuple[int, ...], name: str = "") -> None:
        if pattern:
            self._add(of, member, inputs, (self._add_pattern(name or member, pattern),), name or member)

    def _requested(self, name: str) -> CompiledFunction:
        if name not in self._compiled:
            needed = "functions and sensitivities" if "_jacobian" in name else "functions"
            raise CompilerError(f"{self.name} has no {name}; generate it with {needed}")
        return self._compiled[name]

    def _requested_batch(
        self, name: str, states: Sequence[ArrayLike], k: ArrayLike, check: bool, *t: float
    ) -> list[Matrix]:
        """The results of a function for many states, each with a row for each state."""
        self._requested(name)
        return list(self._batch(name, states, k, check, *t, holder=self._model.requested.contents))

    def inverse_dynamics(self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, k: ArrayLike) -> Vector:
        """The generalised forces f = M vdot + h (nv,) that a motion needs, N and N m.

        Of a scene with constraints, the reactions G^T lambda are among them: `derive.inverse_dynamics` separates
        these, and the inputs of drives.

        Examples:
            >>> native.inverse_dynamics(0.0, q, v, [0, 0, 1], k)
            array([ 0., 20.,  1.])
        """
        return self._requested("inverse_dynamics")((q, v, vdot, self.own_at(t, k)), t)

    def gravity_compensation(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """The generalised forces f (nv,) that hold the model still at q, N and N m: `inverse_dynamics` without motion.

        Examples:
            >>> native.gravity_compensation(0.0, q, k)
            array([ 0., 20.,  0.])
        """
        return self._requested("gravity_compensation")((q, self.own_at(t, k)), t)

    def centre_of_mass(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector, Vector, float]:
        """Position (m), velocity (m/s), values of the Jacobian d(velocity)/dv, and the mass (kg).

        They are those of the bodies with coordinates that no drive moves, as those of `momentum`.

        Examples:
            >>> x, xdot, jacobian, mass = native.centre_of_mass(q, v, k)
            >>> x, xdot, mass
            (array([3., 4.]), array([1., 0.]), 2.0)
            >>> native.patterns["centre_of_mass"].dense(jacobian)
            array([[1., 0., 0.],
                   [0., 1., 0.]])
        """
        x, xdot, jacobian, mass = self._requested("centre_of_mass").results((q, v, k))
        return x, xdot, jacobian, float(mass[0])

    def centroidal_momentum(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """Linear momentum (N s) and angular momentum about the centre of mass (N m s); and values of A, A v.

        Examples:
            >>> momentum, A = native.centroidal_momentum(q, v, k)
            >>> momentum
            array([2., 0., 2.])
            >>> native.patterns["centroidal_momentum"].dense(A).diagonal()
            array([2., 2., 1.])
        """
        momentum, A = self._requested("centroidal_momentum").results((q, v, k))
        return momentum, A

    def inverse_dynamics_batch(
        self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, k: ArrayLike, check: bool = True
    ) -> Matrix:
        """`inverse_dynamics` (n, nv) of n states, as `accel_batch` takes them.

        Examples:
            >>> native.inverse_dynamics_batch(0.0, [q, q], [v, v], [[0, 0, 1], [1, 0, 0]], k)
            array([[ 0., 20.,  1.],
                   [ 2., 20.,  0.]])
        """
        (f,) = self._requested_batch("inverse_dynamics", (q, v, vdot), self.own_at(t, k), check, t)
        return f

    def gravity_compensation_batch(self, t: float, q: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """`gravity_compensation` (n, nv) of n states.

        Examples:
            >>> native.gravity_compensation_batch(0.0, [q, q], k)
            array([[ 0., 20.,  0.],
                   [ 0., 20.,  0.]])
        """
        (f,) = self._requested_batch("gravity_compensation", (q,), self.own_at(t, k), check, t)
        return f

    def centre_of_mass_batch(
        self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True
    ) -> tuple[Matrix, Matrix, Matrix, Vector]:
        """`centre_of_mass` of n states, with a row for each: position, velocity, and values of the Jacobian; masses.

        Examples:
            >>> x, xdot, jacobian, mass = native.centre_of_mass_batch([q, q], [v, v], k)
            >>> x, mass
            (array([[3., 4.],
                   [3., 4.]]), array([2., 2.]))
        """
        x, xdot, jacobian, mass = self._requested_batch("centre_of_mass", (q, v), k, check)
        return x, xdot, jacobian, mass[:, 0]

    def centroidal_momentum_batch(
        self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True
    ) -> tuple[Matrix, Matrix]:
        """`centroidal_momentum` of n states, with a row for each: momenta, and values of A.

        Examples:
            >>> momentum, A = native.centroidal_momentum_batch([q, q], [v, v], k)
            >>> momentum
            array([[2., 0., 2.],
                   [2., 0., 2.]])
        """
        momentum, A = self._requested_batch("centroidal_momentum", (q, v), k, check)
        return momentum, A

    def rotation(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """The angular velocity (rad/s) of the frame of the marker `name`, and values of its Jacobian d(omega)/dv.

        It has three components in the inertial frame, in the plane one.

        Examples:
            >>> omega, jacobian = native.rotation("rod_tip", q, v, k)
            >>> omega, native.patterns["rotation_rod_tip"].dense(jacobian)
            (array([2.]), array([[0., 0., 1.]]))
        """
        if name not in self.markers:
            raise UnknownNameError(f"marker of {self.name}", name, self.markers)
        omega, jacobian = self._requested(f"rotation_{name}").results((q, v, k))
        return omega, jacobian

    def inverse_dynamics_jacobian(self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives of `inverse_dynamics` by [q; v; vdot; p; u].

        Examples:
            >>> jac = native.inverse_dynamics_jacobian(0.0, q, v, [0, 0, 1], k)
            >>> native.patterns["inverse_dynamics_jacobian"].dense(jac)[:, 6:9]  # by vdot
            array([[2., 0., 0.],
                   [0., 2., 0.],
                   [0., 0., 1.]])
        """
        return self._requested("inverse_dynamics_jacobian")((q, v, vdot, self.own_at(t, k)), t)

    def gravity_compensation_jacobian(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives of `gravity_compensation` by [q; p; u].

        Examples:
            >>> native.gravity_compensation_jacobian(0.0, q, k)
            array([], dtype=float64)
        """
        return self._requested("gravity_compensation_jacobian")((q, self.own_at(t, k)), t)

    def centre_of_mass_jacobian(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives of position and velocity of the centre of mass by [q; v; p; u].

        Examples:
            >>> native.centre_of_mass_jacobian(q, v, k)
            array([1., 1., 1., 1.])
        """
        return self._requested("centre_of_mass_jacobian")((q, v, k))

    def centroidal_momentum_jacobian(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives of the `centroidal_momentum` by [q; v; p; u].

        Examples:
            >>> native.centroidal_momentum_jacobian(q, v, k)
            array([2., 2., 1.])
        """
        return self._requested("centroidal_momentum_jacobian")((q, v, k))

    def rotation_jacobian(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives of the angular velocity of the marker `name` by [q; v; p; u].

        Examples:
            >>> native.rotation_jacobian("rod_tip", q, v, k)
            array([1.])
        """
        if name not in self.markers:
            raise UnknownNameError(f"marker of {self.name}", name, self.markers)
        return self._requested(f"rotation_jacobian_{name}")((q, v, k))

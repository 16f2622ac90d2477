"""Typed symbols: how they are printed, compared, ordered and stored, and that no model has two of one name."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

import pytest
import sympy as sp

import beams
import derive
from conftest import ROOT
from derive.mechanics.fixed_symbols import MASS, t
from derive.mechanics.symbols import (
    Family,
    I,
    Identity,
    J,
    amplitude,
    element,
    identity,
    is_indexed,
    local,
    owned,
    pair,
    parameter,
    quantity,
    run_time_input,
    state_rate,
    vector,
)
from derive.mechanics.terms import Reason
from derive.mechanics.typed_symbol import Symbol
from plain_symbols import plain


def of_tree(family: Family, *components: int, point: str = "", derivative: int = 0) -> Symbol:
    return Symbol(Identity(family, components=components, owner="arm", point=point, derivative=derivative))


def at_point(family: Family, point: str, component: int, *shapes: Any, **more: Any) -> Symbol:
    return Symbol(Identity(family, shapes, (component,), point=point, **more))


F = Family
NAMES = {
    "c1": quantity(F.TRANSLATION, 1),
    "c2ddot": quantity(F.TRANSLATION, 2, derivative=2),
    "phidot": quantity(F.ANGLE, derivative=1),
    "e0": quantity(F.QUATERNION, 0),
    "omega3dot": quantity(F.ANGULAR_VELOCITY, 3, derivative=1),
    "pi2": quantity(F.VIRTUAL_ROTATION, 2),
    "alpha12ddot": amplitude(12, 2),
    "alphadot_j": amplitude(J, 1),
    "sdot": quantity(F.GUIDE, derivative=1),
    "mass": MASS,
    "c1_1": quantity(F.C1, 1),
    "c2_i_3": quantity(F.C2, 3, shapes=(I,)),
    "C3": quantity(F.C3),
    "C4_2_13": quantity(F.C4, 1, 3, shapes=(2,)),
    "C5_1_2_23": pair(F.C5, 2, 1, 2, 3),
    "c6_2": quantity(F.C6, shapes=(2,)),
    "c7_i_j_1": quantity(F.C7, 1, shapes=(I, J)),
    "c8_1_12": pair(F.C8, 12, 1),
    "K_1_2": pair(F.STIFFNESS, 1, 2),
    "K3_1_3_5": quantity(F.CUBIC_STIFFNESS, shapes=(1, 3, 5)),
    "B_3_3": pair(F.DAMPING, 3, 3),
    "R_1_3": pair(F.ROTARY, 3, 1),
    "C3_11_": Symbol(Identity(F.C3, components=(1, 1), parameter=True)),
    "d1dot_2": quantity(F.D1, 2, derivative=1),
    "D2_1": quantity(F.D2, shapes=(1,)),
    "d3_i_1": quantity(F.D3, 1, shapes=(I,)),
    "Sdot_12": quantity(F.S, 1, 2, derivative=1),
    "J_33": quantity(F.INERTIA, 3, 3),
    "c9_1_2_1": pair(F.C9, 2, 1, 1),
    "c10_1_2": pair(F.C10, 1, 2),
    "z_3_1_2": quantity(F.FIELD_WEIGHT, shapes=(3, 1, 2)),
    "d4_2_1": quantity(F.D4, 1, shapes=(2,)),
    "betadot_3": quantity(F.FIELD_AMPLITUDE, derivative=1, shapes=(3,)),
    "dbeta_3_1": quantity(F.FIELD_TANGENT, shapes=(3, 1)),
    "c9dot_1_2": quantity(F.C9_SUM, 2, derivative=1, shapes=(1,)),
    "c10_2": quantity(F.C10_SUM, shapes=(2,)),
    "Psi_tip_1_2_1": Symbol(Identity(F.POINT_SECOND, (1, 2), (1,), point="tip")),
    "tip_dr_2_1": Symbol(Identity(F.TANGENT, (2,), (1,), point="tip")),
    "C5_4": quantity(F.C5_SUM, shapes=(4,)),
    "c7dot_2_3": quantity(F.C7_SUM, 3, derivative=1, shapes=(2,)),
    "c8ddot_i": quantity(F.C8_SUM, derivative=2, shapes=(I,)),
    "c8dotdot": quantity(F.RATE_PRODUCT),
    "elastic_i": quantity(F.ELASTIC, shapes=(I,)),
    "damping_2": quantity(F.DAMPING_FORCE, shapes=(2,)),
    "rotaryddot_i": quantity(F.ROTARY_MOMENT, derivative=2, shapes=(I,)),
    "rotarydotdot": quantity(F.ROTARY_PRODUCT),
    "strain": quantity(F.STRAIN),
    "crank_cos_phi": owned(quantity(F.COSINE), "crank"),
    "sin_phi": quantity(F.SINE),
    "Q_31": quantity(F.ROTATION_TENSOR, 3, 1),
    "oo_12": quantity(F.OMEGA_PRODUCT, 1, 2),
    "g_1": quantity(F.GRAVITY, 1),
    "gb_3": quantity(F.BODY_GRAVITY, 3),
    "F_2": quantity(F.FORCE, 2),
    "Fb_1": quantity(F.BODY_FORCE, 1),
    "X0_1": at_point(F.POINT_POSITION, "0", 1),
    "Phi0_i_2": at_point(F.POINT_SHAPE, "0", 2, I),
    "crank_X_hub_1": at_point(F.POINT_POSITION, "hub", 1, owner="crank"),
    "rod_1_Phi_right_3_2": at_point(F.POINT_SHAPE, "right", 2, 3, owner="rod_1"),
    "turn_hub_3": Symbol(Identity(F.SECTION_ROTATION, (3,), point="hub")),
    "rdot_1": quantity(F.RADIUS, 1, derivative=1),
    "crank_hub_s_1": at_point(F.LEVER, "hub", 1, owner="crank"),
    "w_2": quantity(F.INERTIAL_OMEGA, 2),
    "hub_A_12": Symbol(Identity(F.FRAME_AXES, components=(1, 2), point="hub")),
    "hub_thetadot_3": at_point(F.SECTION_VECTOR, "hub", 3, derivative=1),
    "hub_dtheta_2_1": Symbol(Identity(F.SECTION_TANGENT, (2,), (1,), point="hub")),
    "hub_scale": Symbol(Identity(F.SECTION_SCALE, point="hub")),
    "hub_nu_1": at_point(F.SECTION_SPIN, "hub", 1),
    "hub_vrel_1": at_point(F.SECTION_VELOCITY, "hub", 1),
    "arm_arm_phi_T_1": of_tree(F.COLUMN, 1, point="arm_phi"),
    "arm_rz_axis_2": of_tree(F.JOINT_AXIS, 2, point="rz"),
    "arm_r_3": of_tree(F.OFFSET, 3),
    "arm_a_1": of_tree(F.BIAS, 1),
    "arm_alphabias_1": of_tree(F.ANGULAR_BIAS, 1),
    "arm_msdot_2": of_tree(F.FIRST_MOMENT, 2, derivative=1),
    "arm_Jw_12": of_tree(F.TURNED_INERTIA, 1, 2),
    "arm_m_behind": of_tree(F.COMPOSITE_MASS),
    "arm_ms_behind_1": of_tree(F.COMPOSITE_MOMENT, 1),
    "arm_J_behind_33": of_tree(F.COMPOSITE_INERTIA, 3, 3),
    "arm_arm_phi_p_1": of_tree(F.UNIT_MOMENTUM, 1, point="arm_phi"),
    "arm_L_1": of_tree(F.UNIT_SPIN, 1),
    "arm_f_1": of_tree(F.INERTIAL_FORCE, 1),
    "arm_n_1": of_tree(F.INERTIAL_TORQUE, 1),
    "arm_f_behind_1": of_tree(F.FORCE_BEHIND, 1),
    "arm_n_behind_1": of_tree(F.TORQUE_BEHIND, 1),
    "EI": parameter("EI"),
    "spring_length": element("spring", "length"),
    "u_motordot": run_time_input("motor", 1),
    "t": t,
    "c7a_i_1": quantity(F.C7_AMPLITUDES, 1, shapes=(I,)),
    "c10a_i_2": quantity(F.C10_AMPLITUDES, 2, shapes=(I,)),
    "c9dotdot_1": quantity(F.C9_RATES, 1),
    "c10dotdot_3": quantity(F.C10_RATES, 3),
    "even_11": local("even", 1, 1),
    "N_2": quantity(F.PRELOAD, shapes=(2,)),
    "at_rest": quantity(F.PRELOAD_WORK),
    "phi_t": state_rate(quantity(F.ANGLE)),
}
SYMBOLS = tuple(NAMES.values())


@pytest.mark.parametrize("name", NAMES)
def test_names_are_as_printed(name: str) -> None:
    assert str(NAMES[name]) == NAMES[name].name == NAMES[name].identity.name == name


def test_every_family_has_a_name_here() -> None:
    assert {s.identity.family for s in SYMBOLS} == set(Family)


def test_a_symbol_is_its_identity_and_no_plain_symbol() -> None:
    for symbol in SYMBOLS:
        again = symbol.identity.symbol
        assert again == symbol and hash(again) == hash(symbol) and again is symbol
        assert symbol != sp.Symbol(symbol.name) and identity(symbol) is symbol.identity
    guide, lever = (Symbol(Identity(family, owner="crank")) for family in (F.GUIDE, F.LEVER))
    assert guide.name == lever.name == "crank_s" and guide != lever and sp.expand(guide - lever) != 0
    assert parameter("m", positive=True) != parameter("m") and parameter("m", positive=True).is_positive
    with pytest.raises(TypeError, match="x is no symbol of the derivation"):
        identity(sp.Symbol("x"))


def test_generic_indices_are_known() -> None:
    assert [is_indexed(NAMES[n]) for n in ("alphadot_j", "c7_i_j_1", "alpha12ddot", "c8_1_12")] == [1, 1, 0, 0]
    assert not is_indexed(sp.Symbol("c2_i_1")) and not is_indexed(sp.S.One)
    assert vector(F.C2, 3, shapes=(I,)).free_symbols == {quantity(F.C2, k, shapes=(I,)) for k in (1, 2, 3)}


def test_a_generic_symbol_is_an_element_of_an_array_and_any_other_is_itself() -> None:
    arrays = {"alphadot_j": "alphadot", "c7_i_j_1": "c7_1", "d3_i_1": "d3_1", "c8_1_12": "c8_1_12", "phidot": "phidot"}
    assert {name: NAMES[name].identity.array for name in arrays} == arrays


@pytest.mark.parametrize("symbol", [*SYMBOLS, parameter("m", positive=True)], ids=str)
def test_symbols_survive_pickling_and_copying(symbol: Symbol) -> None:
    for again in (pickle.loads(pickle.dumps(symbol)), copy.copy(symbol), copy.deepcopy(symbol)):
        assert again == symbol and again.identity == symbol.identity and again.assumptions0 == symbol.assumptions0
    expr = 2 * symbol**2 + sp.sin(symbol)
    assert pickle.loads(pickle.dumps(expr)) == expr


def test_sums_and_products_are_ordered_like_those_of_plain_symbols() -> None:
    """The order holds between powers and functions, too; where half of the symbols are plain, as they are printed."""
    products = sum(SYMBOLS[::3]) * sum(SYMBOLS[1::3]) - 3 * sum(SYMBOLS[2::3]) ** 2 + sp.prod(SYMBOLS)
    functions = sum(a * b**2 * sp.sin(c) for a, b, c in zip(SYMBOLS[::3], SYMBOLS[1::3], SYMBOLS[2::3], strict=False))
    expr = sp.expand(products) + functions + sum(SYMBOLS) + sum(map(sp.cos, SYMBOLS))
    mixed = expr.xreplace({symbol: plain(symbol) for symbol in SYMBOLS[::2]})
    assert len(expr.args) > 400
    assert str(expr) == str(mixed) == str(plain(expr))
    assert _in_order(expr) == _in_order(plain(expr))


def _in_order(expr: sp.Expr) -> list[list[str]]:
    """The arguments of a sum and of its terms as SymPy keeps them."""
    return [list(map(str, part.args)) for part in (expr, *expr.args)]


# Models.


@cache
def model(name: str) -> Any:
    if name == "flat beam":
        return beams.made("point", 2).equations
    derived = derive.derive(derive.read(ROOT / "scenes" / f"{name}.toml"))
    return derived if name == "body_symbolic" else derived.expanded()


def symbols_of(value: Any) -> Iterator[sp.Symbol]:
    """All symbols in the formulas of a dataclass; reasons name whole tables (c1), which no formula holds."""
    if isinstance(value, Reason):
        return
    if isinstance(value, sp.Basic | sp.MatrixBase):
        yield from value.free_symbols
    elif is_dataclass(value):
        for field in fields(value):
            yield from symbols_of(getattr(value, field.name))
    elif isinstance(value, tuple | list | set | frozenset):
        for part in value:
            yield from symbols_of(part)
    elif isinstance(value, dict):
        for item in value.items():
            yield from symbols_of(item)


@pytest.mark.parametrize("name", ["flat beam", "body_symbolic", "double_pendulum", "crank_slider_3"])
def test_no_two_symbols_of_a_model_have_one_name(name: str) -> None:
    found = set(symbols_of(model(name)))
    assert len(found) > 20 and all(isinstance(symbol, Symbol) for symbol in found)
    assert len({symbol.name for symbol in found}) == len(found)

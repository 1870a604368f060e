"""Heat conduction with known solutions, on the shipped mesh or on finer cells.

A display of 1e12 J/K steps a surface. A module whose only effect is its Joule heat, on a plate without capacity, is a
constant heat flow. The reference values are proved: by their closed forms and by inverting their transforms.
"""

import itertools
import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvalsh_tridiagonal
from scipy.optimize import brentq
from scipy.special import erf, erfc, erfcx

from thermicon.circuit import Rig
from thermicon.circuit.rig.parts import Contact
from thermicon.circuit.rig.skin import CELL_GROWTH, FIRST_CELL_M, Layer, Skin, SkinColumn, column_of
from thermicon.circuit.solver.batch_inputs import Bank, cut, run_forward
from thermicon.circuit.solver.network import RECORDED, SKIN, Network, network_of, network_on
from thermicon.circuit.solver.steady import state_under_current

REFERENCE = tomllib.loads((Path(__file__).parents[2] / "reference" / "closed_forms.toml").read_text(encoding="utf-8"))
VALUES: list[dict[str, Any]] = REFERENCE["value"]
BODY, E_ALUMINA = REFERENCE["body"], REFERENCE["alumina"]["effusivity_W_s05_per_m2K"]
BLOOD: float = BODY["blood_J_per_m3K"]
RESISTANCE, FILM = 5.4e-4, 1852.0

THENAR, PRINTED = Rig.load("thenar"), Rig.load("shani2021")
RATE = 1000
HEAVY = {"module.cold_plate_J_per_K": 1e12}
ONLY_JOULE = {
    "module.seebeck_V_per_K": 1e-15, "module.thermal_resistance_K_per_W": 1e15, "module.cold_plate_J_per_K": 1e-9,
}  # fmt: skip


def uniform(perfusion: float = 0.0, thickness_mm: float = 30.0, deep_C: float = 0.0, **changes: float) -> Rig:
    layer = {"name": "dermis", "thickness_mm": thickness_mm, "perfusion_per_s": perfusion}
    layer |= {key: BODY[key] for key in ("conductivity_W_per_mK", "density_kg_per_m3", "heat_capacity_J_per_kgK")}
    depths: dict[str, Any] = {
        "skin.depth_from": "surface",
        "skin.cold_receptor_mm": 0.5,
        "skin.warm_receptor_mm": 1.0,
        "contact.resistance_m2K_per_W": 1e-3,
    }
    return THENAR.with_(**{"skin.layer": [layer], "skin.deep_C": deep_C, **depths, **changes})


def lumps(skin: Skin, fine: int, coarser: float = 1.0) -> SkinColumn:
    return column_of(skin, BLOOD, coarser * FIRST_CELL_M / fine, CELL_GROWTH / fine)


def circuit(rig: Rig, fine: int, display_is_face: bool = False) -> Network:
    """The rig with cells so many times finer; on request the display takes the place of the lump in the face."""
    column = lumps(rig.skin, fine)
    if display_is_face:
        rest = (column.depth_m, column.capacity_J_per_m2K, column.perfusion_W_per_m2K, column.resistance_m2K_per_W)
        column = SkinColumn(*(array[1:].copy() for array in rest))
        rig = replace(rig, contact=Contact(rig.contact.area_m2, 1e-12))
    return network_on(rig, column, rig.deep_C)


def played(
    network: Network, state: np.ndarray, end_s: float, current_A: float = 0.0,
    extra: tuple[np.ndarray, np.ndarray] | None = None, lanes: int = 1,
) -> np.ndarray:  # fmt: skip
    """Probes and further readings under a held current, a row every millisecond so that the mesh is what errs."""
    bank, one, rows = Bank.of([network]), np.zeros(1, dtype=np.int64), np.arange(round(end_s * RATE) + 1) / RATE
    intervals = cut(rows, np.array([0.0, end_s]), np.full((1, 2), current_A), held=True)
    many = np.repeat(one, lanes)
    return run_forward(bank, many, many, intervals, bank.states([state] * lanes), extra=extra)[:, -1]


def half_space(case: str, fine: int, lanes: int = 1) -> np.ndarray:
    stepped, pennes = case in ("B1", "B3", "B7"), BODY["perfusion_per_s"] if case in ("B7", "B8") else 0.0
    flow, end = {"B2": 1000.0, "B8": 100.0}.get(case, 0.0), 60.0 if pennes else 2.0
    # The rig's 9 cm² get I²R/2 at 1 A; such a display starts where it will stay, above the face by flow · contact.
    module = HEAVY if stepped else ONLY_JOULE | {"module.resistance_ohm": 2 * 9e-4 * flow}
    network = circuit(uniform(pennes, **module), fine, display_is_face=case in ("B1", "B7"))
    state = np.zeros(len(network.capacity_J_per_K) + 3)
    state[1] = 1.0 if stepped else flow * 1e-3
    return played(network, state, end, current_A=0.0 if stepped else 1.0, lanes=lanes)


def two_bodies(resistance: float, fine: int) -> np.ndarray:
    """Skin face °C and heat flow into the skin of 80 mm of alumina at 26 °C and 30 mm of skin at 32 °C, joined at 0 s.

    One column from two: the mesh of the alumina turned over, its face towards the skin's. In perfect contact the two
    lumps in the faces are one, which starts at their mean by heat.
    """
    skin = uniform(**HEAVY)
    alumina = Layer("alumina", 0.08, E_ALUMINA**2 / (3900 * 880), 3900, 880)
    above = lumps(Skin("plate", 26, 1e-3, 2e-3, (alumina,)), fine, coarser=8.0)  # heat runs 8 times as far in it
    below = lumps(skin.skin, fine)
    upper, lower = above.capacity_J_per_m2K[::-1], below.capacity_J_per_m2K
    between = [above.resistance_m2K_per_W[:0:-1], [resistance], below.resistance_m2K_per_W[1:]]
    start = np.concatenate([[26, 26], np.full(len(upper), 26.0), np.full(len(lower), 32.0), [32]])
    capacity, face = np.concatenate([upper, lower]), SKIN + len(upper)
    if resistance == 0:
        del between[1]
        both, face = upper[-1] + lower[0], face - 1
        capacity = np.concatenate([upper[:-1], [both], lower[1:]])
        start = np.delete(start, face)
        start[face] = (upper[-1] * 26 + lower[0] * 32) / both
    n, per = len(capacity), 1 / resistance if resistance else 0.0
    column = SkinColumn(np.arange(n) * 1.0, capacity, np.zeros(n), np.concatenate(between))
    readings = np.array([face - 1, face - 1]), np.array([[0.0, 1.0, 0.0], [per, -per, 0.0]])
    return played(network_on(skin, column, 32.0), start, 8.0, extra=readings)[len(RECORDED) :]


def slowest(network: Network, count: int) -> np.ndarray:
    """Time constants in s of dT/dt = A·T for the lumps between a held display and the deep node."""
    g, heat = network.conductance_W_per_K, network.capacity_J_per_K
    diagonal = (g[:-1] + g[1:] + network.perfusion_W_per_K) / heat
    beside = -g[1:-1] / np.sqrt(heat[:-1] * heat[1:])  # A made symmetric by √capacity
    return 1 / eigvalsh_tridiagonal(diagonal, beside, select="i", select_range=(0, count - 1))


@cache
def solved(case: str, fine: int) -> Any:
    if case in ("B4", "B5"):
        return two_bodies(RESISTANCE if case == "B5" else 0.0, fine)
    if case == "B6":  # a display held at 25 °C behind a contact of 1/10 m²·K/W is that air
        held = {"heat_sink.temperature_C": 25.0, "heat_sink.resistance_K_per_W": 1e-12}
        film_ = {"contact.resistance_m2K_per_W": 0.1, "skin.cold_receptor_mm": 5.0, "skin.warm_receptor_mm": 6.0}
        stiff = {"module.thermal_resistance_K_per_W": 1e-12}
        network = circuit(uniform(BODY["perfusion_per_s"], deep_C=37.0, **held, **film_, **stiff), fine)
        return network, state_under_current(network, 0.0)
    if case == "B9":
        return slowest(circuit(uniform(thickness_mm=2.0), fine, display_is_face=True), 1)
    if case == "B10":
        return slowest(circuit(replace(PRINTED, skin=replace(PRINTED.skin, elements=None)), fine, True), 4)
    if case == "B11":
        rig = PRINTED.with_(**{"contact.resistance_m2K_per_W": 1 / FILM})
        return slowest(circuit(replace(rig, skin=replace(rig.skin, elements=None)), fine), 3)
    return half_space(case, fine)


def ours(row: dict[str, Any], fine: int) -> float:
    case, found, depth = row["case"], solved(row["case"], fine), row.get("depth_mm", 0.0)
    if "mode" in row:
        return float(found[row["mode"] - 1])
    if case in ("B4", "B5"):
        return float(found[1 if row["what"] == "heat flow" else 0, round(row["time_s"] * RATE)])
    probe = {0.0: "skin_C", 0.5: "cold_receptor_C", 1.0: "warm_receptor_C", 5.0: "cold_receptor_C"}[depth]
    if row["what"] == "heat flow":
        probe = "heat_flow_cold_receptor_W_per_m2" if depth else "heat_flow_skin_W_per_m2"
    if case == "B6":
        return found[0].read(found[1], probe)
    return float(found[RECORDED.index(probe), round(row["time_s"] * RATE)])


def name(row: dict[str, Any]) -> str:
    return " ".join(str(row[key]) for key in ("case", "what", "depth_mm", "mode", "time_s") if key in row)


@pytest.mark.parametrize("row", VALUES, ids=name)
def test_the_circuit_gives_the_known_value(row: dict[str, Any]) -> None:
    errors = np.array([ours(row, fine) - row["value"] for fine in (1, 2, 4)])
    assert abs(errors[0]) < row["tolerance"]
    assert abs(errors[2]) < row["tolerance"] / 10
    assert np.all(errors[:-1] / errors[1:] > 2.8), errors  # halving the cells: a factor of about four


def test_the_printed_elements_have_the_time_constants_of_the_slab_only_roughly() -> None:
    # Through the rig as people load it, its contact resistance as the film: 1 + 5 elements, then 2, 4, 8 times as many.
    known = np.array([row["value"] for row in VALUES if row["case"] == "B11"])
    contact = {"contact.resistance_m2K_per_W": 1 / FILM}
    off = np.array(
        [
            slowest(network_of(PRINTED.with_(**{"skin.elements": [times, 5 * times], **contact})), 3) / known - 1
            for times in (1, 2, 4, 8)
        ]
    )
    assert off[0] == pytest.approx([0.030, 0.114, 0.263], abs=1e-3)  # why an onset needs more than 1 + 5
    assert np.all(off[-1] < 0.004)
    assert np.all(off[:-1] / off[1:] > 3.8)


def test_a_body_in_perfect_contact_has_its_temperature_at_once_and_keeps_it() -> None:
    (known,) = [row["value"] for row in VALUES if row["case"] == "B4"]
    face = solved("B4", 4)[0]
    assert face[[50, 100, 200, 500, 1000, 2000, 5000]] == pytest.approx(known, abs=3e-5)


@pytest.mark.parametrize("case", ["B1", "B2", "B3"])
def test_blocks_of_runs_solve_the_same_cases(case: str) -> None:
    block = half_space(case, 1, lanes=8)  # so many are stepped side by side
    assert block[:5] == pytest.approx(solved(case, 1)[:5], abs=1e-6)


UPPER = REFERENCE["epidermis"]
K, HEAT = BODY["conductivity_W_per_mK"], BODY["density_kg_per_m3"] * BODY["heat_capacity_J_per_kgK"]
ALPHA, E_SKIN = K / HEAT, math.sqrt(K * HEAT)
PERFUSED = BODY["perfusion_per_s"] * BODY["blood_J_per_m3K"]  # W/(m³·K)


def spread(x: float, t: float) -> float:
    return x / (2 * math.sqrt(ALPHA * t))


def stepped_surface(what: str, x: float, t: float) -> float:
    u = spread(x, t)
    return float(erfc(u)) if what == "temperature" else E_SKIN / math.sqrt(math.pi * t) * math.exp(-u * u)


def constant_flow(what: str, x: float, t: float, flow: float = 1000.0) -> float:
    u = spread(x, t)
    return float(flow / K * (2 * math.sqrt(ALPHA * t / math.pi) * math.exp(-u * u) - x * erfc(u)))


def behind_film(what: str, x: float, t: float, h: float = 1000.0) -> float:
    u = spread(x, t)  # exp(hx/k + h²αt/k²)·erfc(u + b) = exp(−u²)·erfcx(u + b)
    return float(math.exp(-u * u) * (erfcx(u) - erfcx(u + h / K * math.sqrt(ALPHA * t))))


def perfect_contact(what: str, x: float, t: float) -> float:
    return (E_SKIN * 32 + E_ALUMINA * 26) / (E_SKIN + E_ALUMINA)


def resisted_contact(what: str, x: float, t: float) -> float:
    left = float(erfcx((1 / E_SKIN + 1 / E_ALUMINA) / RESISTANCE * math.sqrt(t)))
    return 32 - 6 * E_ALUMINA / (E_SKIN + E_ALUMINA) * (1 - left) if what == "temperature" else -6 / RESISTANCE * left


def perfused_slab(what: str, x: float, t: float, h: float = 10.0, deep: float = 0.03) -> float:
    m = math.sqrt(PERFUSED / K)
    return 37 - 12 * h * math.sinh(m * (deep - x)) / (K * m * math.cosh(m * deep) + h * math.sinh(m * deep))


def perfused_stepped(what: str, x: float, t: float) -> float:
    mx, root, u = math.sqrt(PERFUSED / K) * x, math.sqrt(PERFUSED / HEAT * t), spread(x, t)
    return float(math.exp(-mx) * erfc(u - root) + math.exp(mx) * erfc(u + root)) / 2


def perfused_flow(what: str, x: float, t: float, flow: float = 100.0) -> float:
    return float(flow / math.sqrt(K * PERFUSED) * erf(math.sqrt(PERFUSED / HEAT * t)))


@cache
def two_layers(h: float) -> list[float]:
    """Time constants in s, slowest first, of the printed slab over a fixed deep face; an infinite h fixes the upper."""
    k1, h1, h2 = UPPER["conductivity_W_per_mK"], UPPER["thickness_mm"] * 1e-3, 2e-3
    root1, root2 = math.sqrt(k1 / (UPPER["density_kg_per_m3"] * UPPER["heat_capacity_J_per_kgK"])), math.sqrt(ALPHA)

    def deep_face(p: float) -> float:
        m1, m2 = p / root1, p / root2
        open_ = k1 * m1 / h  # T = open·cos + sin in the upper layer
        at = open_ * math.cos(m1 * h1) + math.sin(m1 * h1)
        slope = k1 * m1 * (math.cos(m1 * h1) - open_ * math.sin(m1 * h1)) / (K * m2)
        return at * math.cos(m2 * h2) + slope * math.sin(m2 * h2)

    tries = np.linspace(0.1, 3.0, 300).tolist()
    pairs = [(a, b) for a, b in itertools.pairwise(tries) if deep_face(a) * deep_face(b) < 0]
    return [float(brentq(deep_face, a, b, xtol=1e-15)) ** -2 for a, b in pairs]


CLOSED: dict[str, Callable[[str, float, float], float]] = {
    "B1": stepped_surface,
    "B2": constant_flow,
    "B3": behind_film,
    "B4": perfect_contact,
    "B5": resisted_contact,
    "B6": perfused_slab,
    "B7": perfused_stepped,
    "B8": perfused_flow,
}
MODES = {"B9": [4e-6 / (math.pi**2 * ALPHA)], "B10": two_layers(math.inf), "B11": two_layers(FILM)}


@pytest.mark.parametrize("row", VALUES, ids=name)
def test_the_reference_is_the_closed_form(row: dict[str, Any]) -> None:
    case, value = row["case"], row["value"]
    if case in MODES:
        assert MODES[case][row["mode"] - 1] == pytest.approx(value, rel=1e-12)
    else:
        assert CLOSED[case](row["what"], row["depth_mm"] * 1e-3, row.get("time_s", 0.0)) == pytest.approx(
            value, rel=1e-12
        )
    assert {"title", "formula", "source"} <= REFERENCE["case"][case].keys()


# Rises of the surface of a half-space as Laplace transforms: what meets its impedance 1 / (e·√(s + Ω)) there.
TRANSFORMS: dict[str, Callable[[complex, str, float], complex]] = {
    "B1": lambda s, what, x: (E_SKIN * s**0.5 if what == "heat flow" else 1) * fall(s, x) / s,
    "B2": lambda s, what, x: 1000 / s / (E_SKIN * s**0.5) * fall(s, x),
    "B3": lambda s, what, x: 1 / s * 1000 / (1000 + E_SKIN * s**0.5) * fall(s, x),
    "B4": lambda s, what, x: 32 / s - 6 / s / (1 + E_SKIN / E_ALUMINA),
    "B5": lambda s, what, x: through_contact(s, what),
    "B7": lambda s, what, x: fall(s + PERFUSED / HEAT, x) / s,
    "B8": lambda s, what, x: 100 / s / (E_SKIN * (s + PERFUSED / HEAT) ** 0.5),
}


def fall(s: complex, x: float) -> complex:
    return complex(np.exp(-x * (s / ALPHA) ** 0.5))


def through_contact(s: complex, what: str) -> complex:
    flow = -6 / s / (RESISTANCE + 1 / (E_SKIN * s**0.5) + 1 / (E_ALUMINA * s**0.5))
    return flow if what == "heat flow" else 32 / s + flow / (E_SKIN * s**0.5)


@pytest.mark.parametrize("row", [row for row in VALUES if row["case"] in TRANSFORMS], ids=name)
def test_the_reference_is_the_inverse_of_its_transform(row: dict[str, Any]) -> None:
    # Fixed Talbot contour: a second way to the same values that knows no error function.
    time, order = row["time_s"], 24
    theta = np.arange(1, order) * np.pi / order
    cot = 1 / np.tan(theta)
    places = np.append(0.4 * order, 0.4 * order * theta * (cot + 1j)) / time
    weights = np.append(0.5, 1 + 1j * (theta + (theta * cot - 1) * cot))
    values = [TRANSFORMS[row["case"]](complex(s), row["what"], row["depth_mm"] * 1e-3) for s in places]
    total = float((np.exp(places * time) * weights * values).real.sum()) * 0.4 / time
    assert total == pytest.approx(row["value"], rel=1e-8)

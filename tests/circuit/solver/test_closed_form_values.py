"""The reference values of heat conduction, proved: by their closed forms and by inverting their transforms."""

import itertools
import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import erf, erfc, erfcx

from tests.circuit.solver.test_closed_forms import BODY, E_ALUMINA, FILM, REFERENCE, RESISTANCE, VALUES, name

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


def film(what: str, x: float, t: float, h: float = 1000.0) -> float:
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
    "B3": film,
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
    decimals = len(row["rounded"].partition(".")[2])
    assert f"{value:.{decimals}f}" == row["rounded"]
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

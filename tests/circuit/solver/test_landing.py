"""A hand that lands: against the closed form of two bodies that meet, its limits in time, and what it cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, simulate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.landing import landing_state, start_under
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current
from thermicon.icons import Icon, parse

THENAR = Rig.load("thenar")


def lands(seconds: float, rig: Rig = THENAR) -> Rig:
    return rig.with_(**{"contact.lands_s": seconds})


def hold(level_C: float, control: str = "display") -> Icon:
    text = f"cue 1\nset s {{\n  control {control}\n  baseline {level_C} °C\n}}\nicon a {{\n  hold for 20 s\n}}\n"
    return parse(text)["a"]


def test_before_it_lands_skin_is_at_rest_and_the_display_in_air() -> None:
    rig = lands(-2.0)
    state, net = landing_state(rig, current_A=0.1), network_of(rig)
    assert state[2] == pytest.approx(32.0)
    flux = (state[2:-1] - np.append(state[3:-1], rig.deep_C)) * net.conductance_W_per_K[1:]
    assert flux[0] < 0
    loss = rig.ambient.film_W_per_m2K * (32.0 - rig.ambient.temperature_C) * rig.contact.area_m2
    assert loss == pytest.approx(0.072)  # what the lumps bring to the surface, the air takes
    half = net.perfusion_W_per_K[0] * (rig.deep_C - state[2])
    assert half - flux[0] == pytest.approx(loss, rel=1e-9)
    absorbed = rig.module.heat_absorbed_W(0.1, float(state[1]), float(state[0]))
    assert absorbed == pytest.approx(10.0 * 9e-4 * (24.0 - state[1]), abs=1e-9)


def test_a_block_of_skin_that_meets_a_display_follows_the_closed_form() -> None:
    # Semi-infinite dermis at 32 °C, its face suddenly 5.4e-4 m²K/W from 26 °C: erfc with h = 1/R'' (B3 of convection).
    from scipy.special import erfcx

    layer = {"name": "dermis", "thickness_mm": 40.0, "conductivity_W_per_mK": 0.45, "density_kg_per_m3": 1060.0,
             "heat_capacity_J_per_kgK": 3300.0, "perfusion_per_s": 0.0}  # fmt: skip
    rig = lands(0.0).with_(**{
        "skin.layer": [layer], "skin.deep_C": 32.0, "skin.depth_from": "surface", "skin.cold_receptor_mm": 0.5,
    })  # fmt: skip
    trace = simulate(hold(26.0), rig)
    h, effusivity = 1 / 5.4e-4, np.sqrt(0.45 * 1060 * 3300)
    t = trace.time_s[10:]
    exact = 26.0 + 6.0 * erfcx(h * np.sqrt(t) / effusivity)
    assert trace.display_C[0] == pytest.approx(26.0)
    assert np.abs(trace.display_C - 26.0).max() < 0.2  # it warms the display a little at first
    assert np.abs(trace.skin_C[10:] - exact).max() < 0.2
    assert np.abs(trace.skin_C[500:] - exact[490:]).max() < 0.01


@pytest.mark.parametrize(("level_C", "side"), [(29.0, 1), (35.0, -1)])
def test_skin_tends_to_where_a_resting_hand_is(level_C: float, side: int) -> None:
    settled = simulate(hold(level_C), THENAR).warm_receptor_C[0]
    away = [
        side * (simulate(hold(level_C), lands(s)).warm_receptor_C[0] - settled) for s in (0.0, -2.0, -120.0, -600.0)
    ]
    assert away[0] > 2.5
    assert 0.9 < away[1] < 2.0
    assert 0.05 < away[2] < 0.11
    assert 0 < away[3] < 0.02
    display = simulate(hold(level_C), lands(-2.0)).display_C
    assert np.abs(display - level_C).max() < 1e-3


def test_an_earlier_landing_is_the_later_part_of_the_same_run() -> None:
    long = simulate(hold(29.0), lands(-2.0), tail_s=5.0)
    late = simulate(hold(29.0), lands(-7.0))
    assert np.abs(long.skin_C[500:2001] - late.skin_C[:1501]).max() < 1e-5
    drive, rig = Drive([0, 10], [0.3, 0.3]), lands(-1.0)
    first, second = simulate_current(drive, rig), simulate_current(drive, lands(-4.0))
    assert np.abs(first.skin_C[300:] - second.skin_C[:701]).max() < 1e-4


def test_a_current_holds_the_bare_display_before() -> None:
    plan = design(hold(29.0), lands(-0.5), 2.0)
    assert len(plan.lead_A) == 51
    assert landing_state(lands(-0.5), current_A=float(plan.lead_A[0]))[1] == pytest.approx(29.0)
    away = start_under(lands(-600.0), 0.08) - state_under_current(network_of(THENAR), 0.08)
    assert np.abs(away[:10]).max() < 0.01
    assert design(hold(29.0), THENAR, 2.0).lead_A is None


def test_a_display_that_air_does_not_let_cool_is_refused() -> None:
    weak = lands(-1.0).with_(**{"heat_sink.resistance_K_per_W": 60.0, "ambient.temperature_C": 45.0,
                                "skin.deep_C": 34.0})  # fmt: skip
    with pytest.raises(RigError, match=r"baseline|before the hand lands"):
        simulate(hold(18.0), weak)

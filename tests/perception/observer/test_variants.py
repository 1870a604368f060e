from dataclasses import replace
from typing import Any

import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library
from thermicon.perception import Observer, perceive
from thermicon.perception.observer.channels import VARIABLES, Variable, check_variable
from thermicon.perception.observer.observer import Receptor
from thermicon.perception.sensation.bench import Bench, ramp


@pytest.mark.parametrize("variable", VARIABLES)
def test_every_variant_loads_and_is_near_the_thresholds_it_was_inferred_from(variable: Variable) -> None:
    """Published for 0.11 and 0.20 K on the thenar; laboratories differ by 20 to 40 %."""
    person = Observer.load(variable=variable)
    assert person.variable == variable
    rig, icons = Rig.load("thenar"), load_library("six-icons")
    felt = [perceive(simulate(icons[name], rig, tail_s=2.0), person) for name in ("cooling-step", "warming-step")]
    assert [percept.channel for percept in felt] == ["cold", "warm"]
    bench = Bench(rig)
    for channel, published in (("cold", 0.11), ("warm", 0.20)):
        half, twice = (bench.play([ramp(channel, share * published, 1.0)], 4.0) for share in (0.5, 2.0))
        assert max(psi.max() for psi in half.felt(person)) < 1.0 < max(psi.max() for psi in twice.felt(person))


@pytest.mark.parametrize("variable", ["temperature", "heat flow"])
def test_both_ways_to_count_depth_reach_the_percept(variable: Variable) -> None:
    """From the base of the stratum corneum (0.17 mm on the thenar) receptors are deeper, felt later and less."""
    person, icon = Observer.load(variable=variable), load_library("six-icons")["warming-step"]
    base = Rig.load("thenar")
    surface = base.with_(**{"skin.depth_from": "surface"})
    assert surface.skin.warm_receptor_m == pytest.approx(0.21e-3)
    assert base.skin.warm_receptor_m == pytest.approx(0.38e-3)
    traces = [simulate(icon, rig, tail_s=3.0) for rig in (surface, base)]
    same = simulate(icon, surface.with_(**{"skin.cold_receptor_mm": 0.27, "skin.warm_receptor_mm": 0.38}), tail_s=3.0)
    felt = [perceive(trace, person) for trace in (*traces, same)]
    assert felt[1].psi_warm == pytest.approx(felt[2].psi_warm, abs=1e-6)
    assert felt[1].onset_s > felt[0].onset_s + 0.05
    assert felt[1].psi_warm.max() < felt[0].psi_warm.max()


def test_heat_flow_fades_in_a_hold_where_temperature_does_not() -> None:
    played = Bench(Rig.load("thenar")).play([ramp("cold", 1.0, 1.0, 5.0)], 6.0)
    left = []
    for variable in ("temperature", "heat flow"):
        cold = played.felt(Observer.load(variable=variable))[0][0]  # type: ignore[arg-type]
        left.append(cold[-1] / cold.max())
    assert left[1] < 0.7 * left[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"adaptation_s": 0.0}, r"adaptation_s = 0 must be above 0"),
        ({"softness_K": 0.0}, r"softness_K = 0 must be above 0"),
        ({"forearm_factor": 0.0}, r"forearm_factor = 0 must be above 0"),
        ({"neutral_flux": (3.0, 3.0)}, r"neutral heat flow 3 to 3 W/m² is empty"),
    ],
)
def test_a_receptor_proves_itself(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(Receptor(20.0, 0.1, 2.0, 0.5), **change)


def test_messages(observer: Observer) -> None:
    with pytest.raises(ValueError, match=r"no sensory variable 'flux': choose one of temperature, heat flow"):
        check_variable("flux")
    with pytest.raises(ValueError, match=r"observer of heat flow needs the neutral heat flow of both channels"):
        replace(observer, variable="heat flow")

"""Which keys can be fitted, and what is said about those that cannot."""

from __future__ import annotations

import pytest

from thermicon.circuit import Rig
from thermicon.circuit.fitting.keys import FitError, fittable, free_keys, value_of


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ([], "no key to fit; name one or several, such as contact.resistance_m2K_per_W"),
        (["contact.area_cm2", "contact.area_cm2"], r"contact\.area_cm2: is given twice; name each key once"),
        (["module.sebeck_V_per_K"], r"module\.sebeck_V_per_K: cannot be fitted; did you mean module\.seebeck_V_per_K"),
        (
            ["skin.layer.dermis.thickness_mm"],
            "is a key of a rig, but no log identifies it; keys that can be fitted: c",
        ),
        (["colour"], "colour: unknown key; .*keys that can be fitted: contact"),
        (["thermode.lag_s"], r"rig thenar has no thermode with this key; it has contact\.resistance"),
        (["probe.a.lag_s"], r"rig thenar has no such probe; describe the sensor first, as with --set 'probe="),
        (["heat_sink.capacity_J_per_K"], "rig thenar has no heat sink with this key"),
    ],
)
def test_a_key_that_cannot_be_fitted_is_named_with_a_cure(keys: list[str], message: str, thenar: Rig) -> None:
    with pytest.raises(FitError, match=message):
        free_keys(keys, thenar)


def test_every_fault_is_named_at_once(thenar: Rig) -> None:
    with pytest.raises(FitError, match=r"thermode.lag_s: .*\ncontroller.lag_s: "):
        free_keys(["thermode.lag_s", "controller.lag_s"], thenar)


def test_each_rig_offers_its_own_keys(thenar: Rig) -> None:
    sensed = thenar.with_(probe=[{"name": "thermistor", "place": "display", "lag_s": 0.2}])
    assert fittable(sensed)[-1] == "probe.thermistor.lag_s"
    assert value_of(sensed, "probe.thermistor.lag_s") == 0.2
    thermode = Rig.load("tcs2")
    assert {"thermode.lag_s", "thermode.slew_K_per_s"} < set(fittable(thermode))
    assert not any(key.startswith(("module", "driver")) for key in fittable(thermode))
    assert all(value_of(thenar, key) is not None for key in fittable(thenar))

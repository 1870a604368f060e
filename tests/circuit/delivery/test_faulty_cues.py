"""Cues whose faults a coarse check would miss."""

from pathlib import Path

import numpy as np
import pytest

from tests.builders import messages
from tests.circuit.delivery.one_drive import icon_of, prepare, worst_case
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Drive, Rig
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.prepare import Prepared
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.safety.ensemble import Ensemble, row_of
from thermicon.icons import Icon

THENAR = Rig.load("thenar")
FEWER = sure_rig("thenar", "gain_relative", "ambient_K", "heat_sink_K")
AMP = messages(__file__)["device"].replace("2.0", "6.0").replace("value = 12", "value = 16").replace("500", "1000")
"""A strong source of current."""
TRAIN = "repeat 10 { pulse by 3 A for 40 ms; pulse by -3 A for 40 ms; hold for 20 ms }; hold for 2 s"


def train(hold_s: float) -> Icon:
    return icon_of(f"hold for {hold_s:g} s; {TRAIN}", "current")


@pytest.fixture
def amp(tmp_path: Path) -> Device:
    path = tmp_path / "amp.toml"
    path.write_text(AMP, "utf-8")
    return Device.load(path)


def strong() -> Rig:
    return sure_rig().with_(**{"driver.current_limit_A": 6.0, "driver.update_Hz": 1000, "driver.voltage_limit_V": 60.0})


def ready(shape: str, rig: Rig) -> Prepared:
    return prepare(icon_of(shape), rig, Device.load("dac-16"), load_format("csv"), pause_s=120.0)


def test_a_step_back_at_the_very_end_is_judged_with_the_current_it_leaves_on() -> None:
    icon = icon_of("warm by 5 °C at 2 °C/s; hold for 1 s; step to 32 °C")
    delivery = deliver(icon, FEWER, Device.load("dac-16"))
    current = delivery.delivered.current_A
    assert current[-1] == pytest.approx(current[0], abs=1e-3), "the drive ends with its rest"
    found = worst_case(delivery, 120.0)
    assert found.after_C["last value held"] == pytest.approx(32.0, abs=0.6)


@pytest.mark.parametrize("kind", ["cool by 26 °C", "warm by 12 °C"])
def test_pulses_between_slow_updates_are_missed_and_said_to_be(kind: str) -> None:
    """At one update a second every pulse falls between two: nothing is delivered, and the cue is not reached."""
    shape = f"rest for 250 ms; repeat 20 {{ pulse {kind} for 500 ms; rest for 500 ms }}"
    one = ready(shape, FEWER.with_(**{"driver.update_Hz": 1.0}))
    assert [refusal.kind for refusal in one.refusals] == ["unreachable"]
    assert "its step at 0.25 s does not arrive in time" in str(one.refusals[0])


@pytest.mark.slow
def test_what_is_unsafe_on_a_weak_driver_is_not_forced() -> None:
    one = ready("cool to 8 °C at 2 °C/s; hold for 60 s; return at 2 °C/s", FEWER)
    unsafe = [refusal for refusal in one.refusals if not refusal.forcible]
    assert [refusal.kind for refusal in unsafe] == ["unsafe"]
    assert "NOT SAFE: " in str(unsafe[0])
    assert "below the hard limit of 15 °C" in str(unsafe[0])
    with pytest.raises(FormatError, match="a: NOT SAFE: "):
        pack([one], load_format("csv"))


def test_a_train_of_pulses_after_a_hold_is_seen_in_full(amp: Device) -> None:
    found = worst_case(deliver(train(10.0), strong(), amp), 120.0)
    rate = [one for one in found.checks if one.quantity == "rate of skin temperature"]
    assert found.colour == "red"
    broken = [one for one in rate if not one.passed]
    assert broken, [str(one) for one in rate]
    assert all(10.0 < one.time_s < 11.2 for one in broken)


@pytest.mark.slow
def test_a_train_after_five_minutes_is_seen_as_one_after_ten_seconds(amp: Device) -> None:
    early, late = (worst_case(deliver(train(hold_s), strong(), amp), 120.0) for hold_s in (10.0, 300.0))
    for one, other in zip(early.checks, late.checks, strict=True):
        if one.quantity == "rate of skin temperature":
            assert other.value == pytest.approx(one.value, rel=0.02)


@pytest.mark.parametrize("length_s", [1.0, 290.0, 310.0, 2000.0])
def test_rows_are_never_coarser_than_the_updates_or_ten_milliseconds(length_s: float) -> None:
    slow = Drive([0, 1, length_s - 0.5, length_s], [0.08, 0.1, 0.1, 0.08]) if length_s > 2 else None
    ends = (0, length_s - 0.011, length_s - 0.009, length_s - 0.005, length_s)
    fast = Drive(ends, [0.08, 1.0, 0.08, 1.0, 0.08], held=True)
    few = Ensemble.of(THENAR).only([0])
    for drive, most in ((slow, 0.01), (fast, 0.002)):
        if drive is None:
            continue
        assert row_of(drive) <= most + 1e-12
        last, rows, widest = 0.0, 0, 0.0
        for (times, _), _ in few.play(drive, few.at_rest(0.08)):
            assert times[0] == pytest.approx(last), "no row is left out between stretches"
            last, rows, widest = float(times[-1]), rows + len(times), max(widest, float(np.diff(times).max()))
        assert last == pytest.approx(length_s)
        assert widest <= most + 1e-9

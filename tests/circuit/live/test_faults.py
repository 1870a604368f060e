"""Single faults of a device at any instant of a play, in corners of the rig."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.circuit.live.conftest import EVIDENCE, SEED
from tests.circuit.live.thermostat import FAULTS, Thermostat, demands_of, drives_of, played
from thermicon.circuit import Export
from thermicon.circuit.play import watch
from thermicon.circuit.play.watch import Refused

Ready = Callable[[str, float], Export]
BEGINS_S, REST_S = 38.4, 20.0
WITHIN_S = {
    "silent host": 1.1, "loop open": 0.1, "second open": 0.1, "loop off": 0.6, "second off": 0.6, "swapped": 3.6,
}  # fmt: skip
"""How long after a fault the output is off at the latest. Wires that are swapped where hardly any current flows move
the display by nothing at first."""
FROZEN_S, MOVED_K = 2.0, 0.3
PLACES = {"skin surface": 0, "cold-receptor depth": 1, "display": 2, "hot plate": 3}


def play(number: int, ready: Ready) -> tuple[str, str, float]:
    """One play with a fault: its kind, why it stopped, and after how long the output was off; asserts the limits."""
    rng = np.random.default_rng([SEED, 1, number])
    found, fault = ready(str(rng.choice(["readme", "six-icons"])), 100.0), FAULTS[number % len(FAULTS)]
    name, drive = list(drives_of(found).items())[int(rng.integers(len(found.prepared)))]
    device = Thermostat(found, rng)
    device.kp, device.ki = (float(each * rng.uniform(0.95, 1.05)) for each in (device.kp, device.ki))
    device.second.lag_s, step_K = float(rng.uniform(0.05, 0.3)), float(rng.choice([0.0, 0.01, 0.06, 0.1]))
    device.loop.step_K = device.second.step_K = step_K
    lie_K, stuck_A = float(rng.choice([-3.0, 3.0])), float(rng.choice(demands_of(found).current_limit_A or (0.0,)))
    fault_s = BEGINS_S + float(rng.uniform(0.0, drive.file_s))
    if fault == "swapped before":
        device.swap()
    else:
        device.at(fault_s, lambda: device.break_by(fault, lie_K, stuck_A))
    plays, why = played(device, found, [name], REST_S)
    device.sleep(15.0)
    assert device.goal_C is None
    assert device.current_A == 0.0
    late_s, told = device.off_at_s - fault_s, f"{number} {fault} ({name}, {fault_s - BEGINS_S:.2f} s, {why})"
    for rule in found.rig.limits.rules:
        if rule.always_hard and rule.quantity in PLACES:
            reached = device.far[2 * PLACES[rule.quantity] + int(rule.upper)]
            assert reached <= rule.limit if rule.upper else reached >= rule.limit, f"{told}: {rule.quantity} {reached}"
    assert device.rate <= 10.0, f"{told}: {device.rate:.1f} K/s"
    if fault == "swapped before":
        assert why, told
        assert np.isnan(plays[0].rms_K), told
    elif fault.endswith("frozen"):
        other = plays[0].columns["probe_second_C" if fault.startswith("loop") else "probe_loop_C"]
        times_s = device.now_s - 15.0 - plays[0].columns["time_s"][-1] + plays[0].columns["time_s"]
        from_C = np.interp(fault_s + watch.LATER_S, times_s, other)
        away = (np.abs(other - from_C) > MOVED_K) & (times_s > fault_s + watch.LATER_S)
        late_s = device.off_at_s - (times_s[away][0] if away.any() else np.inf)
        assert not why or late_s <= FROZEN_S, f"{told}: {late_s}"
    elif fault in WITHIN_S:
        assert late_s <= WITHIN_S[fault] + 1e-6, f"{told}: off after {late_s:.2f} s"
    return fault, why, late_s


def test_each_fault_stops(ready: Ready) -> None:
    for number in range(len(FAULTS)):
        play(number, ready)


@pytest.mark.slow
def test_faults_at_any_instant(ready: Ready) -> None:
    plays = [play(number, ready) for number in range(len(FAULTS), len(FAULTS) + EVIDENCE)]
    for fault in FAULTS:
        stops = [late_s for kind, why, late_s in plays if kind == fault and why]
        print(f"{fault}: {len(stops)} stopped, off after {max(stops, default=0.0):.2f} s at most")
    assert sum(bool(why) for _, why, _ in plays) > 0.7 * EVIDENCE


def test_a_device_without_a_watchdog_is_refused_before_it_rests(ready: Ready, monkeypatch: pytest.MonkeyPatch) -> None:
    device = Thermostat(ready("readme", 100.0), np.random.default_rng(0), world=0)
    monkeypatch.setattr(device, "cut", lambda why: None)
    with pytest.raises(Refused, match="silence"):
        played(device, ready("readme", 100.0), ["turn"])
    assert device.goal_C is None
    assert device.current_A == 0.0
    assert device.now_s < 7.0


@pytest.mark.parametrize("late_s, is_stopped", [(0.6, False), (1.1, True)])
def test_how_late_this_computer_may_be(late_s: float, is_stopped: bool, ready: Ready) -> None:
    """As late as the watchdog allows, since the device holds the cut-off."""
    device = Thermostat(ready("readme", 100.0), np.random.default_rng(0), world=0)
    device.at(40.0, lambda: setattr(device, "hangs_s", late_s))
    assert bool(played(device, ready("readme", 100.0), ["turn"], 20.0)[1]) == is_stopped

"""Devices without a fault, as far off as is allowed: none is stopped, and skin follows the design."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.circuit.live.conftest import EVIDENCE, SEED
from tests.circuit.live.test_faults import BEGINS_S, REST_S
from tests.circuit.live.thermostat import Thermostat, drives_of, played
from thermicon.circuit import Export
from thermicon.circuit.play.watch import Refused

Ready = Callable[[str, float], Export]
FROM_REST_K, FIRST_K = 0.060, 0.120


def play(number: int, ready: Ready) -> str:
    """Why one play was stopped."""
    rng = np.random.default_rng([SEED, 2, number])
    found = ready(str(rng.choice(["readme", "six-icons"])), float(rng.choice([10.0, 100.0])))
    name, drive = list(drives_of(found).items())[int(rng.integers(len(found.prepared)))]
    device = Thermostat(found, rng)
    device.kp, device.ki = (float(each * rng.uniform(0.8, 1.2)) for each in (device.kp, device.ki))
    for sensor in (device.loop, device.second):
        sensor.off_K, sensor.step_K = float(rng.uniform(-0.3, 0.3)), float(rng.choice([0.01, 0.06, 0.1]))
    device.second.lag_s = float(rng.uniform(0.02, 0.3))
    hand = ("stays", "lands", "stays", "lifts", "stays", "stays")[number % 6]
    if hand == "lands":
        device.touch(False)
        device.state = device.lanes.steady(np.zeros(2), np.zeros(2))[1:].copy()
        device.at(BEGINS_S - REST_S + float(rng.uniform(0.0, REST_S)), lambda: device.touch(True))
    elif hand == "lifts":
        device.at(BEGINS_S + float(rng.uniform(0.0, drive.file_s)), lambda: device.touch(False))
    try:
        plays, why = played(device, found, [name], REST_S)
    except Refused as problem:
        why = str(problem)
    if device.world[0] == 1 and ("outside" in why or "cut-off" in why):
        return ""  # a display that nobody touches is as warm as its heat sink, which may be too warm
    assert why or plays[0].ended
    return f"{number} {name}, hand {hand}: {why}" if why else ""


def test_healthy_plays_are_not_stopped(ready: Ready) -> None:
    assert "".join(play(number, ready) for number in range(6)) == ""


@pytest.mark.slow
def test_many_healthy_plays_are_not_stopped(ready: Ready) -> None:
    assert "\n".join(filter(None, (play(number, ready) for number in range(6, 6 + EVIDENCE)))) == ""


@pytest.mark.parametrize("rate_Hz", [10.0, 100.0])
@pytest.mark.parametrize("name", ["readme", "six-icons"])
def test_skin_follows_the_design(name: str, rate_Hz: float, ready: Ready) -> None:
    """On the independent circuit, as the rig is given."""
    found = ready(name, rate_Hz)
    device, drives = Thermostat(found, np.random.default_rng(1), world=0), drives_of(found)
    names = [next(iter(drives)), *drives]
    plays, why = played(device, found, names, pause_s=60.0)
    assert not why
    times, skin_C = np.array(device.skin_C).T
    ends_s = times[-1] - np.cumsum([0.0, *(np.ptp(each.columns["time_s"]) + 0.01 for each in plays[:0:-1])])[::-1]
    for place, (end_s, icon, measured) in enumerate(zip(ends_s, names, plays, strict=True)):
        assert measured.ended
        designed, rows_s = drives[icon].designed_trace, np.arange(0.0, measured.predicted.time_s[-1], 0.01)
        begun_s = end_s - measured.columns["time_s"][-1]
        off_K = np.interp(begun_s + rows_s, times, skin_C) - np.interp(rows_s, designed.time_s, designed.skin_C)
        rms_K = np.sqrt(np.mean(off_K**2))
        print(f"{name} {rate_Hz:g} Hz {place} {icon}: skin {1e3 * rms_K:.0f}, display {1e3 * measured.rms_K:.0f} mK")
        assert rms_K < (FROM_REST_K if place else FIRST_K)

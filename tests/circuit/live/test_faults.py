"""Single faults of a device at any instant of a play, in corners of the rig."""

import json
import os
from collections.abc import Callable

import numpy as np
import pytest

from tests.circuit.delivery.independent import worlds_of
from tests.circuit.live.conftest import EVIDENCE
from tests.circuit.live.thermostat import FAULTS, Thermostat, played
from thermicon.circuit.live.live_player import LivePlayer
from thermicon.circuit.live.play_live import live_numbers
from thermicon.circuit.live.play_log import PlayLog
from thermicon.circuit.live.ready import ReadySet
from thermicon.circuit.play.watch import Refused

PREPARED_S, REST_S = 18.4, 20.0
WITHIN_S = {
    "silent host": 1.1, "loop open": 0.1, "second open": 0.1, "loop off": 0.8, "second off": 0.6, "swapped": 4.0,
}  # fmt: skip
"""How long after a fault the output is off at the latest: a loop that is lied to moves the display until both sensors
show it, and wires that are swapped where hardly any current flows move it slowly."""
FROZEN_S, MOVED_K = 2.0, 0.3
PLACES = {"skin surface": 0, "cold-receptor depth": 1, "display": 2, "hot plate": 3}


def play(number: int, ready: Callable[[str, float], ReadySet]) -> tuple[str, str, float]:
    """One play with a fault: its kind, why it stopped, and after how long the output was off; asserts the limits."""
    rng = np.random.default_rng([41, number])
    found, fault = ready(str(rng.choice(["readme", "six-icons"])), 100.0), FAULTS[number % len(FAULTS)]
    drive = list(found.drives.values())[int(rng.integers(len(found.drives)))]
    device = Thermostat(found.rig, found.demands, rng)
    device.kp, device.ki = (float(each * rng.uniform(0.95, 1.05)) for each in (device.kp, device.ki))
    device.second.lag_s, step_K = float(rng.uniform(0.05, 0.3)), float(rng.choice([0.0, 0.01, 0.06, 0.1]))
    device.loop.step_K = device.second.step_K = step_K
    lie_K, limit_A = float(rng.choice([-3.0, 3.0])), found.demands.current_limit_A
    assert limit_A is not None
    fault_s = PREPARED_S + REST_S + float(rng.uniform(0.0, drive.rows[-1][0]))
    if fault == "swapped before":
        device.swap()
    else:
        device.at(fault_s, lambda: device.break_by(fault, lie_K, float(rng.choice(limit_A))))
    try:
        _, plays, why = played(device, found, [drive], REST_S)
    except Refused as problem:
        why = str(problem)
    device.sleep(15.0)
    assert device.goal_C is None
    assert device.current_A == 0.0
    late_s, told = device.off_at_s - fault_s, f"{number} {fault} ({drive.name}, {fault_s - PREPARED_S - REST_S:.2f} s)"
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
        from_C = np.interp(fault_s + 0.5, times_s, other)
        away = (np.abs(other - from_C) > MOVED_K) & (times_s > fault_s + 0.5)
        moved_s = times_s[away][0] if away.any() else np.inf
        assert not why or device.off_at_s <= moved_s + FROZEN_S, f"{told}: {device.off_at_s - moved_s}"
        late_s = device.off_at_s - moved_s
    elif fault in WITHIN_S:
        assert why or fault_s + WITHIN_S[fault] > device.off_at_s, told
        assert late_s <= WITHIN_S[fault] + 1e-6, f"{told}: off after {late_s:.2f} s, {why}"
    return fault, why, late_s


def test_each_fault_stops(ready: Callable[[str, float], ReadySet]) -> None:
    for number in range(len(FAULTS)):
        play(number, ready)


@pytest.mark.slow
def test_faults_at_any_instant(ready: Callable[[str, float], ReadySet]) -> None:
    late: dict[str, list[float]] = {}
    stopped: dict[str, int] = {}
    for number in range(len(FAULTS), len(FAULTS) + EVIDENCE):
        fault, why, late_s = play(number, ready)
        late.setdefault(fault, []).append(late_s)
        stopped[fault] = stopped.get(fault, 0) + bool(why)
    for fault, times_s in late.items():
        print(f"{fault}: {stopped[fault]} of {len(times_s)} stopped, off after {max(times_s):.2f} s at most")
    assert sum(stopped.values()) > 0.7 * EVIDENCE


def test_polarity_in_all_corners(ready: Callable[[str, float], ReadySet]) -> None:
    """From no power, and from a baseline that was held until just before; a few corners unless all are asked for."""
    every = os.environ.get("THERMICON_EVIDENCE")
    found = ready("readme", 100.0)
    count, number = len(worlds_of(json.loads(found.rig.document))), 0
    for world in range(0, count, 1 if every else 16):
        for is_swapped in (False, True):
            device = Thermostat(found.rig, found.demands, np.random.default_rng(world), world)
            number += 1
            if number % 4 > 1:
                device.send(32.0)
                for _ in range(300):
                    device.sleep(0.2)
                    device.feed()
                device.off()
            if is_swapped:
                device.swap()
            player = LivePlayer(
                device, live_numbers(found.demands, True), PlayLog(None, {}), device.clock, device.sleep
            )
            assert bool(player.check(32.0)) == is_swapped, f"corner {world}: {player.proofs}"
            assert device.goal_C is None

"""Fits of realistic logs."""

import math
import os
from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, fit, simulate_current
from thermicon.circuit.fitting.identify import half_width
from thermicon.circuit.fitting.keys import COMMON, CONTACT, free_keys, value_of
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.fitting.problem import LAYER_KINDS, FitProblem, layer_priors
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.fitting.solve import covariance_of
from thermicon.circuit.fitting.synthetic_log import calibration_icon, synthetic_log
from thermicon.circuit.solver.batch_inputs import bank_of, run_regulate
from thermicon.circuit.solver.inverse import target_at
from thermicon.circuit.solver.steady import steady_state

LOGS = int(os.environ.get("THERMICON_FIT_LOGS", "18"))
KINDS, RATES_HZ = ("held set-points", "ramps", "currents"), (100, 50, 20, 10, 5, 2)
LOOP_HZ, FINE_HZ, END_S, NOISE = 80.0, 400.0, 60.0, {"C": 0.02, "V": 0.005, "A": 0.0}
SPREADS = dict(zip(COMMON, (0.15, 0.025, 0.05), strict=True))
"""SD of the logarithm: half of what the rig's own uncertainty states; 0.1 of other scales, 1 K of a temperature."""
FREE = (*COMMON, "module.thermal_resistance_K_per_W", "module.cold_plate_J_per_K", "module.hot_plate_J_per_K",
        "heat_sink.temperature_C", "heat_sink.resistance_K_per_W")  # fmt: skip


def person(rig: Rig, random: np.random.Generator, keys: Sequence[str] = COMMON) -> tuple[Rig, dict[str, float]]:
    """A rig with the skin, contact and module of one laboratory, and its truth."""
    skin, truth = {}, {}
    for (kind, k), sd in layer_priors(rig).items():
        layer, place = rig.skin.layers[k], LAYER_KINDS.index(kind)
        key = ("thickness_mm", "conductivity_W_per_mK", "heat_capacity_J_per_kgK")[place]
        value = (layer.thickness_m * 1e3, layer.conductivity_W_per_mK, layer.heat_capacity_J_per_kgK)[place]
        skin[f"skin.layer.{k}.{key}"] = value * math.exp(sd * random.normal())
    for key, value in ((each, value_of(rig, each.key)) for each in free_keys(keys, rig)):
        away = SPREADS.get(key.key, 0.1 if key.log else 1.0) * random.normal()
        truth[key.key] = value * math.exp(away) if key.log else value + away
    return rig.with_(**skin, **truth), truth


def played(rig: Rig, kind: str, random: np.random.Generator) -> Drive:
    """The current of a loop at 80 Hz that follows the calibration drive, or of levels at random times."""
    time, (rest, state) = np.arange(round(END_S * LOOP_HZ)) / LOOP_HZ, steady_state(rig, "display", 32.0)
    if kind == "currents":
        begin = np.cumsum(random.uniform(2.0, 6.0, 12)) + 2.0
        current = np.r_[rest, rest, random.uniform(-0.4, 0.6, 10), rest][np.searchsorted(begin, time)]
    else:
        stairs = random.choice([10.0, 20.0])
        asked = np.floor(time * stairs + 1e-9) / stairs if kind == "held set-points" else time
        gain = math.exp(random.uniform(math.log(0.3), 0.0))
        gains = np.array([[0.0, gain, gain * random.uniform(0.5, 2.0), 0.0, 0.0]])
        bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
        target = target_at(calibration_icon(), 32.0, asked)[np.newaxis]
        current = run_regulate(bank, lane, lane, 1 / LOOP_HZ, target, gains, np.array([rest]), bank.states([state]))[0][
            0
        ]
    return Drive(np.append(time, END_S), np.append(current, current[-1]), held=True)


def logged(
    rig: Rig, seed: int, kind: str, means: bool, rate_Hz: int, slow_Hz: int, skin: bool
) -> tuple[Log, dict[str, float]]:
    """A log and its truth; `slow_Hz` is the rate of the sensors beside the current."""
    random = np.random.default_rng(seed)
    true, truth = person(rig, random)
    trace = simulate_current(played(true, kind, random), true, rate_Hz=FINE_HZ)
    many = round(FINE_HZ / rate_Hz)
    rows = np.arange(int(random.integers(many)) + many, len(trace.time_s) - 1, many)
    columns = {}
    for name in ("current_A", "display_C", "voltage_V", *(["skin_C"] if skin else [])):
        exact = getattr(trace, name)
        total = np.append(0.0, np.cumsum(exact))
        values = (total[rows + 1] - total[rows + 1 - many]) / many if means else exact[rows]
        values = values + NOISE[name[-1]] * random.normal(size=len(rows)) + 0.1 * random.normal() * (name[-1] == "C")
        between = np.arange(len(rows)) % round(rate_Hz / slow_Hz) > 0
        columns[name] = values if name == "current_A" else np.where(between, np.nan, values)
    return Log.of("log.csv", {"time_s": trace.time_s[rows], **columns}), truth


def bound(log: Log, rig: Rig, truth: dict[str, float]) -> float:
    """Half width of contact that the log allows at best, at the truth and with the noise that is true."""
    start = rig.with_(**truth)
    problem = FitProblem.of(start, free_keys(COMMON, start), runs_of([log], start))
    sigma = [NOISE[channel.column[-1]] for _, _, channel in problem.channels()]
    deviations = covariance_of(problem, problem.jacobian(problem.first, sigma), [1.0] * len(sigma))
    return half_width(True, math.sqrt(deviations[0, 0]))


@pytest.mark.slow
def test_the_truth_lies_in_what_is_printed_and_written_for_logs_of_every_kind() -> None:
    rig, table = Rig.load("thenar"), defaultdict[str, list[tuple[float, ...]]](list)
    cases = [(kind, means, rate) for kind in KINDS for means in (False, True) for rate in RATES_HZ]
    order = np.random.default_rng(7).permutation(len(cases))
    for seed in range(LOGS):
        kind, means, rate = cases[order[seed % len(cases)]]
        slow, skin = seed // len(cases) % 4 == 1 and rate <= 10, (seed + seed // len(cases)) % 3 == 0
        log, truth = logged(rig, seed, kind, means, 100 if slow else rate, rate, skin)
        found, best = fit(log, rig, free=COMMON), bound(log, rig, truth)
        contact, after = found[CONTACT], found.rig.uncertainty
        printed = [item.low <= truth[item.key] <= item.high for item in found.parameters if item.identified]
        values = (found.rig.contact.resistance_m2K_per_W, found.rig.module.seebeck_V_per_K)
        stated = zip(COMMON, values, (after.contact_resistance_relative, after.seebeck_relative), strict=False)
        written = [abs(truth[key] / value - 1) <= share for key, value, share in stated]
        points = any("is not in the log" in note for note in found.notes)
        narrowed = points and after.contact_resistance_relative < rig.uncertainty.contact_resistance_relative
        row = (contact.identified, contact.low <= truth[CONTACT] <= contact.high, np.mean(printed), np.mean(written),
               contact.half_width / best, not contact.identified and best <= 0.4, narrowed)  # fmt: skip
        name = f"{kind}, {'means' if means else 'samples'}"
        for key in ("all", name, f"{rate} Hz", "slow sensors" if slow else "", "skin" if skin else "no skin"):
            table[key].append(row)
    for key, rows in table.items():
        print(key, len(rows), np.round(np.mean(rows, axis=0), 3), np.round(np.median([row[4] for row in rows]), 2))
    every = np.array(table["all"], dtype=float)
    assert np.mean(every[:, 2]) >= 0.92 and np.mean(every[:, 3]) >= 0.95, table["all"]
    assert not every[:, 5:].any() and np.median(every[:, 4]) <= 2.0, table["all"]


@pytest.mark.slow
def test_intervals_of_many_keys_hold_the_truth_on_ten_rigs_of_other_skin() -> None:
    rig, random = Rig.load("thenar").with_(**{"driver.update_Hz": 10.0}), np.random.default_rng(41)
    held, written = [], []
    for seed in range(10):
        true, truth = person(rig, random, FREE)
        other_mesh = true.with_(**{"skin.elements": [60] * len(rig.skin.layers)})
        found = fit(synthetic_log(other_mesh, seed=100 + seed, rate_Hz=10.0), rig, free=FREE)
        held.append([item.low <= truth[item.key] <= item.high for item in found.parameters])
        for key in (each for each in free_keys(FREE, rig) if each.uncertainty):
            value, width = value_of(found.rig, key.key), getattr(found.rig.uncertainty, key.uncertainty)
            written.append(abs(truth[key.key] - value) <= width * (value if key.log else 1.0))
    assert np.mean(held) >= 0.9 and np.mean(held, axis=0)[0] >= 0.9 and np.mean(written) >= 0.95, held

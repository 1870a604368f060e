"""The gate against brute force: 2,000 random drives on random rigs, every scenario run again by itself.

Nothing here is the gate's: extremes, rates and doses are taken anew from single runs, the limits are written out as
published, and 200 drives are run by ngspice. Slow: `pytest -m slow tests/circuit/test_gate_evidence.py`.
"""

from __future__ import annotations

import math
import subprocess
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Corner, Drive, Rig, RigError, design, gate, play_out, simulate_current, steady_state
from thermicon.circuit.delivery.netlist import netlist
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.safety.scenarios import _everything
from thermicon.circuit.safety.tally import WATCHED
from thermicon.circuit.solver.batch_inputs import Bank, Intervals, cut, run_forward
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.poweroff import unpowered
from thermicon.icons import parse

PARTS, PER_PART = 8, 250
NGSPICE_PER_PART = 25
WITHIN_K = 2e-3
CLOSE = 2e-3
"""Nearer to a limit than this, in K, K/s or a share, either verdict is right."""

ENDING_ROWS = np.arange(6001) / 100

HARD = {"skin_C": (15.0, 42.0), "cold_receptor_C": (15.0, 42.0), "display_C": (5.0, 45.0), "hot_plate_C": (None, 60.0)}
SOFT = {"skin_C": (22.0, 40.0), "display_C": (10.0, 43.0)}


def run_ngspice(text: str, ngspice: str, folder: Path, out: str) -> Array:
    (folder / "rig.cir").write_text(text, encoding="ascii")
    run = subprocess.run([ngspice, "-b", "rig.cir"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    return np.loadtxt(folder / out, skiprows=1)


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(f"{rng.uniform(low, high):.4g}")


def some_rig(rng: np.random.Generator) -> Rig:
    base = Rig.load(str(rng.choice(["thenar", "shani2021", "fingertip", "forearm", "hand-dorsum"])))
    changes: dict[str, object] = {
        "heat_sink.temperature_C": between(rng, 25, 42),
        "heat_sink.resistance_K_per_W": between(rng, 0.1, 0.6),
        "module.cold_plate_J_per_K": between(rng, 1.5, 6),
        "module.seebeck_V_per_K": between(rng, 0.03, 0.06),
        "contact.area_cm2": between(rng, 4, 16),
        "contact.resistance_m2K_per_W": between(rng, 3e-4, 2e-3),
        "driver.current_limit_A": between(rng, 1, 2),
    }
    if rng.random() < 0.5:
        changes["uncertainty.contact_resistance_relative"] = between(rng, 0, 0.5)
        changes["uncertainty.ambient_K"] = between(rng, 0, 5)
        changes["uncertainty.gain_relative"] = between(rng, 0, 0.2)
        changes["uncertainty.reason"] = "a rig made up by chance for a test"
    if rng.random() < 0.2:
        own = {"capacity_J_per_K": between(rng, 30, 200), "kp_W_per_K": 8.0, "ki_W_per_Ks": 1.0, "power_limit_W": 40.0}
        changes.update({f"heat_sink.{key}": value for key, value in own.items()})
    return base.with_(**changes)


def some_drive(rng: np.random.Generator, rig: Rig) -> tuple[Drive, float]:
    """A designed cue that ends with its rest, or currents out of the blue, which may not; and its rest."""
    if rng.random() < 0.6:
        way, control = rng.choice(["cool", "warm"]), rng.choice(["skin", "display"])
        text = (
            f"cue 1\nset s {{ control {control} }}\nicon a {{ {way} by {rng.uniform(0.5, 13):.2f} °C at "
            f"{rng.uniform(0.5, 4):.2f} °C/s; hold for {rng.uniform(0.2, 6):.2f} s; "
            f"return at {rng.uniform(0.5, 4):.2f} °C/s }}"
        )
        icon = parse(text)["a"]
        plan = design(icon, rig, float(icon.lower(rig.skin.rest_C).duration_s))
        return Drive(plan.drive.time_s, [*plan.drive.current_A[:-1], plan.rest_A], held=True), plan.rest_A
    rest = between(rng, 0.0, 0.2)
    times = [0.0, *np.cumsum(rng.uniform(0.1, 3, rng.integers(2, 6)).round(2)).tolist()]
    wide = float(rng.choice([0.15, 0.5, 1.2]))
    currents = (rest + rng.uniform(-wide, wide, len(times))).round(3)
    if rng.random() < 0.6:
        currents[-1] = rest
    return Drive(times, currents, held=bool(rng.random() < 0.5)), rest


def cases(part: int, count: int) -> Iterator[tuple[Drive, Rig, float]]:
    rng = np.random.default_rng([7, part])
    found = 0
    while found < count:
        rig = some_rig(rng)
        try:
            drive, rest = some_drive(rng, rig)
            gate(drive, rig, rest_A=rest)
        except RigError:  # a baseline that this rig cannot hold
            continue
        found += 1
        yield drive, rig, rest


def extended(drive: Drive, corner: Corner, last_A: float) -> Drive:
    """The drive in a corner with 60 s of another current behind it; a jump is 1 µs wide."""
    gain, end = 1.0 + corner.gain_relative, float(drive.time_s[-1])
    if drive.held:
        return Drive([*drive.time_s, end + 60], gain * np.array([*drive.current_A[:-1], last_A, last_A]), held=True)
    return Drive([*drive.time_s, end + 1e-6, end + 60], gain * np.array([*drive.current_A, last_A, last_A]))


def runs(drive: Drive, rig: Rig, rest_A: float) -> Iterator[tuple[Array, dict[str, Array]]]:
    """Every scenario, one at a time through the single-lane kernel."""
    for corner in play_out(drive, rig, rest_A=rest_A, ending_s=0.01).corners:
        start = steady_state(network_of(corner.rig), rest_A * (1.0 + corner.gain_relative))
        for last in (float(drive.current_A[-1]), 0.0):
            try:
                trace = simulate_current(extended(drive, corner, last), corner.rig, start_C=start)
            except RigError:  # hotter than 1000 °C
                yield np.array([0.0, 1.0]), {name: np.full(2, 1000.0) for name in WATCHED}
                continue
            yield trace.time_s, {name: getattr(trace, name) for name in WATCHED}
        if rig.heat_sink.controller is not None:
            yield dark(drive, corner, start)


def dark(drive: Drive, corner: Corner, start: Array) -> tuple[Array, dict[str, Array]]:
    """Without power, on a heat sink of its own: from the end of the cue on with what is left of the sink."""
    own = Drive(drive.time_s, drive.current_A * (1.0 + corner.gain_relative), drive.held)
    trace, one, rows = simulate_current(own, corner.rig, start_C=start), np.zeros(1, dtype=np.int64), ENDING_ROWS
    until = cut(own.time_s[[0, -1]], own.time_s, own.current_A[np.newaxis], own.held)
    bank = Bank.of([network_of(corner.rig)])
    state = run_forward(bank, one, one, until, bank.states([start]), WATCHED[:1], _everything(len(start)))[1:, 0, -1]
    still, count = np.zeros((len(rows) - 1, 1)), np.arange(len(rows))
    bank = Bank.of([unpowered(corner.rig, trace.time_s, trace.hot_plate_C)])
    after = run_forward(bank, one, one, Intervals(rows, count, still, still), bank.states([state]), WATCHED)
    columns = {name: np.concatenate([getattr(trace, name), after[k, 0, 1:]]) for k, name in enumerate(WATCHED)}
    return np.concatenate([trace.time_s, trace.time_s[-1] + rows[1:]]), columns


def seen(time: Array, columns: dict[str, Array]) -> tuple[float, float]:
    """How far beyond the nearest hard and soft limits one run goes; negative where it stays inside."""
    hard: list[float] = []
    soft: list[float] = []
    for limits, far in ((HARD, hard), (SOFT, soft)):
        for name, (low, high) in limits.items():
            if high is not None:
                far.append(columns[name].max() - high)
            if low is not None:
                far.append(low - columns[name].min())
    skin, steps = columns["skin_C"], np.diff(time)
    soft.append(np.abs(skin - skin[0]).max() - 8.0)
    whole = steps > 1e-4
    hard.append(np.abs(np.diff(skin)[whole] / steps[whole]).max() - 10.0)
    middle = 0.5 * (skin[1:] + skin[:-1])
    rate = np.where(middle < 37, 0.0, np.where(middle < 43, 0.25, 0.5) ** (43 - middle))
    hard.append(math.log(max(float(rate @ steps) / 60 / 1.0, 1e-30)))
    burn = np.exp(math.log(3.1) + 98 * math.log(10) - 6.28e5 / 8.31446 / (middle + 273.15))
    hard.append(math.log(max(float(burn @ steps) / 0.01, 1e-30)))
    shown = 0.5 * (columns["display_C"][1:] + columns["display_C"][:-1])
    hard += [float(steps[shown > 43].sum()) / 600 - 1, float(steps[shown > 48].sum()) / 60 - 1]
    return max(hard), max(soft)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_the_verdict_is_that_of_brute_force(part: int) -> None:
    colours: Counter[str] = Counter()
    for drive, rig, rest in cases(part, PER_PART):
        found = gate(drive, rig, rest_A=rest)
        hard, soft = (max(side) for side in zip(*(seen(*run) for run in runs(drive, rig, rest)), strict=True))
        colours[found.colour] += 1
        said = f"{found!r} {drive!r} {found.reason}: hard {hard:.4f}, soft {soft:.4f}"
        if abs(hard) > CLOSE:
            assert (found.colour == "red") == (hard > 0), said
        if hard < -CLOSE and abs(soft) > CLOSE:
            assert (found.colour == "amber") == (soft > 0), said
    print(part, dict(colours))
    assert all(colours[colour] > PER_PART // 20 for colour in ("green", "amber", "red")), colours


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_its_temperatures_are_those_of_ngspice(part: int, tool: Callable[[str], str], tmp_path: Path) -> None:
    far = 0.0
    for number, (drive, rig, rest) in enumerate(cases(part, NGSPICE_PER_PART)):
        futures = play_out(drive, rig, rest_A=rest)
        c, e = number % len(futures.corners), number % 2
        corner = futures.corners[c]
        gain = 1.0 + corner.gain_relative
        whole = extended(drive, corner, (float(drive.current_A[-1]), 0.0)[e])
        text = netlist(corner.rig, whole, rest_A=rest * gain, out_file="out.txt")
        table = run_ngspice(text, tool("ngspice"), tmp_path, "out.txt")
        names = ("hot_plate_C", "display_C", "skin_C", "cold_receptor_C")
        kept = futures.values[:, e, c].max() < 150  # beyond, a share of a rise of hundreds of kelvins is no mK
        for column, name in enumerate(names, start=3):
            ours, theirs = futures.values[WATCHED.index(name), e, c], table[:, column]
            rise = np.maximum(1.0, np.abs(ours - ours[0]) / 50.0)
            worst = float((np.abs(np.interp(futures.time_s, table[:, 0], theirs) - ours) / rise).max())
            far = max(far, worst if kept else 0.0)
            assert worst < WITHIN_K or not kept, (number, name, worst, str(corner), repr(drive))
    print(part, f"{far * 1e3:.2f} mK")

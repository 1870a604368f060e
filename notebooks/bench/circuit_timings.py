"""Timings of the circuit beside ngspice and scipy: one cue, a batch with a rig per lane, inverse, people."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit import Rig, netlist, simulate_current, simulate_many
from thermicon.circuit.cores import at_most, quiet_blas
from thermicon.circuit.solver.batch_inputs import Bank, cut, run_follow, run_forward
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current, steady_state
from thermicon.icons import load_library
from thermicon.perception import draw_people

from .measure import Timing, timed
from .peers import (
    CORNERS,
    END_S,
    RATE_HZ,
    find_ngspice,
    ngspice_command,
    plain,
    run_ngspice,
    scaled_circuits,
    scipy_run,
)
from .result import Curve, Entry, Section
from .roofline import roofline_section

if TYPE_CHECKING:
    from collections.abc import Callable

LANES, PEOPLE = 64, 24
PROBES = ("skin_C", "cold_receptor_C", "warm_receptor_C")
RECEPTORS = PROBES[1:]


def circuit_sections(rig: Rig, short: bool) -> tuple[Section, ...]:
    """One cue, and a batch of 64, beside the peers that are there; `short` runs fewer and smaller peers."""
    most, program = 3 if short else 10, find_ngspice()
    entries = [Entry("thermicon, one call", timed(lambda: simulate_current(CORNERS, rig)))]
    batch = Entry(f"thermicon, batch of {LANES} on one core, per cue", _batch(rig))
    peers = [("solve_ivp of scipy (BDF)", timed(lambda: scipy_run(rig), most=1 if short else 5, budget_s=20.0))]
    if program is not None:
        peers.insert(0, ("ngspice, a process for one cue", _ngspice(program, rig, 1, most)))
        count = 8 if short else LANES
        name = f"ngspice, a cue in a process of {count}"
        peers.append((name, _ngspice(program, rig, count, 1 if short else 3).over(count)))
    ours, lane = entries[0].timing.processor_s, batch.timing.processor_s
    one = [*entries, *(Entry(name, took, took.processor_s / ours, "one call") for name, took in peers)]
    many = [batch, *(Entry(name, took, took.processor_s / lane, "a lane of the batch") for name, took in peers)]
    nodes = network_of(rig).nodes
    about = f"A current with five ramps over {END_S:g} s on rig {rig.name}, {nodes} nodes, {RATE_HZ} rows per second."
    return (
        Section("One cue", about, tuple(one)),
        Section(f"A batch of {LANES}", "The same with another area and another current in every lane.", tuple(many)),
        roofline_section(entries[0].timing, batch.timing, nodes, round(END_S * RATE_HZ)),
        Section("Inverse and people", f"{LANES} lanes, and six-icons on {PEOPLE} people.", tuple(_others(rig))),
    )


def circuit_curves(rig: Rig) -> tuple[Curve, ...]:
    """Time of one cue over the nodes of its skin and over its length."""
    layers = len(rig.skin.layers)
    per_layer = (4, 8, 16, 32)
    meshes = [rig.with_(**{"skin.elements": [count] * layers}) for count in per_layer]
    with quiet_blas():  # idle threads of the linear algebra that finds the start would count as processor time
        by_nodes = [timed(_call(mesh, 1.0), most=5, budget_s=0.5) for mesh in meshes]
    by_length = [timed(_call(rig, times), most=5, budget_s=0.5) for times in (0.5, 1.0, 2.0, 4.0)]
    steps = tuple(round(END_S * times * RATE_HZ) for times in (0.5, 1.0, 2.0, 4.0))
    return (
        Curve("One cue over nodes", "nodes", tuple(network_of(mesh).nodes for mesh in meshes), tuple(by_nodes)),
        Curve("One cue over steps", "steps of 10 ms", steps, tuple(by_length)),
    )


def _call(rig: Rig, longer: float) -> Callable[[], object]:
    from thermicon.circuit import Drive

    drive = Drive(CORNERS.time_s * longer, CORNERS.current_A)
    return lambda: simulate_current(drive, rig)


def _batch(rig: Rig) -> Timing:
    rigs, scale = _varied(rig, LANES)
    bank, lanes = Bank.of([network_of(each) for each in rigs]), np.arange(LANES)
    rows = np.arange(round(END_S * RATE_HZ) + 1) / RATE_HZ
    intervals = cut(rows, CORNERS.time_s, CORNERS.current_A * scale[:, None], held=False)
    first = float(CORNERS.current_A[0])
    start = bank.states([state_under_current(network_of(r), first * by) for r, by in zip(rigs, scale, strict=True)])
    with at_most(1):
        return timed(lambda: run_forward(bank, lanes, lanes, intervals, start.copy(), PROBES)).over(LANES)


def _varied(rig: Rig, count: int) -> tuple[list[Rig], np.ndarray]:
    area_cm2 = rig.contact.area_m2 * 1e4
    rigs = [rig.with_(**{"contact.area_cm2": area_cm2 * (1.0 + k / (8 * LANES))}) for k in range(count)]
    return rigs, 1.0 + np.arange(count) / (10 * LANES)


def _ngspice(program: str, rig: Rig, count: int, most: int) -> Timing:
    texts = [plain(netlist(rig, CORNERS))] if count == 1 else scaled_circuits(*_varied(rig, count))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = ngspice_command(program, folder, texts)
        return timed(lambda: run_ngspice(command, folder), most=most, budget_s=20.0)


def _others(rig: Rig) -> list[Entry]:
    """The inverse of a cue in a batch, and the receptors of people, superposed and solved in full."""
    icons = list(load_library("six-icons"))
    icon, bank, lanes = icons[0], Bank.of([network_of(rig)] * LANES), np.arange(LANES)
    base, zero = rig.skin.rest_C, np.zeros(LANES, dtype=np.int64)
    rows = np.arange(round(END_S * RATE_HZ) + 1) / RATE_HZ
    start = bank.states([steady_state(rig, "display", base)[1]] * LANES)
    corners, plan = icon.corners(base), design(icon, rig, END_S)
    target = np.interp(rows[1:], corners.time_s, corners.value)[None]
    intervals = cut(rows, plan.drive.time_s, plan.drive.current_A[None], held=True)
    rigs = draw_people(PEOPLE, 0).rigs(rig)
    with at_most(1):
        forward = timed(lambda: run_forward(bank, lanes, zero, intervals, start.copy(), PROBES)).over(LANES)
        period = 1.0 / rig.driver.update_Hz
        inverse = timed(lambda: run_follow(bank, lanes, zero, period, target, False, start.copy())).over(LANES)
    played = {
        probes: timed(partial(simulate_many, icons, rigs, nominal=rig, end_s=18.0, probes=probes))
        for probes in (RECEPTORS, PROBES)
    }
    quick, full = (played[probes].over(PEOPLE * len(icons)) for probes in (RECEPTORS, PROBES))
    return [
        Entry("forward, per cue, one core", forward),
        Entry("inverse, per cue, one core", inverse, inverse.processor_s / forward.processor_s, "forward"),
        Entry("receptors of a person, superposed, per icon", quick),
        Entry(
            "receptors of a person, full solution, per icon", full, full.processor_s / quick.processor_s, "superposed"
        ),
    ]

"""A hand that lands: bare skin at rest meets a display in air, which its driver holds, shortly before a cue begins.

Before it lands, the display loses heat to the air alone, and the skin is at rest with its face at `skin.rest_C`. From
then on the driver keeps on holding: the display or skin at the cue's baseline, or the current that holds it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..arrays import Array, Index
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .batch_inputs import Bank, Intervals, State, bank_of, run_on
from .network import COLD, SINK_START_C, SKIN, network_of
from .steady import bare_plates, sink_under, state_under_current


def refuse_landing(rig: Rig, what: str) -> None:
    """Raise RigError where a hand lands on a rig, for what is about a hand that rests."""
    if rig.contact.lands_s is not None:
        raise RigError(
            f"rig {rig.name}: contact.lands_s = {rig.contact.lands_s:g} s: {what}; remove contact.lands_s (a hand that "
            f"rests on the display), or use simulate"
        )


def lead_of(rig: Rig) -> int:
    """Number of the driver's updates between landing and the start of a cue; 0 where the hand rests."""
    return 0 if rig.contact.lands_s is None else round(-rig.contact.lands_s * rig.driver.update_Hz)


def common_lead(rigs: tuple[Rig, ...]) -> int:
    """The lead of rigs of one batch; raises RigError where they differ in it."""
    if len({(rig.contact.lands_s, lead_of(rig)) for rig in rigs}) > 1:
        raise RigError("rigs of one batch must share contact.lands_s")
    return lead_of(rigs[0])


@lru_cache(maxsize=512)
def _resting_lumps(rig: Rig) -> Array:
    """Lumps (n,) in °C of bare skin whose face rests at skin.rest_C."""
    between, perfusion = 1.0 / rig.column.resistance_m2K_per_W[1:], rig.column.perfusion_W_per_m2K
    matrix = np.diag(perfusion + between) - np.diag(between[:-1], 1) - np.diag(between[:-1], -1)
    matrix[np.arange(1, len(between)), np.arange(1, len(between))] += between[:-1]
    source = np.zeros(len(between))
    source[0] = rig.resting_flux_W_per_m2
    lumps = rig.deep_C + np.linalg.solve(matrix, source)
    lumps.setflags(write=False)
    return np.asarray(lumps)


def landing_state(rig: Rig, *, current_A: float | None = None, display_C: float | None = None) -> Array:
    """State (nodes,) in °C at which a hand lands on a display in air, under a current or held; RigError for none."""
    network = network_of(rig)
    film_W_per_K = rig.ambient.film_W_per_m2K * rig.contact.area_m2
    try:
        _, cold, hot = bare_plates(network, film_W_per_K, rig.ambient.temperature_C, current_A, display_C)
    except ArithmeticError as problem:
        raise RigError(f"rig {rig.name}: before the hand lands, {problem}; use less current") from None
    if display_C is not None and abs(cold - display_C) > 1e-6:
        raise RigError(
            f"rig {rig.name}: before the hand lands, the display in air cannot be held at {display_C:.4g} °C, the "
            f"module cools it to {cold:.4g} °C at most; use a warmer baseline"
        )
    state = np.empty(network.nodes)
    state[:SKIN] = hot, cold
    state[SKIN : SKIN + len(network.capacity_J_per_K)] = _resting_lumps(rig)
    state[-1] = network.deep_C
    if network.passive:
        state[-2] = sink_under(network, hot)
    return state


def start_under(rig: Rig, current_A: float) -> Array:
    """State (nodes,) in °C in which a run under a given current begins: at rest, if it exists, or after landing."""
    steady = state_under_current(network_of(rig), current_A)
    return steady if rig.contact.lands_s is None else start_after(rig, np.full(lead_of(rig) + 1, current_A))


def start_after(rig: Rig, lead_A: Array) -> Array:
    """State (nodes,) in °C after currents (lead + 1,): the first until the hand lands, each other for one update."""
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    begun = bank.states([landing_state(rig, current_A=float(lead_A[0]))])
    return np.asarray(led(bank, lane, lane, lead_A[np.newaxis, 1:], rig, begun)[0])


def current_before(rig: Rig, steady_C: Array) -> float:
    """Current in A that holds the display of a steady state in air, before a hand lands."""
    film_W_per_K, air_C = rig.ambient.film_W_per_m2K * rig.contact.area_m2, rig.ambient.temperature_C
    return bare_plates(network_of(rig), film_W_per_K, air_C, None, float(steady_C[COLD]))[0]


def start_holding(rig: Rig, steady_C: Array) -> Array:
    """State (nodes,) in °C from which a cue's baseline is held: the steady one, or a hand that lands on its display."""
    return steady_C if rig.contact.lands_s is None else landing_state(rig, display_C=float(steady_C[COLD]))


def ahead(targets: Array, before: Array, lead: int) -> Array:
    """Targets (cues, periods) with `lead` periods at levels (cues,) before them."""
    return targets if not lead else np.concatenate([np.repeat(before[:, np.newaxis], lead, axis=1), targets], axis=1)


def led(bank: Bank, rig_of: Index, cue_of: Index, currents: Array, rig: Rig, states: Array) -> Array:
    """States (lanes, nodes) at the start of cues, after the currents (cues, lead) in A since landing in `states`."""
    count = currents.shape[1]
    if count:
        edges = np.arange(count + 1) / rig.driver.update_Hz
        held = np.ascontiguousarray(currents.T)
        intervals = Intervals(edges, np.append(np.zeros(1, np.int64), np.full(count, -1)), held, held)
        states = run_on(bank, rig_of, cue_of, intervals, State.settled(states), ("skin_C",))[1].nodes_C
    if bank.passive:
        states = states.copy()
        at = bank.count[rig_of] + SKIN
        start = bank.plates[rig_of, SINK_START_C]
        lanes = np.flatnonzero(~np.isnan(start))
        states[lanes, at[lanes]] = start[lanes]
    return states

"""What this machine allows: the time that the arithmetic of a step takes at least, beside what a step takes.

A cue by itself is two chains of multiply-adds through the nodes of the skin, in which each waits for the one before;
the two halves of the skin are solved side by side. A batch has many lanes to fill the processor's vectors with; there
each node of a lane is read and written in two passes, so that what counts is how fast arrays come from the cache.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel
from thermicon.circuit.solver.kernel_legs import LANES

from .measure import Timing, timed
from .result import Entry, Section

CHAIN, SWEEPS = 200_000, 400
LUMPS = 50
"""About those of the shipped mesh: the arrays are as large as those of a block of lanes."""


def _chain(count: int, factor: float, start: float) -> float:
    value = start
    for _ in range(count):
        value = value * factor + start
    return value


def _arrays(sweeps: int, keep: Any, state: Any, gain: Any, found: Any) -> None:
    for _ in range(sweeps):
        for i in range(keep.shape[0]):
            for lane in range(keep.shape[1]):
                found[i, lane] = keep[i, lane] * state[i, lane] + gain[i, lane]


_compile: Any = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")
chain: Any = _compile(_chain)
arrays: Any = _compile(_arrays)


def chain_timing() -> Timing:
    """Time of one multiply-add that waits for the one before."""
    return timed(lambda: chain(CHAIN, 0.5, 1.0), most=5).over(CHAIN)


def array_timing() -> Timing:
    """Time of one multiply-add over arrays as large as those of a block of lanes."""
    rng = np.random.default_rng(0)
    keep, state, gain = rng.uniform(0.2, 0.4, (3, LUMPS, LANES))
    found = np.empty_like(keep)
    return timed(lambda: arrays(SWEEPS, keep, state, gain, found), most=5).over(SWEEPS * keep.size)


def roofline_section(one: Timing, lane: Timing, nodes: int, steps: int) -> Section:
    """The least time of one cue and of a lane of a batch, of so many nodes and steps, and what they take of it."""
    waits, passes = chain_timing(), array_timing()
    least_one, least_lane = waits.times(nodes * steps), passes.times(2 * nodes * steps)
    about = (
        f"{steps:,} steps of {nodes} nodes. By itself a cue waits for one multiply-add after another, node by node; in "
        "a batch, two multiply-adds a node come from arrays in the cache. Rows, plates and the call itself come on top."
    )
    return Section(
        "What the machine allows",
        about,
        (
            Entry("a multiply-add that waits for the one before", waits),
            Entry("one cue, at least", least_one),
            Entry("one cue, as measured above", one, one.processor_s / least_one.processor_s, "at least"),
            Entry("a multiply-add over arrays", passes),
            Entry("a lane of a batch, at least", least_lane),
            Entry("a lane of a batch, as measured above", lane, lane.processor_s / least_lane.processor_s, "at least"),
        ),
    )

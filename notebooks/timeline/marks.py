"""Marks beside the curves of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit import Rig, Trace
from thermicon.circuit.solver.inverse import LIMITS, baseline_C, steps_at
from thermicon.circuit.solver.trace import CLOSE_K
from thermicon.icons import Icon
from thermicon.perception import Percept
from thermicon.perception.observer.observer import Channel
from thermicon.perception.sensation.features import HELD_SHARE, STILL_K, directions

FELT_DPRIME = 1.0
"""Smallest marked peak of sensation: the detection threshold in a two-interval choice, d′ = 1."""
GAP_S = 0.05
"""Missed stretches that are nearer than this to one another are one."""
Kind = Literal["onset", "felt peak", "physical peak"]


@dataclass(frozen=True, slots=True)
class EventTime:
    """One event: time in s on the named clock, and its channel."""

    kind: Kind
    time_s: float
    channel: Channel
    clock: Literal["response", "percept", "cue"]

    @property
    def label(self) -> str:
        """Label of the mark, as in ``physical peak (cold) 2.04 s``."""
        clock = "" if self.clock == "cue" else f", {self.clock} clock"
        return f"{self.kind} ({self.channel}) {self.time_s:.2f} s{clock}"


@dataclass(frozen=True, slots=True)
class Span:
    """A stretch of time (s) in which the target is missed, and what holds it back."""

    from_s: float
    to_s: float
    label: str


def event_times_of(trace: Trace, percept: Percept) -> tuple[EventTime, ...]:
    """Return onset, felt peaks and skin peaks (held: within 1 %) of channels that reach d′ = 1, earliest first."""
    found: list[EventTime] = []
    if percept.onset_s is not None and percept.channel is not None:
        found.append(EventTime("onset", percept.onset_s, percept.channel, "response"))
    for channel in directions(trace):
        psi = percept.psi_cold if channel == "cold" else percept.psi_warm
        felt = percept.felt_peak_s(channel)
        if felt is None or psi.max() < FELT_DPRIME:
            continue
        if percept.felt:
            found.append(EventTime("felt peak", felt, channel, "percept"))
        away = (trace.skin_C - trace.skin_C[0]) * (-1.0 if channel == "cold" else 1.0)
        if away.max() > STILL_K:
            at = int((away >= HELD_SHARE * away.max()).argmax())
            found.append(EventTime("physical peak", float(trace.time_s[at]), channel, "cue"))
    return tuple(sorted(found, key=lambda moment: moment.time_s))


def missed_spans(icon: Icon, trace: Trace, rig: Rig) -> tuple[Span, ...]:
    """Return when a run misses its target or asks for too much current; of a step, only where it never arrives."""
    if trace.reachable:
        return ()
    met = ["driver's limits"] if trace.outcome is None else [name for name, _ in trace.outcome.limits if name in LIMITS]
    label = f"unreachable: {' and '.join(met)}" if met else "unreachable"
    missed = np.concatenate(([False], _missed(icon, trace, rig), [False])).astype(np.int8)
    found: list[Span] = []
    for begin, end in np.flatnonzero(np.diff(missed)).reshape(-1, 2).tolist():
        from_s, to_s = float(trace.time_s[max(begin - 1, 0)]), float(trace.time_s[min(end, len(trace.time_s) - 1)])
        if found and from_s - found[-1].to_s < GAP_S:
            from_s = found.pop().from_s
        found.append(Span(from_s, to_s, label))
    return tuple(found)


def _missed(icon: Icon, trace: Trace, rig: Rig) -> NDArray[np.bool_]:
    if trace.outcome is None:
        low, high = trace.driver_limits_A
        wide = (trace.current_A > high + 1e-9) | (trace.current_A < low - 1e-9)
        return np.asarray(wide | (np.abs(trace.voltage_V) > rig.driver.voltage_limit_V + 1e-6))
    reached = trace.skin_C if trace.control == "skin" else trace.display_C
    close = np.abs(reached - trace.target_C) <= CLOSE_K
    missed = ~close
    for begin, until in steps_at(icon, baseline_C(icon, rig)):
        window = np.flatnonzero((trace.time_s >= begin - 1e-9) & (trace.time_s <= until + 1e-9))
        arrived = window[close[window] & (trace.time_s[window] > begin + 1e-6)]
        if len(arrived):
            missed[window[window < arrived[0]]] = False
    return np.asarray(missed)

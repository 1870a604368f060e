"""Why a pair is told apart or not: sentences whose every number can be computed again.

The numbers come from the two nominal traces and percepts through the public functions of
`features`, `distance` and `rules`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.perception.distance import difference_trace
from thermicon.perception.features import direction_words, directions, excursion_K, excursion_rate_K_per_s
from thermicon.perception.observer import CHANNELS, Channel, Observer
from thermicon.perception.percept import Percept
from thermicon.perception.rules import load_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace

VERBS = {"cold": "cool", "warm": "warm"}


@dataclass(frozen=True, slots=True)
class Reason:
    """A sentence, the numbers in it by name, and the unit they share."""

    text: str
    values: dict[str, float]
    unit: str

    def __repr__(self) -> str:
        return f"Reason({self.text})"


def pair_reasons(
    a: Trace, b: Trace, felt_a: Percept, felt_b: Percept, observer: Observer | None = None
) -> tuple[Reason, ...]:
    """What separates the two icons, or fails to: direction, peaks, rates, onsets, and the largest difference."""
    shared = tuple(c for c in directions(a) if c in directions(b))
    found = [_direction(a, b)]
    for channel in shared:
        found.append(_peaks(a, b, channel))
        found.append(_rates(a, b, channel))
    found.append(_onsets(a, b, felt_a, felt_b))
    found.append(_largest(a, b, felt_a, felt_b, observer))
    return tuple(found)


def largest_difference(a: Percept, b: Percept, observer: Observer | None = None) -> tuple[float, float, Channel]:
    """Largest smoothed difference (d′ before memory noise), its time (s) and the channel that carries most of it."""
    trace = difference_trace(a, b, observer)
    size = np.hypot(trace[0], trace[1])
    k = int(size.argmax())
    return float(size[k]), k * a.dt_s, CHANNELS[int(np.abs(trace[:, k]).argmax())]


def _direction(a: Trace, b: Trace) -> Reason:
    values: dict[str, float] = {}
    parts = []
    for key, trace in (("a", a), ("b", b)):
        moved = directions(trace)
        for channel in moved:
            values[f"{key}_{channel}_K"] = excursion_K(trace, channel)
        sizes = " and ".join(f"{excursion_K(trace, c):+.2f} K at the {c} receptor" for c in moved)
        parts.append(f"{_name(trace)} {direction_words(trace)}" + (f" ({sizes})" if sizes else ""))
    head = "same direction" if directions(a) == directions(b) else "directions differ"
    return Reason(f"{head}: {parts[0]}; {parts[1]}", values, "K")


def _peaks(a: Trace, b: Trace, channel: Channel) -> Reason:
    peak_a, peak_b = excursion_K(a, channel), excursion_K(b, channel)
    needed = load_rules().one("peak", channel=channel).central
    gap = abs(peak_a - peak_b)
    verdict = "more than" if gap >= needed else "within"
    text = (
        f"both {VERBS[channel]}: peaks {peak_a:+.2f} and {peak_b:+.2f} K at the {channel} receptor differ by "
        f"{gap:.2f} K, {verdict} the just noticeable {needed:.2f} K"
    )
    return Reason(text, {"a": peak_a, "b": peak_b, "difference": gap, "threshold": needed}, "K")


def _rates(a: Trace, b: Trace, channel: Channel) -> Reason:
    rate_a, rate_b = excursion_rate_K_per_s(a, channel), excursion_rate_K_per_s(b, channel)
    needed = load_rules().one("rate ratio").central
    low, high = sorted((abs(rate_a), abs(rate_b)))
    text = f"rates {rate_a:+.2f} and {rate_b:+.2f} K/s at the {channel} receptor"
    values = {"a": rate_a, "b": rate_b, "threshold": needed}
    if low > 0.0:
        verdict = "more than" if high / low >= needed else "within"
        text += f" differ by a factor {high / low:.2f}, {verdict} the just noticeable {needed:.2f}"
        values["ratio"] = high / low
    return Reason(text, values, "K/s")


def _onsets(a: Trace, b: Trace, felt_a: Percept, felt_b: Percept) -> Reason:
    if felt_a.onset_s is None or felt_b.onset_s is None:
        unfelt = [_name(t) for t, p in ((a, felt_a), (b, felt_b)) if p.onset_s is None]
        return Reason(f"not felt: {' and '.join(unfelt)}", {}, "s")
    channel: Channel = "warm" if felt_a.channel == felt_b.channel == "warm" else "cold"
    needed = load_rules().one("onset", channel=channel).central
    gap = abs(felt_a.onset_s - felt_b.onset_s)
    verdict = "more than" if gap >= needed else "within"
    text = (
        f"felt at {felt_a.onset_s:.2f} s ({felt_a.channel}) and {felt_b.onset_s:.2f} s ({felt_b.channel}): "
        f"{gap:.2f} s apart, {verdict} the {needed:.2f} s of the response window"
    )
    return Reason(text, {"a": felt_a.onset_s, "b": felt_b.onset_s, "difference": gap, "threshold": needed}, "s")


def _largest(a: Trace, b: Trace, felt_a: Percept, felt_b: Percept, observer: Observer | None) -> Reason:
    size, time, channel = largest_difference(felt_a, felt_b, observer)
    text = (
        f"{_name(a)} and {_name(b)} differ most at {time:.2f} s, in the {channel} channel: "
        f"{size:.1f} d′ of sensation before memory noise"
    )
    return Reason(text, {"difference": size, "time_s": time}, "d′")


def _name(trace: Trace) -> str:
    return trace.icon or "the cue"

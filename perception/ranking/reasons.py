"""Why a pair is distinguishable or not: sentences whose every number can be recomputed.

The numbers come from the two nominal traces and percepts through the public functions of
`features`, `distance_components` and `rules`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons.number_text import decimals, fixed, verdict

from ..arrays import Array
from ..identification.episodes import Episodes, remembered
from ..observer.channels import CHANNELS, USUAL_NORM, Channel, Norm, check_norm
from ..observer.observer import Observer
from ..sensation.features import (
    STILL_K,
    direction_words,
    directions,
    excursion_K,
    excursion_rate_K_per_s,
    receptor_C,
)
from ..sensation.percept import Percept
from .remembered_reasons import carrying_feature
from .rules import load_rules

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
    a: Trace,
    b: Trace,
    felt_a: Percept,
    felt_b: Percept,
    observer: Observer | None = None,
    norm: Norm = USUAL_NORM,
    episodes: Episodes | None = None,
    places: tuple[int, int] = (0, 1),
) -> tuple[Reason, ...]:
    """What separates the two icons, or fails to: what carries the distance, then direction, peaks, rates, onsets.

    Of two icons that move the receptors alike there is one sentence, which says so. `norm` is the norm
    with which the two are distinguished from memory; `episodes` are those of the nominal person, with the two icons at
    `places`, where they are known.
    """
    if _alike(a, b):
        text = (
            f"nothing differs: {_name(a)} and {_name(b)} move the receptors in the same way, so their names are guessed"
        )
        return (Reason(text, {}, "K"),)
    shared = tuple(c for c in directions(a) if c in directions(b))
    person, chosen = Observer.load() if observer is None else observer, check_norm(norm)
    if episodes is None:
        episodes, places = remembered((felt_a, felt_b), person), (0, 1)
    carries = Reason(*carrying_feature((_name(a), _name(b)), episodes, places, person, chosen), "d′")
    found = [carries, _direction(a, b)]
    for channel in shared:
        found.append(_peaks(a, b, channel))
        found.append(_rates(a, b, channel))
    found.append(_onsets(a, b, felt_a, felt_b))
    return tuple(found)


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
    digits = decimals(gap, needed)
    text = (
        f"both {VERBS[channel]}: peaks {peak_a:+.{digits}f} and {peak_b:+.{digits}f} K at the {channel} receptor "
        f"differ by {gap:.{digits}f} K, {verdict(gap, needed)} the just noticeable {fixed(needed, digits)} K"
    )
    return Reason(text, {"a": peak_a, "b": peak_b, "difference": gap, "threshold": needed}, "K")


def _rates(a: Trace, b: Trace, channel: Channel) -> Reason:
    rate_a, rate_b = excursion_rate_K_per_s(a, channel), excursion_rate_K_per_s(b, channel)
    needed = load_rules().one("rate ratio").central
    low, high = sorted((abs(rate_a), abs(rate_b)))
    values = {"a": rate_a, "b": rate_b, "threshold": needed}
    if low == 0.0:
        return Reason(f"rates {rate_a:+.2f} and {rate_b:+.2f} K/s at the {channel} receptor", values, "K/s")
    ratio = values["ratio"] = high / low
    digits = decimals(ratio, needed)
    text = (
        f"rates {rate_a:+.{digits}f} and {rate_b:+.{digits}f} K/s at the {channel} receptor differ by a factor "
        f"{ratio:.{digits}f}, {verdict(ratio, needed)} the just noticeable {fixed(needed, digits)}"
    )
    return Reason(text, values, "K/s")


def _onsets(a: Trace, b: Trace, felt_a: Percept, felt_b: Percept) -> Reason:
    if felt_a.onset_s is None or felt_b.onset_s is None:
        unfelt = [_name(t) for t, p in ((a, felt_a), (b, felt_b)) if p.onset_s is None]
        return Reason(f"not felt by the nominal person: {' and '.join(unfelt)}", {}, "s")
    channel: Channel = "warm" if felt_a.channel == felt_b.channel == "warm" else "cold"
    needed = load_rules().one("onset", channel=channel).central
    gap = abs(felt_a.onset_s - felt_b.onset_s)
    digits = decimals(gap, needed)
    text = (
        f"nominal person: felt at {felt_a.onset_s:.{digits}f} s ({felt_a.channel}) and {felt_b.onset_s:.{digits}f} s "
        f"({felt_b.channel}): {gap:.{digits}f} s apart, {verdict(gap, needed)} the {fixed(needed, digits)} s "
        f"of the response window"
    )
    return Reason(text, {"a": felt_a.onset_s, "b": felt_b.onset_s, "difference": gap, "threshold": needed}, "s")


def _alike(a: Trace, b: Trace) -> bool:
    """Whether both receptors go through the same temperatures at the same times, the shorter trace held at its end."""
    return all(
        _span_K(receptor_C(a, channel), receptor_C(b, channel)) < STILL_K and a.time_s[1] == b.time_s[1]
        for channel in CHANNELS
    )


def _span_K(one: Array, two: Array) -> float:
    if one.size != two.size:
        n = max(one.size, two.size)
        one, two = (np.pad(values, (0, n - values.size), mode="edge") for values in (one, two))
    return float(np.abs(one - two).max())


def _name(trace: Trace) -> str:
    return trace.icon or "the cue"

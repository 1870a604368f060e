"""Why a pair is distinguishable or not: sentences whose every number can be recomputed.

The numbers come from the two nominal traces and percepts through the public functions of
`features`, `episodes` and `rules`.

Components of the distance of two icons as they are remembered are direction, intensity, rate, duration and pause. Each
is the part of d′ from memory that it carries, so that their squares add up to d′² of the pair.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import held
from thermicon.base.words.number_text import decimals, fixed, signed, verdict

from ..identification.episodes import PARTS, Episode, Episodes, distance_shares
from ..observer.channels import CHANNELS, Channel, MemoryForm
from ..observer.observer import Observer
from ..sensation import features
from ..sensation.percept import Percept
from .rules_of_thumb import load_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace

NOTICEABLE = 1.0
"""One SD of what is remembered."""


@dataclass(frozen=True, slots=True)
class DistanceComponent:
    """One component of the distance of two icons, and the part of the d′ of the pair that it carries, its `value`.

    `name` is `direction` (what only one icon has), `intensity`, `rate`, `duration` or `pause`. `a` and `b` are values
    of the two episodes at one place that differ most in it: multiples of threshold (intensity), those per second (rate)
    or s (duration, pause); None for an icon that is not felt, and for `direction`.
    """

    name: str
    value: float
    a: float | None = None
    b: float | None = None

    @property
    def above(self) -> bool:
        """Whether it carries at least one SD of memory noise."""
        return self.value >= NOTICEABLE

    def to_dict(self) -> dict[str, str | float | bool | None]:
        """The keys of the ranking file."""
        return {
            "part": self.name,
            "value": self.value,
            "unit": "d′",
            "noticeable": NOTICEABLE,
            "above": self.above,
            "a": self.a,
            "b": self.b,
        }


def components_of(episodes: Episodes, i: int, j: int, observer: Observer) -> tuple[DistanceComponent, ...]:
    """The components of two of the first person's icons, in the order of `PARTS`; their squares sum to d′²."""
    shares = distance_shares(episodes, i, episodes, j, observer, "episodes")
    one, other = (episodes.listed(0, place) for place in (i, j))
    return tuple(
        DistanceComponent(name, math.sqrt(max(shares[name], 0.0)), *most_different(one, other, name)) for name in PARTS
    )


FIELDS = {"intensity": "peak", "rate": "rate_per_s", "duration": "length_s", "pause": "pause_s"}
"""Attribute of an episode behind each component; `direction` has none."""
NEAR_NOTHING = 0.1
"""Added to both values before their ratio is taken, so that a pause of 0 does not count as infinitely short."""


def most_different(one: Sequence[Episode], other: Sequence[Episode], name: str) -> tuple[float | None, float | None]:
    """A component's values of the two episodes at one place that differ most in it, or of the strongest."""
    if name not in FIELDS:
        return None, None
    pairs = [(x, y) for x, y in zip(one, other, strict=False) if x.channel == y.channel]
    if not pairs:
        tops = (max(felt, key=lambda episode: episode.peak, default=None) for felt in (one, other))
        first, second = (None if top is None else float(getattr(top, FIELDS[name])) for top in tops)
        return first, second
    values = [(float(getattr(x, FIELDS[name])), float(getattr(y, FIELDS[name]))) for x, y in pairs]
    return max(values, key=lambda pair: abs(math.log((pair[0] + NEAR_NOTHING) / (pair[1] + NEAR_NOTHING))))


VERBS = {"cold": "cool", "warm": "warm"}
ALIKE_DPRIME = 0.3
"""Below this no feature is named: two icons are then distinguished in less than 56 % of trials."""
FEATURES = {
    "intensity": ("how strong they are", "times threshold"),
    "rate": ("how fast they start", "times threshold per second"),
    "duration": ("how long they last", "s at half the peak"),
    "pause": ("the pause before an episode", "s"),
}
"""Part of a distance: the feature in words, and its unit in words."""


def pair_reasons(
    a: Trace,
    b: Trace,
    felt: tuple[Percept, Percept],
    observer: Observer,
    memory: MemoryForm,
    episodes: Episodes,
    places: tuple[int, int],
) -> tuple[str, ...]:
    """Reasons for the distance of two icons: what carries it, then direction, peaks, rates, onsets.

    Of two icons that move the receptors alike there is one sentence, which says so. `memory` is the form with which the
    two are distinguished from memory; `episodes` are those of the nominal person, with the two icons at `places`.
    """
    if _alike(a, b):
        both = f"{_name(a)} and {_name(b)}"
        return (f"nothing differs: {both} move the receptors in the same way, so their names are guessed",)
    moved, moved_b = features.directions(a), features.directions(b)
    found = [_carries((_name(a), _name(b)), episodes, places, observer, memory), _direction((a, moved), (b, moved_b))]
    for channel in moved:
        if channel in moved_b:
            found += [_peaks(a, b, channel), _rates(a, b, channel)]
    return (*found, _onsets(a, b, *felt))


def _carries(
    names: tuple[str, str], episodes: Episodes, places: tuple[int, int], observer: Observer, memory: MemoryForm
) -> str:
    """The feature that carries most of the first person's distance between two icons."""
    shares = distance_shares(episodes, places[0], episodes, places[1], observer, memory)
    total = math.sqrt(sum(shares.values()))
    one, other = (episodes.listed(0, place) for place in places)
    if not one and not other:
        return f"neither {names[0]} nor {names[1]} is felt, so their names are guessed"
    if total < ALIKE_DPRIME:
        return f"{' and '.join(names)} are remembered alike: d′ {total:.1f} for a nominal person"
    most = max(PARTS, key=lambda part: shares[part])
    size = f"d′ {math.sqrt(shares[most]):.1f} of {total:.1f} for a nominal person"
    if most == "direction":
        said = (", then ".join(episode.channel for episode in felt) or "nothing" for felt in (one, other))
        felt = ", ".join(f"{name} {words}" for name, words in zip(names, said, strict=True))
        return f"mostly distinguished by what is felt: {felt}: {size}"
    words, unit = FEATURES[most]
    first, second = (value or 0.0 for value in most_different(one, other, most))
    one_size, other_size = (f"{value:.3g}" if value < 100.0 else f"{value:.0f}" for value in (first, second))
    sizes = f"{names[0]} {one_size}, {names[1]} {other_size} {unit}"
    return f"mostly distinguished by {words}: {sizes}: {size}"


def _direction(a: tuple[Trace, tuple[Channel, ...]], b: tuple[Trace, tuple[Channel, ...]]) -> str:
    parts = []
    for trace, moved in (a, b):
        sizes = " and ".join(f"{signed(features.excursion_K(trace, c), '+.2f')} K at the {c} receptor" for c in moved)
        parts.append(f"{_name(trace)} {features.direction_words(moved)}" + (f" ({sizes})" if sizes else ""))
    head = "same direction" if a[1] == b[1] else "directions differ"
    return f"{head}: {parts[0]}; {parts[1]}"


def _peaks(a: Trace, b: Trace, channel: Channel) -> str:
    peak_a, peak_b = features.excursion_K(a, channel), features.excursion_K(b, channel)
    needed = load_rules().one("peak", channel=channel).central
    gap = abs(peak_a - peak_b)
    digits = decimals(gap, needed)
    first, second = (signed(peak, f"+.{digits}f") for peak in (peak_a, peak_b))
    return (
        f"both {VERBS[channel]}: peaks {first} and {second} K at the {channel} receptor "
        f"differ by {gap:.{digits}f} K, {verdict(gap, needed)} the just noticeable {fixed(needed, digits)} K"
    )


def _rates(a: Trace, b: Trace, channel: Channel) -> str:
    rate_a, rate_b = features.excursion_rate_K_per_s(a, channel), features.excursion_rate_K_per_s(b, channel)
    needed = load_rules().one("rate ratio").central
    low, high = sorted((abs(rate_a), abs(rate_b)))
    if low == 0.0:
        return f"rates {signed(rate_a, '+.2f')} and {signed(rate_b, '+.2f')} K/s at the {channel} receptor"
    ratio = high / low
    digits = decimals(ratio, needed)
    first, second = (signed(rate, f"+.{digits}f") for rate in (rate_a, rate_b))
    return (
        f"rates {first} and {second} K/s at the {channel} receptor differ by a factor "
        f"{ratio:.{digits}f}, {verdict(ratio, needed)} the just noticeable {fixed(needed, digits)}"
    )


def _onsets(a: Trace, b: Trace, felt_a: Percept, felt_b: Percept) -> str:
    if felt_a.onset_s is None or felt_b.onset_s is None:
        unfelt = [_name(t) for t, p in ((a, felt_a), (b, felt_b)) if p.onset_s is None]
        return f"not felt by the nominal person: {' and '.join(unfelt)}"
    channel: Channel = "warm" if felt_a.channel == felt_b.channel == "warm" else "cold"
    needed = load_rules().one("onset", channel=channel).central
    gap = abs(felt_a.onset_s - felt_b.onset_s)
    digits = decimals(gap, needed)
    return (
        f"nominal person: felt at {felt_a.onset_s:.{digits}f} s ({felt_a.channel}) and {felt_b.onset_s:.{digits}f} s "
        f"({felt_b.channel}): {gap:.{digits}f} s apart, {verdict(gap, needed)} the {fixed(needed, digits)} s "
        f"of the response window"
    )


def _alike(a: Trace, b: Trace) -> bool:
    """Whether both receptors go through the same temperatures at the same times, the shorter trace held at its end."""
    rows = max(a.time_s.size, b.time_s.size)
    courses = ([held(features.receptor_C(trace, channel), rows) for trace in (a, b)] for channel in CHANNELS)
    apart_K = max(float(np.abs(one - other).max()) for one, other in courses)
    return apart_K < features.STILL_K and bool(a.time_s[1] == b.time_s[1])


def _name(trace: Trace) -> str:
    return trace.icon or "the cue"

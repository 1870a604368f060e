"""Why a pair is distinguishable or not: sentences whose every number can be recomputed.

The numbers come from the two nominal traces and percepts through the public functions of
`features`, `distance_components` and `rules`.

Components of the distance of two icons as they are remembered are direction, intensity, rate, duration and pause. Each
is the part of d′ from memory that it carries, so that their squares add up to d′² of the pair.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons.number_text import decimals, fixed, verdict

from ..arrays import Array
from ..identification.episodes import PARTS, Episode, Episodes, distance_shares, remembered
from ..identification.episodes import PARTS as COMPONENTS
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
from ..sensation.percept import Percept, perceive
from .rules import load_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace

__all__ = ["COMPONENTS", "DistanceComponent", "components_of", "distance_components", "strongest"]
NOTICEABLE = 1.0
"""One SD of what is remembered."""


@dataclass(frozen=True, slots=True)
class DistanceComponent:
    """One component of the distance of two icons, in d′ from memory; `a` and `b` are its values for each icon.

    Attributes
    ----------
    name
        `direction` (what only one icon has), `intensity`, `rate`, `duration` or `pause`.
    value
        The part of the d′ of the pair that it carries.
    a, b
        Values of the two episodes at one place that differ most in it, in multiples of threshold (intensity), those per
        second (rate) or s (duration, pause); None for an icon that is not felt, and for `direction`.

    See Also
    --------
    distance_components : Computes all five.

    Examples
    --------
    >>> component = DistanceComponent("rate", 2.5, 12.0, 5.0)
    >>> component, component.above
    (DistanceComponent(rate 2.5 d′), True)

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

    def __repr__(self) -> str:
        return f"DistanceComponent({self.name} {self.value:.3g} d′)"


def distance_components(
    a: Trace, b: Trace, observer: Observer | None = None, felt: tuple[Percept, Percept] | None = None
) -> tuple[DistanceComponent, ...]:
    """The five components of the distance of two simulated icons for a nominal person.

    Parameters
    ----------
    a, b
        Traces at one rate.
    observer
        The person (None: the nominal one).
    felt
        Their percepts, where they are known already.

    Returns
    -------
    tuple of DistanceComponent
        In the order of `COMPONENTS`; the root of their summed squares is the d′ of the pair by the norm `episodes`.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> icons, rig = load_library("six-icons"), Rig.load("thenar")
    >>> step, ramp = (simulate(icons[name], rig, tail_s=10) for name in ("cooling-step", "linear-cooling"))
    >>> max(distance_components(step, ramp), key=lambda component: component.value).name
    'rate'

    """
    person = Observer.load() if observer is None else observer
    percepts = (perceive(a, person), perceive(b, person)) if felt is None else felt
    return components_of(remembered(percepts, person), 0, 1, person)


def components_of(episodes: Episodes, i: int, j: int, observer: Observer) -> tuple[DistanceComponent, ...]:
    """The components of two of the first person's icons."""
    shares = distance_shares(episodes, i, episodes, j, observer, "episodes")
    one, other = (episodes.listed(0, place) for place in (i, j))
    return tuple(
        DistanceComponent(name, math.sqrt(max(shares[name], 0.0)), *most_different(one, other, name))
        for name in COMPONENTS
    )


def strongest(episodes: tuple[Episode, ...]) -> Episode | None:
    """The episode with the largest peak; None of none."""
    return max(episodes, key=lambda episode: episode.peak, default=None)


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
        first, second = (
            None if top is None else float(getattr(top, FIELDS[name]))
            for top in (strongest(tuple(one)), strongest(tuple(other)))
        )
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


@dataclass(frozen=True, slots=True)
class Reason:
    """A sentence, the numbers in it by name, and the unit they share."""

    text: str
    values: dict[str, float]
    unit: str


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
    carries = _carries((_name(a), _name(b)), episodes, places, person, chosen)
    found = [carries, _direction(a, b)]
    for channel in shared:
        found.append(_peaks(a, b, channel))
        found.append(_rates(a, b, channel))
    found.append(_onsets(a, b, felt_a, felt_b))
    return tuple(found)


def _carries(
    names: tuple[str, str], episodes: Episodes, places: tuple[int, int], observer: Observer, norm: Norm
) -> Reason:
    """What distinguishes two of the first person's icons from memory: the feature that carries most of it."""
    shares = distance_shares(episodes, places[0], episodes, places[1], observer, norm)
    total = math.sqrt(sum(shares.values()))
    parts = {part: math.sqrt(share) for part, share in shares.items()}
    values = {"d_prime": total, **parts}
    both = " and ".join(names)
    one, other = (episodes.listed(0, place) for place in places)
    if not one and not other:
        return Reason(f"neither {names[0]} nor {names[1]} is felt, so their names are guessed", values, "d′")
    if total < ALIKE_DPRIME:
        return Reason(f"{both} are remembered alike: d′ {total:.1f} for a nominal person", values, "d′")
    most = max(PARTS, key=lambda part: shares[part])
    size = f"d′ {parts[most]:.1f} of {total:.1f} for a nominal person"
    if most == "direction":
        felt = f"{names[0]} {_said(one)}, {names[1]} {_said(other)}"
        return Reason(f"mostly distinguished by what is felt: {felt}: {size}", values, "d′")
    words, unit = FEATURES[most]
    first, second = (value or 0.0 for value in most_different(one, other, most))
    values.update(a=first, b=second)
    sizes = f"{names[0]} {_number(first)}, {names[1]} {_number(second)} {unit}"
    return Reason(f"mostly distinguished by {words}: {sizes}: {size}", values, "d′")


def _said(episodes: Sequence[Episode]) -> str:
    return ", then ".join(episode.channel for episode in episodes) or "nothing"


def _number(value: float) -> str:
    return f"{value:.3g}" if value < 100.0 else f"{value:.0f}"


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

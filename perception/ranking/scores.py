"""Scores of the parts of a set: of one icon, and of one pair of icons."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..observer.observer import Channel
from .distance_components import DistanceComponent
from .rules import DISTINGUISHABLE, RuleResult


@dataclass(frozen=True, slots=True)
class IconScore:
    """One icon of a ranking: detection, onset, channel and proportion correct are of the people, the rest is nominal.

    Attributes
    ----------
    name
        Name of the icon.
    detected_probability
        Probability that a person drawn at random reports the icon, beyond reports of nothing, 0–1.
    onset_s
        Median response time of the trials that end in a report, s; None where fewer than half of them do.
    channel
        Channel that most reports go by; None where fewer than half of the trials end in one.
    peak_change_K, attack_K_per_s, delay_s
        Largest change in K, steepest rate in K/s, and delay behind the skin in s, at the cold and the warm receptor.
    proportion_correct
        Share of trials with the right name, 0–1.
    reachable, safe
        Whether the rig reaches the icon, and whether no hard safety limit is exceeded.
    reason
        Why it is not safe, cannot be reached, or both; None where it can be played.
    rules
        Results of the rules of thumb.
    rules_score, rules_margin
        Share that is passed of its rules and its pairs, and the smallest normalised margin among them.
    cautions
        Soft safety limits that it exceeds.
    outside_data
        Where no data support the prediction.
    duration_s, energy_J
        How long it lasts, s, and what the driver puts into the module until then, J; NaN on a thermode.

    See Also
    --------
    rank : Returns a ranking, whose `icons` these are.
    """

    name: str
    detected_probability: float
    onset_s: float | None
    channel: Channel | None
    peak_change_K: tuple[float, float]
    attack_K_per_s: tuple[float, float]
    delay_s: tuple[float | None, float | None]
    proportion_correct: float
    reachable: bool
    safe: bool
    reason: str | None
    rules: tuple[RuleResult, ...]
    rules_score: float
    rules_margin: float | None
    cautions: tuple[str, ...] = ()
    outside_data: tuple[str, ...] = ()
    duration_s: float = math.nan
    energy_J: float = math.nan

    @property
    def playable(self) -> bool:
        """Whether the icon is safe and the rig reaches it."""
        return self.safe and self.reachable


@dataclass(frozen=True, slots=True)
class PairScore:
    """One pair of icons: how far apart they are, how often they are confused, and why.

    Attributes
    ----------
    a, b
        Names of the icons.
    d_prime
        Median d′ from memory over people.
    confused_probability
        Share of trials in which one is named as the other, the mean of both directions, 0–1.
    why
        Reasons in words, for a nominal person.
    rules
        Results of the rules of thumb.
    rules_margin
        Margin by which rules separate the pair, in shares of a threshold; None: by direction alone.
    parts
        Components of the distance for a nominal person.

    See Also
    --------
    rank : Returns a ranking, whose `pairs` these are.
    """

    a: str
    b: str
    d_prime: float
    confused_probability: float
    why: tuple[str, ...]
    rules: tuple[RuleResult, ...]
    rules_margin: float | None = None
    parts: tuple[DistanceComponent, ...] = ()

    @property
    def rules_pass(self) -> bool:
        """Whether the two are distinguishable by rules alone."""
        return any(r.passed for r in self.rules if r.rule == DISTINGUISHABLE)

"""The reason that carries a distance from memory: which feature of the remembered episodes, in one sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..identification.episodes import PARTS, Episode, Episodes, distance_shares
from ..observer.observer import Norm, Observer
from .distance_components import most_different

ALIKE_DPRIME = 0.3
"""Below this no feature is named: two icons are then distinguished in less than 56 % of trials."""
FEATURES = {
    "intensity": ("how strong they are", "times threshold"),
    "rate": ("how fast they start", "times threshold per second"),
    "duration": ("how long they last", "s at half the peak"),
    "pause": ("the pause before an episode", "s"),
}
"""Part of a distance: the feature in words, and its unit in words."""


def carrying_feature(
    names: tuple[str, str], episodes: Episodes, places: tuple[int, int], observer: Observer, norm: Norm
) -> tuple[str, dict[str, float]]:
    """A sentence on what distinguishes two of the first person's icons from memory, and the numbers behind it."""
    shares = distance_shares(episodes, places[0], episodes, places[1], observer, norm)
    total = math.sqrt(sum(shares.values()))
    parts = {part: math.sqrt(share) for part, share in shares.items()}
    values = {"d_prime": total, **parts}
    both = " and ".join(names)
    one, other = (episodes.listed(0, place) for place in places)
    if not one and not other:
        return f"neither {names[0]} nor {names[1]} is felt, so their names are guessed", values
    if total < ALIKE_DPRIME:
        return f"{both} are remembered alike: d′ {total:.1f} for a nominal person", values
    most = max(PARTS, key=lambda part: shares[part])
    size = f"d′ {parts[most]:.1f} of {total:.1f} for a nominal person"
    if most == "direction":
        return (
            f"mostly distinguished by what is felt: {names[0]} {_said(one)}, {names[1]} {_said(other)}: {size}",
            values,
        )
    words, unit = FEATURES[most]
    first, second = (value or 0.0 for value in most_different(one, other, most))
    values.update(a=first, b=second)
    return (
        f"mostly distinguished by {words}: {names[0]} {_number(first)}, {names[1]} {_number(second)} {unit}: {size}",
        values,
    )


def _said(episodes: Sequence[Episode]) -> str:
    return ", then ".join(episode.channel for episode in episodes) or "nothing"


def _number(value: float) -> str:
    return f"{value:.3g}" if value < 100.0 else f"{value:.0f}"

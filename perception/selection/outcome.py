"""What goals are judged by, out of a ranking: the whole set, or what was chosen of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array

if TYPE_CHECKING:
    from ..ranking.ranking import Ranking
    from .choose import Choice


@dataclass(frozen=True, slots=True)
class SetOutcome:
    """What goals are judged by: scores of a set, its icons, and its people.

    Attributes
    ----------
    names
        Names of all icons.
    correct, bits, d_prime
        Means over people, and d′ of the nearest pair.
    detected, onset_s
        Of every icon; onset is NaN where it is not felt.
    durations_s, energies_J
        Of every icon; energies are NaN on a thermode, which states none.
    worst_pair
        Names of the pair that is confused most; None for one icon.
    nearest_pair
        Names of the pair with the smallest d′; None for one icon.
    amber, red
        Names of the icons that pass a soft limit of safety, and of those that pass a hard one.
    unreached
        Names of the icons that the rig does not reach: no matter of safety, which judges what the rig plays of them.
    persons
        Values of `correct`, `detected` (of the icon that is detected least) and `bits` for single people (n,), of all
        draws together; empty without draws.
    """

    names: tuple[str, ...]
    correct: float
    bits: float
    d_prime: float
    detected: Array
    onset_s: Array
    durations_s: Array
    energies_J: Array
    worst_pair: tuple[str, str] | None
    nearest_pair: tuple[str, str] | None
    amber: tuple[str, ...]
    red: tuple[str, ...]
    persons: dict[str, Array]
    unreached: tuple[str, ...] = ()

    @property
    def unplayable(self) -> tuple[str, ...]:
        """Names of the icons that are not safe or not reached."""
        return tuple(name for name in self.names if name in self.red or name in self.unreached)

    @classmethod
    def of(cls, ranking: Ranking) -> SetOutcome:
        """What a goal for the whole set is judged by."""
        icons, felt = ranking.icons, ranking.felt
        nearest = min(ranking.pairs, key=lambda pair: pair.d_prime, default=None)
        return cls(
            names=ranking.labels,
            correct=ranking.proportion_correct,
            bits=ranking.information_bits,
            d_prime=math.nan if nearest is None else nearest.d_prime,
            detected=felt.detected,
            onset_s=felt.detection.onset_s,
            durations_s=np.array([icon.duration_s for icon in icons]),
            energies_J=np.array([icon.energy_J for icon in icons]),
            worst_pair=ranking.worst_pair,
            nearest_pair=None if nearest is None else (nearest.a, nearest.b),
            amber=tuple(icon.name for icon in icons if icon.safe and icon.cautions),
            red=tuple(icon.name for icon in icons if not icon.safe),
            persons={} if ranking.new_laboratory is None else ranking.new_laboratory.persons,
            unreached=tuple(icon.name for icon in icons if not icon.reachable),
        )

    def of_choice(self, choice: Choice) -> SetOutcome:
        """The same for the chosen icons alone, as a set of their own."""
        places, own = [self.names.index(name) for name in choice.icons], choice.at_own_range
        return SetOutcome(
            names=choice.icons,
            correct=own.proportion_correct,
            bits=own.information_bits,
            d_prime=own.d_prime,
            detected=self.detected[places],
            onset_s=self.onset_s[places],
            durations_s=self.durations_s[places],
            energies_J=self.energies_J[places],
            worst_pair=own.worst_pair,
            nearest_pair=own.worst_pair,
            amber=tuple(name for name in self.amber if name in choice.icons),
            red=(),
            persons={} if choice.new_laboratory is None else choice.new_laboratory.persons,
        )

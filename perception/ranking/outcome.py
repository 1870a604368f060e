"""What goals are judged by, from a ranking in the making: the whole set, or what was chosen of it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..identification.laboratory import NewLaboratory
from ..selection.choose import Choice
from ..selection.goal_result import SetOutcome
from .assemble import Assembled
from .batches import PooledResult


def outcome_of_set(
    made: Assembled,
    all_: PooledResult,
    durations: Sequence[float],
    energies: Sequence[float],
    worst: tuple[str, str] | None,
    elsewhere: NewLaboratory | None,
) -> SetOutcome:
    """What a goal for the whole set is judged by."""
    nearest = min(made.pairs, key=lambda pair: pair.d_prime, default=None)
    return SetOutcome(
        names=tuple(icon.name for icon in made.icons),
        correct=float(all_.correct.mean()),
        bits=float(all_.bits.mean()),
        d_prime=math.nan if nearest is None else nearest.d_prime,
        detected=all_.detected,
        onset_s=all_.detection.onset_s,
        durations_s=np.array(durations),
        energies_J=np.array(energies),
        worst_pair=worst,
        nearest_pair=None if nearest is None else (nearest.a, nearest.b),
        amber=tuple(icon.name for icon in made.icons if icon.safe and icon.cautions),
        red=tuple(icon.name for icon in made.icons if not icon.safe),
        persons={} if elsewhere is None else elsewhere.persons,
        unreached=tuple(icon.name for icon in made.icons if not icon.reachable),
    )


def outcome_of_choice(whole: SetOutcome, picked: Choice) -> SetOutcome:
    """The same for the chosen icons alone, as a set of their own."""
    places, own = [whole.names.index(name) for name in picked.icons], picked.at_own_range
    return SetOutcome(
        names=picked.icons,
        correct=own.proportion_correct,
        bits=own.information_bits,
        d_prime=own.d_prime,
        detected=whole.detected[places],
        onset_s=whole.onset_s[places],
        durations_s=whole.durations_s[places],
        energies_J=whole.energies_J[places],
        worst_pair=own.worst_pair,
        nearest_pair=own.worst_pair,
        amber=tuple(name for name in whole.amber if name in picked.icons),
        red=(),
        persons={} if picked.new_laboratory is None else picked.new_laboratory.persons,
    )

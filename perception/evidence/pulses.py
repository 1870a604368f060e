"""Sequences of short pulses: how often the best 22 and 16 of 52 would be named correctly.

Published are the shares of 22 and of 16 cues; their levels, lengths, site and display are unknown, so that the
sequences are this project's own, and the result is shown and not judged.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermicon.circuit import Rig

from ..identification.laboratory_draws import PEOPLE
from ..identification.measures import proportion_correct
from ..observer.observer import DATA
from ..observer.people import draw_people
from ..selection.appraise import population_dprime
from ..selection.max_min_subset import max_min_subset
from .identified import Identified, Shown, show
from .predicted import Predicted

CUES, RIG, CHOSEN = DATA / "short-pulses.cue", "tcs2", (22, 16)


def show_pulses(people: int, seed: int) -> tuple[Shown, ...]:
    """Play the sequences of each choice to virtual people on a thermode; the nominal observer chooses, by median d′."""
    from thermicon.icons import read_cue

    icons, rig = list(read_cue(CUES)), Rig.load(RIG)
    middle = np.median(population_dprime(icons, rig, draw_people(PEOPLE, seed))[0], axis=0)
    best = [max_min_subset(middle, count) for count in CHOSEN]
    return tuple(show([icons[place] for place in one.chosen], rig, people, seed) for one in best if one is not None)


def named_pulses(each: Sequence[Identified]) -> tuple[Predicted, ...]:
    """Proportion correct of each choice."""
    return tuple(
        found.predicted(
            "short pulses", f"proportion correct of the best {len(found.labels)}", "proportion",
            lambda p: float(proportion_correct(p).mean()), top=1.0,
            conditions=f"named from memory, {found.probability.shape[0]} people, {RIG}, best by the worst pair of 52",
        )
        for found in each
    )  # fmt: skip

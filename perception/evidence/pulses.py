"""Short pulses: published cues known only by a summary.

Of 52 sequences of one to three pulses the best 22 and 16 (the published counts) and 22 random ones are predicted.
"""

from functools import lru_cache

import numpy as np

from thermicon.circuit import Rig
from thermicon.icons import Icon, read_cue

from ..identification.confusion import confuse
from ..identification.laboratory_draws import SAMPLES
from ..identification.population import memory_dprime, respond
from ..identification.task import USUAL
from ..observer.channels import MEMORY_FORMS, Variable
from ..observer.observer import DATA, Observer
from ..ranking.rank import rank
from ..ranking.ranking import Ranking
from ..selection.choose import choose
from ..selection.request import Selection
from .identified import ShownSet, correct, show
from .predicted import DRAWS, Predicted

RIG, COUNTS, SETS = "tcs2", (22, 16), 100
RANKED, SHOWN = 24, 50
"""People by whom the best are chosen (largest least d′ of a pair), and to whom those are then shown, at most."""


@lru_cache(maxsize=2)
def _ranked(seed: int) -> Ranking:
    return rank(read_cue(DATA / "short-pulses.cue"), Rig.load(RIG), people=RANKED, seed=seed, parameters=0)


def best_pulses(count: int, seed: int) -> tuple[Icon, ...]:
    """The sequences, `count` of them, whose nearest two are farthest apart; those named best are no better."""
    chosen = choose(_ranked(seed), Selection(count), parameters=0).icons
    return tuple(icon for icon in _ranked(seed).job.icons if icon.name in chosen)


@lru_cache(maxsize=4)
def _shown(count: int | None, people: int, seed: int) -> ShownSet:
    """The best sequences, or all, as both variants are asked of them."""
    return show(_ranked(seed).job.icons if count is None else best_pulses(count, seed), Rig.load(RIG), people, seed)


def short_pulses(variable: Variable, people: int, draws: int, seed: int) -> tuple[Predicted, ...]:
    """Proportion correct of the best sequences, and the mean of sets that chance draws, each as a set of its own."""
    made = []
    for count in COUNTS:
        found = _shown(count, min(people, SHOWN), seed).identify(variable, min(draws, DRAWS))
        asked = f"proportion correct, best {count}"
        made.append(found.predicted("short pulses", asked, "proportion", correct, top=1.0))
    every, observer = _shown(None, RANKED, seed), Observer.load(variable=variable)
    felt = respond(every.played(variable), every.crowd, observer, detection=False)
    apart = memory_dprime(felt, MEMORY_FORMS[0], every.crowd.memory, observer, USUAL)
    chance, said = (
        np.random.default_rng(np.random.SeedSequence([seed, 31])),
        f"{SETS} sets of {RANKED} people, {RIG}, {MEMORY_FORMS[0]}",
    )
    scores = []
    for _ in range(SETS):
        own = np.sort(chance.choice(len(every.icons), COUNTS[0], replace=False))
        among = apart[:, own][:, :, own]
        scores.append(correct(confuse(among, lapse=every.crowd.lapse, seed=seed, samples=SAMPLES).probability))
    asked = f"proportion correct, mean of random {COUNTS[0]}"
    about = float(np.mean(scores)), "proportion", None, None, variable, said
    return (*made, Predicted("short pulses", asked, "both", *about))

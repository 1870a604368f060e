"""The plan of an experiment: the participants and trials that it needs by simulation.

Each takes place in another laboratory that the evidence allows. The mean over its participants is reported with
Student's 95 % interval; two sets are compared within participants by the paired t test.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.program import own_version
from thermicon.base.results.drawn import Tabled
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.pairs import pair_scores
from ..kernels.parallel import Progress, step_counter
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords
from .observed import LEAST_DRAWS
from .playing import Confusions, laboratories_for, stage
from .prediction import SetPrediction, Three, three
from .states import LaboratoryPrior
from .worth import Worth, narrower, worth_of

DRAWS, EXPERIMENTS = 300, 600
PARTICIPANTS, TRIALS = (4, 8, 12, 16, 24, 32, 48), (12, 24, 48, 96)
MOST_PARTICIPANTS, MOST_TRIALS = 500, 5000
POWER, WIDTH = 0.8, 0.10
FEWEST = 2
"""Participants that an interval over participants needs."""


@dataclass(frozen=True, slots=True)
class ExperimentSize:
    """An experiment of so many participants and trials (each, of each set), and what it is expected to give.

    `width` is that of the 95 % interval of the proportion named, or of the difference of two sets, which a share
    `found` of experiments distinguishes in the right direction, and `wrong` in the other. The answers make the interval
    of the laboratory `narrower`, at most so many times.
    """

    participants: int
    trials: int
    width: float
    narrower: float
    found: float | None = None
    wrong: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        own = {"participants": self.participants, "trials": self.trials, "interval_width": self.width}
        own["narrower"] = self.narrower
        return own if self.found is None else {**own, "found": self.found, "wrong": self.wrong}


@dataclass(frozen=True, slots=True)
class ExperimentPlan(Tabled):
    """Designs that were simulated, and the one to take.

    Attributes
    ----------
    predictions
        The prediction of each set.
    difference
        Proportion named of the first set less that of the second: mean and 95 % of laboratories (None: one set).
    designs
        All of them, by participants and trials.
    wanted
        What was asked for: the power of two sets, or the width of the interval of one.
    worth
        What measurements could narrow the proportion named of a laboratory, or the difference, the most first.
    worst_pair
        The two icons of the first set that are confused most often, whose trials tell most of it.
    """

    predictions: tuple[SetPrediction, ...]
    difference: Three | None
    designs: tuple[ExperimentSize, ...]
    wanted: float
    worth: tuple[Worth, ...]
    worst_pair: tuple[str, str]
    rig: str
    rig_changes: tuple[str, ...]
    memory: str
    seed: int
    draws: int
    version: str

    def enough(self, design: ExperimentSize) -> bool:
        """Whether a design gives what was asked for."""
        return design.width <= self.wanted if design.found is None else design.found >= self.wanted

    @property
    def cheapest(self) -> ExperimentSize | None:
        """The design of the fewest trials that gives what was asked for, of equal ones that of fewer participants."""
        good = [each for each in self.designs if self.enough(each)]
        return min(good, key=lambda each: (each.participants * each.trials, each.participants)) if good else None

    def to_dict(self) -> dict[str, Any]:
        """Every number as plain data."""
        cheapest = self.cheapest
        return {
            "version": self.version,
            "rig": self.rig,
            "rig_changes": list(self.rig_changes),
            "memory": self.memory,
            "seed": self.seed,
            "draws": self.draws,
            "sets": [asdict(each) for each in self.predictions],
            "difference": None if self.difference is None else list(self.difference),
            "wanted": {"power" if self.difference is not None else "interval_width": self.wanted},
            "designs": [each.to_dict() for each in self.designs],
            "worth": [asdict(each) for each in self.worth],
            "worst_pair": list(self.worst_pair),
            "cheapest": None if cheapest is None else cheapest.to_dict(),
        }

    def rows(self) -> list[dict[str, Any]]:
        """One row per design."""
        return [{**each.to_dict(), "enough": self.enough(each)} for each in self.designs]

    def to_json(self) -> str:
        """Every number as JSON text."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    def __repr__(self) -> str:
        return f"ExperimentPlan({len(self.designs)} designs, the cheapest {self.cheapest})"


@checked
def plan(
    icons: Icons,
    rig: AnyRig = None,
    other: Icons | None = None,
    *,
    crowd: Crowd = EVERYBODY,
    participants: Sequence[int] = PARTICIPANTS,
    trials: Sequence[int] = TRIALS,
    wanted: float | None = None,
    draws: int = DRAWS,
    progress: Progress | None = None,
    **words: Unpack[CrowdWords],
) -> ExperimentPlan:
    """Simulate experiments of several sizes.

    Parameters
    ----------
    icons, rig
        As in `rank`.
    other
        A second set, to be distinguished from the first by its proportion named.
    crowd
        Who feels and remembers the icons; its observer must have draws of the posterior, as `observed` keeps them.
    participants, trials
        Sizes to try: participants, and trials of each participant with each set.
    wanted
        Power (two sets, None: 0.8), or width of the 95 % interval of the proportion named (one set, None: 0.1).
    draws
        Draws of the posterior, each with a laboratory around it.
    progress
        Called with (steps done, steps in all).
    **words
        Single words of the crowd, such as ``people=50``.

    Returns
    -------
    ExperimentPlan
        The same numbers for the same arguments.

    Raises
    ------
    ValueError
        For sizes, draws or a wish out of range, and for a set of fewer than 2 or more than 64 icons.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> found = plan(read_cue("six-icons"), Rig.load("thenar"), participants=[4, 40], trials=[24], draws=20)
    >>> found.designs[1].width < found.designs[0].width
    True
    """
    _check(participants, trials, wanted, draws)
    if "people" in words:
        raise InputError("plan: people are the participants; leave it out")
    crowd = crowd.but(**words)
    sets, seed = [set_of(each) for each in (icons, other) if each is not None], crowd.seed
    rig = Rig.of(rig, sets[0].context.site)
    prior = LaboratoryPrior.of(crowd.observer, crowd.memory)
    number = laboratories_for(max(2, *(len(list(each)) for each in sets)), draws)
    laboratories = prior.first(number, seed)
    step = step_counter(progress, number * len(sets) + len(participants) * len(trials))
    stages = [stage(each, rig, prior, seed=seed, tracking=crowd.tracking) for each in sets]
    played = [
        each.confusions(laboratories, step).with_scores(pair_scores(len(each.icons), number, seed)) for each in stages
    ]
    apart = None if other is None else played[0].correct - played[1].correct
    pooled: Array = played[0].pooled.mean(axis=0)
    confused = np.triu(pooled + pooled.T, k=1)
    first, second = np.unravel_index(confused.argmax(), confused.shape)
    designs = []
    for k, people in enumerate(participants):
        for j, times in enumerate(trials):
            designs.append(_simulated(played, people, times, np.random.SeedSequence([seed, 24, k, j])))
            step()
    return ExperimentPlan(
        predictions=tuple(SetPrediction.of(each.title, one) for each, one in zip(sets, played, strict=True)),
        difference=None if apart is None else three(apart),
        designs=tuple(designs),
        wanted=wanted if wanted is not None else (WIDTH if other is None else POWER),
        worth=worth_of(prior, laboratories, played[0].correct if apart is None else apart),
        worst_pair=(played[0].icons[first], played[0].icons[second]),
        rig=rig.name,
        rig_changes=rig.changes,
        memory=crowd.memory,
        seed=seed,
        draws=number,
        version=own_version(),
    )


def _check(participants: Sequence[int], trials: Sequence[int], wanted: float | None, draws: int) -> None:
    if not participants or not trials:
        raise ValueError("at least one number of participants and one of trials are needed")
    if not all(FEWEST <= each <= MOST_PARTICIPANTS for each in participants):
        raise ValueError(f"participants must be {FEWEST} to {MOST_PARTICIPANTS}, since one alone shows no spread")
    if not all(1 <= each <= MOST_TRIALS for each in trials):
        raise ValueError(f"trials of a participant must be 1 to {MOST_TRIALS}")
    if wanted is not None and not 0.0 < wanted < 1.0:
        raise ValueError(f"what is wanted, {wanted:g}, must lie between 0 and 1: a power, or a width of proportions")
    if draws < LEAST_DRAWS:
        raise ValueError(f"at least {LEAST_DRAWS} draws are needed, not {draws}")


def _simulated(played: Sequence[Confusions], people: int, trials: int, seed: np.random.SeedSequence) -> ExperimentSize:
    """One size of experiment, simulated in one laboratory after the other."""
    from scipy.stats import t

    rng = np.random.default_rng(seed)
    laboratories, crowd = played[0].probability.shape[:2]
    where = np.arange(EXPERIMENTS) % laboratories
    invited = rng.integers(crowd, size=(EXPERIMENTS, people))
    shares = [_shares(one, where, invited, trials, rng) for one in played]
    each = shares[0] if len(shares) == 1 else shares[0] - shares[1]
    half = float(t.ppf(0.975, people - 1)) * each.std(axis=1, ddof=1) / np.sqrt(people)
    truth = played[0].correct if len(played) == 1 else played[0].correct - played[1].correct
    middle = each.mean(axis=1)
    off = float(np.mean((middle - truth[where]) ** 2))
    known = narrower(float(truth.var()) / (float(truth.var()) + off))
    if len(shares) == 1:
        width = np.minimum(middle + half, 1.0) - np.maximum(middle - half, 0.0)
        return ExperimentSize(people, trials, float(width.mean()), known)
    shown = np.abs(middle) > half
    right = np.sign(middle) == np.sign(truth[where])
    width, found, wrong = (2.0 * half).mean(), (shown & right).mean(), (shown & ~right).mean()
    return ExperimentSize(people, trials, float(width), known, float(found), float(wrong))


def _shares(
    one: Confusions, where: NDArray[np.int64], invited: NDArray[np.int64], trials: int, rng: np.random.Generator
) -> Array:
    """Proportion named (experiments, participants) of presentations as even as possible."""
    icons = len(one.icons)
    chances = np.diagonal(one.probability, axis1=2, axis2=3)[where[:, None], invited]
    shown = np.full(chances.shape, trials // icons)
    if rest := trials % icons:
        shown += rng.random(chances.shape).argsort(axis=-1) < rest
    return np.asarray(rng.binomial(shown, np.minimum(chances, 1.0)).sum(axis=-1) / trials)

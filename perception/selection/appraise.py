"""A set in a few numbers: the chain of `rank` without reasons and intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Unpack

import numpy as np

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import Icon
from thermicon.icons.files.shipped import Icons, icons_of

from ..identification.confusion import normalised
from ..identification.measures import felt_and_named, proportion_correct
from ..identification.population import (
    RATE_HZ,
    PopulationResponse,
    ReceptorTemperatures,
    identify_by,
    respond,
    run_end_s,
)
from ..identification.task import USUAL, Task
from ..observer.observer import Observer
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords
from ..observer.people import People
from .request import Objective

NOT_TOLD = ("reached", "reached_named", "each_felt_and_named", "detected", "confused")
REACHED_BY = 0.95
"""Share of people who reach what a set is also judged by."""


@dataclass(frozen=True, slots=True)
class Appraisal:
    """One set at its own range: the worst pair by median d′, proportion named, bits, and bits per second.

    `reached` is what 95 % of people feel and name, `reached_named` what they name; `each_felt_and_named` (icons,) is
    that of single icons, `detected` (icons,) how often they are reported, and `confused` (icons, icons) how often they
    are named as each other, the mean of both ways, diagonal: as themselves.
    """

    worst_pair: tuple[str, str]
    d_prime: float
    felt_and_named: float
    proportion_correct: float
    information_bits: float
    bits_per_s: float
    reached: float
    reached_named: float
    each_felt_and_named: Array = field(compare=False, repr=False)
    detected: Array = field(compare=False, repr=False)
    confused: Array = field(compare=False, repr=False)

    def value(self, objective: Objective) -> float:
        """The number by which an objective judges a set."""
        return {
            "worst": self.d_prime,
            "felt-and-named": self.felt_and_named,
            "named": self.proportion_correct,
            "bits": self.information_bits,
            "bits-per-s": self.bits_per_s,
        }[objective]

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {name: value for name, value in asdict(self).items() if name not in NOT_TOLD}


@checked
def appraise(
    icons: Icons,
    rig: AnyRig = None,
    *,
    crowd: Crowd = EVERYBODY,
    task: Task = USUAL,
    **words: Unpack[CrowdWords],
) -> Appraisal:
    """Predict how well people identify two or more icons, with the same people and noise as `rank`.

    `icons`, `rig`, `crowd` with its `words`, and `task` are as in `rank`.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> six = read_cue("six-icons")
    >>> appraise([six["cooling-step"], six["warming-step"]], Rig.load("thenar"), people=4).worst_pair
    ('cooling-step', 'warming-step')
    """
    icons, crowd = icons_of(icons), crowd.but(**words)
    if len(icons) < 2:
        raise InputError("at least two icons are needed to be distinguished")
    rig, model = Rig.of(rig, icons[0].context.site), crowd.model
    people, nominal = model.people(crowd.people, crowd.seed), model.nominal
    felt, durations = population_response(icons, rig, people, crowd.tracking, detection=True, observer=nominal)
    named = identify_by(felt, model.form_shares(crowd.memory), people, nominal, crowd.seed, task=task)
    probability, bits = named.probability, float(named.bits.mean())
    each, pooled = proportion_correct(probability), normalised(probability.mean(axis=0))
    alert, middle = felt_and_named(felt.detected.probability, probability), np.median(named.d_prime, axis=0)
    a, b = nearest_two(middle)
    return Appraisal(
        worst_pair=(icons[a].name, icons[b].name),
        d_prime=float(middle[a, b]),
        felt_and_named=float(alert.mean()),
        proportion_correct=float(each.mean()),
        information_bits=bits,
        bits_per_s=bits / float(np.mean(durations)),
        reached=float(np.quantile(alert.mean(axis=1), 1.0 - REACHED_BY)),
        reached_named=float(np.quantile(each, 1.0 - REACHED_BY)),
        detected=felt.detected.probability.mean(axis=0),
        each_felt_and_named=alert.mean(axis=0),
        confused=0.5 * (pooled + pooled.T),
    )


def nearest_two(distances: Array) -> tuple[int, int]:
    """Places of the nearest pair, in rising order, the first of equal ones."""
    first, second = np.triu_indices(len(distances), 1)
    k = int(distances[first, second].argmin())
    return int(first[k]), int(second[k])


def population_response(
    icons: Sequence[Icon],
    rig: Rig,
    crowd: People,
    tracking: str | None = None,
    *,
    rate_Hz: float = RATE_HZ,
    end_s: float | None = None,
    detection: bool = False,
    observer: Observer,
) -> tuple[PopulationResponse, Array]:
    """Every person's response to every icon, and durations (s) of the icons."""
    durations = np.array([duration_s(icon, rig) for icon in icons])
    end = run_end_s(durations.tolist(), rate_Hz) if end_s is None else end_s
    played = ReceptorTemperatures.simulated(icons, crowd, rig, observer, end, rate_Hz, tracking)
    return respond(played, crowd, observer, detection=detection), durations

"""One predicted number with its uncertainty from unmeasured parameters and from people.

Intervals come from laboratories that the evidence leaves possible, as `rank` draws them.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..experiments.laboratory import PEOPLE, SEED, Laboratory
from ..experiments.measure import Setting
from ..identification.laboratory_draws import DrawnLaboratories
from ..kernels.parallel import in_order
from ..observer.channels import CHANNELS, MemoryChoice, Variable
from ..observer.draws import PosteriorDraws
from ..observer.mechanisms.age import YOUNG_YEARS
from ..observer.observer import Observer, variant_records
from ..observer.observer_model import ObserverModel
from ..observer.people import People

DRAWS = 24
"""Observers drawn for an interval: enough to see its size, not its second digit."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """A number that a published experiment can be compared with; a prediction, not a measurement.

    `value` is that of the nominal observer (None: nothing felt), `low` and `high` enclose 95 % of the laboratories,
    `draws` has their answers (inf: not felt): the k-th is the same observer in all experiments of a variant with as
    many draws. `baseline` is what skin temperature alone predicts (None: nothing).
    """

    experiment: str
    quantity: str
    channel: str
    value: float | None
    unit: str
    low: float | None
    high: float | None
    variable: Variable
    conditions: str
    draws: tuple[float, ...] = ()
    baseline: float | None = None


@lru_cache(maxsize=8)
def laboratory_of(
    person: Observer, setting: Setting, *, people: int | None = None, seed: int = SEED, age_years: float = YOUNG_YEARS
) -> Laboratory:
    """A laboratory without an offset that asks this person alone, or `people` of an age, on the skin of a rig."""
    # The skin is the rig's own; age is an offset of sensitivity, in natural logarithms.
    met = replace(person, effusivity=1.0)
    older = [-math.log(person.age_factor(age_years, channel)) for channel in CHANNELS]
    made = setting.laboratory(met, older, people or PEOPLE, seed)
    return made if people is not None else replace(made, people=People.nominal(PEOPLE, person))


@dataclass(frozen=True, slots=True)
class Query:
    """A question to subjects, their answers (inf: not), and the answer from skin temperature alone."""

    quantity: str
    channel: str
    unit: str
    conditions: str
    answer: Callable[[Observer], float]
    baseline: float | None = None


def predict(
    experiment: str, asked: Sequence[Query], variable: Variable, draws: int = DRAWS, seed: int = 0
) -> tuple[Predicted, ...]:
    """Answers of the nominal observer, with the interval over `draws` plausible ones (0: none) of a seed."""

    def answers(person: Observer) -> list[float]:
        return [one.answer(person) for one in asked]

    nominal = answers(Observer.load(variable=variable))
    others = list(in_order(answers, plausible_observers(draws, seed, variable) if draws else ()))
    made = []
    for place, one in enumerate(asked):
        each = tuple(found[place] for found in others)
        value = nominal[place] if np.isfinite(nominal[place]) else None
        about = (one.quantity, one.channel, value, one.unit, *interval_of(each), variable, one.conditions)
        made.append(Predicted(experiment, *about, draws=each, baseline=one.baseline))
    return tuple(made)


def quantile_felt(ordered: Array, share: float) -> float | None:
    """Value that a share of numbers (n,), in rising order, lies below; None where it lies among those not felt (inf).

    >>> quantile_felt(np.array([1.0, 2.0, np.inf]), 0.25), quantile_felt(np.array([1.0, 2.0, np.inf]), 0.75)
    (1.5, None)
    """
    place = share * (ordered.size - 1)
    low, high = float(ordered[int(np.floor(place))]), float(ordered[int(np.ceil(place))])
    found = low if low == high else low + (place - np.floor(place)) * (high - low)
    return float(found) if np.isfinite(found) else None


def interval_of(each: Sequence[float]) -> tuple[float | None, float | None]:
    """The 95 % interval of answers (inf: not felt); an end among those not felt is None.

    >>> interval_of((1.0, 2.0, 3.0)), interval_of(())
    ((1.05, 2.95), (None, None))
    """
    ordered = np.sort(np.asarray(each, dtype=np.float64))
    if not ordered.size:
        return None, None
    return quantile_felt(ordered, 0.025), quantile_felt(ordered, 0.975)


def plausible_laboratories(n: int, seed: int, variable: Variable, memory: MemoryChoice = "both") -> DrawnLaboratories:
    """Laboratories of n draws of the posterior of a variant."""
    posterior, records = PosteriorDraws.load(variable=variable), variant_records(variable)
    return DrawnLaboratories.of(replace(ObserverModel.load(), records=records, posterior=posterior), memory, n, seed)


def plausible_observers(n: int, seed: int, variable: Variable = "temperature") -> tuple[Observer, ...]:
    """The observers of these laboratories; the same for the same seed."""
    drawn = plausible_laboratories(n, seed, variable)
    return tuple(drawn.at(place, 1)[0] for place in range(n))

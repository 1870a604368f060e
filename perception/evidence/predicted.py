"""One predicted number with its uncertainty: parameters that nobody has measured, and people; and what goes with what.

Intervals come from laboratories that the evidence leaves possible, as `rank` draws them; experiments that no population
was simulated for ask their observers alone. Unmeasured constants move several predictions at once: where what brings
one nearer to its published number takes another away from its own, no choice of those constants can satisfy both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations

import numpy as np

from ..arrays import Array
from ..identification.laboratory_draws import DrawnLaboratories
from ..kernels.parallel import in_order
from ..observer.channels import USUAL_NORM, Variable
from ..observer.draws import PosteriorDraws
from ..observer.observer import Observer, variant_records
from ..observer.observer_model import ObserverModel

DRAWS = 24
"""Observers drawn for an interval: enough to see its size, not its second digit."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """A number that a published experiment can be compared with; a prediction, not a measurement.

    `value` is that of the nominal observer (median of people where there are some), None where nothing
    was felt. `low`, `high` enclose 95 % of the observers that the assumed and calibrated intervals leave
    possible; `people` is the 16 to 84 % interval over virtual people at nominal parameters. `draws` has the
    answers of those observers (inf: not felt): the k-th is the same observer in every experiment of a
    variant that was run with as many draws, so that two predictions can be plotted against each other.
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
    people: tuple[float, float] | None = None
    draws: tuple[float, ...] = ()

    def __repr__(self) -> str:
        value = "nothing felt" if self.value is None else f"{self.value:.3g} {self.unit}"
        span = "" if self.low is None or self.high is None else f" [{self.low:.3g}, {self.high:.3g}]"
        return (
            f"Predicted({self.experiment}, {self.quantity}, {self.channel}: {value}{span} "
            f"from {self.variable}; {self.conditions})"
        )


@dataclass(frozen=True, slots=True)
class Asked:
    """What an experiment is asked for: quantity, channel, unit, conditions, and how an observer answers (inf: not)."""

    quantity: str
    channel: str
    unit: str
    conditions: str
    answer: Callable[[Observer], float]


def predict(
    experiment: str,
    asked: Sequence[Asked],
    variable: Variable,
    draws: int = DRAWS,
    seed: int = 0,
) -> tuple[Predicted, ...]:
    """Answers of the nominal observer, with the interval over `draws` plausible ones (0: none) of a seed."""
    nominal = Observer.load(variable=variable)
    others = plausible_observers(draws, seed, variable=variable) if draws else ()
    made = []
    for one in asked:
        found, each = one.answer(nominal), tuple(in_order(one.answer, others))
        value = float(found) if np.isfinite(found) else None
        ends = interval_of(each)
        about = (one.quantity, one.channel, value, one.unit, *ends, variable, one.conditions)
        made.append(Predicted(experiment, *about, draws=each))
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
    """What encloses 95 % of answers (inf: not felt); an end that lies among those not felt is None.

    >>> interval_of((1.0, 2.0, 3.0)), interval_of(())
    ((1.05, 2.95), (None, None))
    """
    ordered = np.sort(np.asarray(each, dtype=np.float64))
    if not ordered.size:
        return None, None
    return quantile_felt(ordered, 0.025), quantile_felt(ordered, 0.975)


def plausible_laboratories(n: int, seed: int, variable: Variable) -> DrawnLaboratories:
    """Laboratories of n draws of the posterior of a variant; a ValueError for fewer than two."""
    if n < 2:
        raise ValueError(f"at least two observers are needed to show an interval, not {n}")
    posterior, records = PosteriorDraws.load(variable=variable), variant_records(variable)
    return DrawnLaboratories.of(
        replace(ObserverModel.load(), records=records, posterior=posterior), USUAL_NORM, n, seed
    )


@lru_cache(maxsize=8)
def plausible_observers(n: int = 32, seed: int = 0, *, variable: Variable = "temperature") -> tuple[Observer, ...]:
    """The observers of these laboratories; the same for the same seed.

    >>> len(plausible_observers(2)), plausible_observers(2) == plausible_observers(2)
    (2, True)
    """
    laboratories = plausible_laboratories(n, seed, variable)
    return tuple(laboratories.at(place, 1)[0] for place in range(n))


STRONG, RARE = 0.5, 0.001
"""Least rank correlation that is called one, and probability below which few observers are fewer than by chance."""
FEWEST = 8
"""Draws below which no correlation is reported."""


@dataclass(frozen=True, slots=True)
class Answers:
    """What every plausible observer answers to one row (inf: not felt), which of them satisfy it, and its label.

    `away` is +1 where the nominal prediction is too high, −1 where it is too low, 0 where it holds.
    """

    label: str
    each: tuple[float, ...]
    holds: tuple[bool, ...]
    away: int


@dataclass(frozen=True, slots=True)
class TradeOff:
    """Two rows over the same observers: Spearman's correlation (None: one does not vary), shares that hold.

    `share_both_by_chance` would satisfy both if the two had nothing to do with each other. `both_miss` is said of the
    nominal predictions. `against` is True where both miss and what mends one worsens the other, False where it mends
    both, and None where not both miss or the correlation is weak. `rarer_than_chance`: so few observers satisfy both
    that chance alone would give as few or fewer with a probability below 0.001 (Fisher's exact test, one-sided).
    """

    first: str
    second: str
    correlation: float | None
    share_first_holds: float
    share_second_holds: float
    share_both_hold: float
    share_both_by_chance: float
    both_miss: bool
    against: bool | None
    rarer_than_chance: bool


def trade_offs(rows: Sequence[Answers]) -> tuple[TradeOff, ...]:
    """Every pair of rows, in their order; nothing from fewer than eight observers."""
    from scipy.stats import hypergeom

    found = []
    for first, second in combinations(rows, 2):
        n = len(first.each)
        if n < FEWEST:
            continue
        rho = correlation(first.each, second.each)
        one, other = np.array(first.holds), np.array(second.holds)
        a, b, both = float(one.mean()), float(other.mean()), float((one & other).mean())
        missed = bool(first.away and second.away)
        strong = missed and rho is not None and abs(rho) >= STRONG
        against = first.away * second.away * (rho or 0.0) < 0.0 if strong else None
        rarer = bool(hypergeom.cdf((one & other).sum(), n, one.sum(), other.sum()) < RARE)
        found.append(TradeOff(first.label, second.label, rho, a, b, both, a * b, missed, against, rarer))
    return tuple(found)


def correlation(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Spearman's rank correlation; inf ranks last, None where one of the two does not vary.

    >>> correlation((1.0, 2.0, 4.0), (10.0, 20.0, float("inf")))
    1.0
    """
    from scipy.stats import rankdata

    one, other = rankdata(first), rankdata(second)
    if min(one.std(), other.std()) == 0.0:
        return None
    return round(float(np.corrcoef(one, other)[0, 1]), 12)

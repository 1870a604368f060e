"""Laboratories that the evidence leaves possible, to carry its intervals to predictions: as `rank` draws them.

Experiments that no population was simulated for ask their observers alone.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from ..identification.drawn_laboratories import DrawnLaboratories
from ..observer.channels import USUAL_NORM, Norm
from ..observer.draws import PosteriorDraws
from ..observer.observer import Observer, variant_records
from ..observer.observer_model import ObserverModel
from ..observer.variants import Variable


def plausible_laboratories(n: int, seed: int, norm: Norm, variable: Variable) -> DrawnLaboratories:
    """Laboratories of n draws of the posterior of a variant; a ValueError for fewer than two."""
    if n < 2:
        raise ValueError(f"at least two observers are needed to show an interval, not {n}")
    posterior, records = PosteriorDraws.load(variable=variable), variant_records(variable)
    return DrawnLaboratories.of(replace(ObserverModel.load(), records=records, posterior=posterior), norm, n, seed)


@lru_cache(maxsize=8)
def plausible_observers(
    n: int = 32,
    seed: int = 0,
    norm: Norm = USUAL_NORM,
    *,
    variable: Variable = "temperature",
) -> tuple[Observer, ...]:
    """The observers of these laboratories; the same for the same seed.

    >>> len(plausible_observers(2)), plausible_observers(2) == plausible_observers(2)
    (2, True)
    """
    laboratories = plausible_laboratories(n, seed, norm, variable)
    return tuple(laboratories.at(place, 1)[0] for place in range(n))

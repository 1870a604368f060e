"""Observers that the evidence leaves possible, to carry its intervals to predictions.

Constants are those of draws of the posterior; memory, which no posterior knows of, is drawn from its intervals.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..observer.channels import NORMS
from ..observer.draws import PosteriorDraws
from ..observer.memory_constants import with_memory
from ..observer.observer import Observer, variant_records
from ..observer.variants import Model, Variable
from ..sensation.memory_parameters import memory_parameters
from ..sensation.parameters import latin


@lru_cache(maxsize=8)
def plausible_observers(
    n: int = 32, seed: int = 0, *, variable: Variable = "temperature", model: Model = "adapting"
) -> tuple[Observer, ...]:
    """Observers of n draws of the posterior of a variant; the same for the same seed.

    >>> len(plausible_observers(2)), plausible_observers(2) == plausible_observers(2)
    (2, True)
    """
    if n < 2:
        raise ValueError(f"at least two observers are needed to show an interval, not {n}")
    draws, records = PosteriorDraws.load(variable=variable, model=model), variant_records(variable, model)
    # Evenly spaced draws, begun at another place for another seed: draws stand in the order of the chains.
    first = np.random.default_rng(np.random.SeedSequence([seed, 12])).random() * len(draws) / n
    chosen = (first + np.arange(n) * len(draws) / n).astype(int) % len(draws)
    made = [draws.observer(int(k)) for k in chosen]
    for place, norm in enumerate(NORMS):
        parameters = memory_parameters(norm, records=records)
        shares = latin(len(parameters), n, seed + place)
        for k, row in enumerate(shares.tolist()):
            values = {p.name: p.at(share) for p, share in zip(parameters, row, strict=True)}
            made[k] = with_memory(made[k], values)
    return tuple(made)

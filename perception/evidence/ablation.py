"""What each mechanism is worth: the posterior maximised again without it, alone and together, for every variant.

A difference of log evidence under about 2 says nothing. A mechanism stays if it has a source or a gain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..observer.mechanisms import ALL_OFF, MECHANISMS, Without
from ..observer.variants import VARIABLES, Variable
from .maximum import Maximum, maximise
from .posterior import Posterior

Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, slots=True)
class Ablated:
    """One run: a variant without a mechanism, by `name` (nothing: the whole variant), at its maximum."""

    name: str
    maximum: Maximum

    @property
    def variant(self) -> Variable:
        """Sensory variable."""
        return self.maximum.posterior.variable

    @property
    def squares(self) -> float:
        """Sum of squares of the rows' misses, in their SDs."""
        return float(sum(each**2 for each in self.maximum.missed().values()))

    def __repr__(self) -> str:
        return (
            f"Ablated({self.variant}, without {self.name or 'nothing'}: "
            f"log evidence {self.maximum.log_evidence:.1f}, Σ(miss/SD)² {self.squares:.1f})"
        )


def runs(variants: Sequence[Variable] = VARIABLES) -> Iterator[tuple[Variable, str, Without]]:
    """Every run of an ablation: each variant whole; the first also without each mechanism, and without any of them.

    >>> len(list(runs()))
    17
    """
    for variable in variants:
        yield variable, "", frozenset()
    variable = variants[0]
    for mechanism in MECHANISMS:
        yield variable, mechanism.name, frozenset({mechanism.name})
    yield variable, ALL_OFF, frozenset(mechanism.name for mechanism in MECHANISMS)


def ablate(variants: Sequence[Variable] = VARIABLES, progress: Progress | None = None) -> tuple[Ablated, ...]:
    """Maximise every run, each from the maximum of its whole variant; minutes. `progress` gets (done, all, name)."""
    planned, results = list(runs(variants)), []
    whole: dict[Variable, Maximum] = {}
    for done, (variable, name, without) in enumerate(planned):
        if progress is not None:
            progress(done, len(planned), name or variable)
        posterior = Posterior(variable, without)
        start = None if not without else carried(whole[variable], posterior)
        found = maximise(posterior, start)
        if not without:
            whole[variable] = found
        results.append(Ablated(name, found))
    return tuple(results)


def carried(whole: Maximum, posterior: Posterior) -> Array:
    """A start for another posterior: the constants that it shares with a maximum."""
    known = dict(zip(whole.posterior.priors.names, whole.vector.tolist(), strict=True))
    return np.array([known.get(name, 0.0) for name in posterior.priors.names])

"""Draws from the posterior of all constants: one consistent set of constants each.

Where the evidence does not separate two constants, they trade off from draw to draw. Memory stays that of the shipped
observer, except in draws of one laboratory, whose answers say something of it.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from thermicon.base.files.records import RecordTable
from thermicon.base.numbers.arrays import Array, own_arrays
from thermicon.base.words.near_words import did_you_mean

from .channels import CHANNELS, FORM, MEMORY_FORMS, MemoryForm, Variable, check_variable
from .constants import BETWEEN_LABORATORIES, name_of
from .draws_file import DrawsHeader, read_draws, shipped_file
from .observer import Observer, variant_records

NEGLIGIBLE = 1e-3
"""Spread between laboratories (ln) below which draws are those of one: published ones differ by some tenths."""
FROM_EVIDENCE = "inferred from published evidence"
"""How the source of a record begins whose value a draw replaces."""


@dataclass(frozen=True, slots=True)
class PosteriorDraws:
    """Equally weighted draws: `draws` (n, constants) read-only, in each constant's own unit, columns as in `names`.

    `memory` (n, constants of memory) belongs to `memory_names` and has no columns where memory is not known of. The
    first draw is the nominal one: its constants, and what they predict of the evidence, are nearest to their medians.

    >>> posterior = PosteriorDraws.load()
    >>> bool(posterior.observer(0).limit_C.cold == posterior.values("cold limit")[0])
    True
    """

    header: DrawsHeader
    names: tuple[str, ...]
    draws: Array
    memory_names: tuple[str, ...] = ()
    memory: Array = field(default_factory=lambda: np.empty((0, 0)))

    def __post_init__(self) -> None:
        if not self.memory_names:
            object.__setattr__(self, "memory", np.empty((len(self.draws), 0)))
        own_arrays(self, "draws", "memory")

    @classmethod
    def load(cls, path: Path | str | None = None, *, variable: Variable = "temperature") -> PosteriorDraws:
        """The shipped draws of a variant, or those of another file, which has its own variant.

        Raises `RecordError` for a file that does not fit; warns of draws of a sampler that did not converge.
        """
        file = shipped_file(check_variable(variable)) if path is None else Path(path)
        draws = _read(file, file.stat().st_mtime_ns if file.exists() else 0)
        if not draws.header.converged:
            warnings.warn(f"{file.name}: {draws.header.status}: its intervals are not to be trusted", stacklevel=2)
        return draws

    def __len__(self) -> int:
        return int(self.draws.shape[0])

    @property
    def variable(self) -> Variable:
        """The receptor input."""
        return self.header.variable

    def values(self, name: str) -> Array:
        """One constant in every draw (n,), in its own unit; a ValueError names the nearest."""
        if name not in self.names:
            raise ValueError(f"the posterior has no constant {name!r}: {did_you_mean(name, set(self.names))}")
        return np.asarray(self.draws[:, self.names.index(name)])

    def draw(self, k: int) -> Mapping[str, float]:
        """All constants of one draw by name, offsets of the laboratories of the evidence and own memory included."""
        names, values = (*self.names, *self.memory_names), (*self.draws[k].tolist(), *self.memory[k].tolist())
        return dict(zip(names, values, strict=True))

    @property
    def one_laboratory(self) -> bool:
        """Whether all draws are of one laboratory, so that there is next to no spread between laboratories."""
        return bool(self.values(BETWEEN_LABORATORIES).max() < NEGLIGIBLE)

    @property
    def forms(self) -> tuple[MemoryForm, ...] | None:
        """The form of memory of every draw; None where draws are of new laboratories, which have either.

        Draws that a laboratory kept before it had a form are of `episodes`.
        """
        if FORM in self.memory_names:
            return tuple(MEMORY_FORMS[round(form)] for form in self.memory[:, self.memory_names.index(FORM)].tolist())
        return (MEMORY_FORMS[0],) * len(self) if self.one_laboratory else None

    def interval(self, name: str, share: float = 0.95) -> tuple[float, float, float]:
        """Lower end, median and upper end of the central interval of a constant."""
        low, middle, high = np.quantile(self.values(name), [0.5 - 0.5 * share, 0.5, 0.5 + 0.5 * share]).tolist()
        return low, middle, high

    def table(self, k: int) -> RecordTable:
        """The records of the shipped observer with the constants of one draw of the default variant."""
        values, records = self.draw(k), []
        for record in variant_records():
            name = name_of(record)
            if name in self.memory_names:
                record = replace(record, value=values[name], low=None, high=None)
            elif name in values and record.source.startswith(FROM_EVIDENCE):
                method = f"draw {k} of the posterior"
                record = replace(record, value=values[name], low=None, high=None, method=method)
            records.append(record)
        return RecordTable(f"draw {k}", tuple(records))

    def observer(self, k: int) -> Observer:
        """The observer of one draw."""
        return Observer.from_values(self.draw(k), self.variable)

    def spaced(self, count: int) -> list[int]:
        """Numbers of so many evenly spaced draws."""
        return [round(k) for k in np.linspace(0, len(self) - 1, count).tolist()]

    def new_laboratory(self, seed: int = 0) -> Array:
        """Sensitivity of a new laboratory's people above the usual (ln), (n, 2) for cold and warm in every draw.

        The spread is the draw's own; the same seed gives the same laboratory in standard units.
        """
        standard = np.random.default_rng(seed).standard_normal((len(self), len(CHANNELS)))
        return np.asarray(self.values(BETWEEN_LABORATORIES)[:, None] * standard)

    def __repr__(self) -> str:
        size = f"{len(self)} draws of {len(self.names)} constants"
        return f"PosteriorDraws({size}, {self.variable}; {self.header.status})"


@lru_cache(maxsize=8)
def _read(file: Path, _changed_ns: int) -> PosteriorDraws:
    return PosteriorDraws(*read_draws(file))

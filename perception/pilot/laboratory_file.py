"""A conditioned laboratory as files: a table of draws like the shipped one, and an observer with its memory.

`LAB.csv` has the form of `posterior.csv` and is read by `PosteriorDraws.load` and `Observer.load`. Draws are resampled
by their weights. The offset of the laboratory is part of its thresholds there, so that the spread between laboratories
is next to nothing: the draws are those of this one. Memory has no column in that form; its intervals, narrowed by the
answers, are in `LAB.toml`, which is a whole parameter file for `Observer.load`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.circuit.records import Record, Table, dump_records

from ..arrays import Array
from ..observer.channels import CHANNELS, noise_norm
from ..observer.draws import LABORATORIES, PosteriorDraws
from ..observer.draws_file import to_text
from .states import OFFSETS, Laboratories, LaboratoryPrior

NO_SPREAD = 1e-6
"""Spread between laboratories (ln) in the draws of one: nothing, but for the logarithm that is taken of it."""


def laboratory_draws(
    prior: LaboratoryPrior, some: Laboratories, predicted: Array, note: str, effective: float
) -> PosteriorDraws:
    """Draws of one laboratory, its offset in the thresholds.

    The first is nearest to the medians of constants and of what is `predicted` (laboratories, numbers), of which the
    medians of constants alone may be far. `note` says what they were conditioned on, in the header's line of the
    sampler.
    """
    values = prior.values(some)
    names, own = prior.draws.names, values[:, : len(prior.draws.names)].copy()
    for channel, offset in zip(CHANNELS, OFFSETS, strict=True):
        own[:, names.index(f"{channel} threshold drive")] *= np.exp(-values[:, prior.names.index(offset)])
    own[:, names.index(LABORATORIES)] = NO_SPREAD
    first = int((off_middle(own) + off_middle(predicted)).argmin())
    header = prior.draws.header
    sampler = f"{header.sampler}; {note}"
    order = [first, *(k for k in range(len(own)) if k != first)]
    return PosteriorDraws(replace(header, sampler=sampler, ess=min(header.ess, effective)), names, own[order])


def laboratory_texts(
    prior: LaboratoryPrior, some: Laboratories, draws: PosteriorDraws, version: str, provenance: Sequence[str]
) -> tuple[str, str]:
    """Texts of the parameter file (TOML) and of the table of draws (CSV) of one laboratory."""
    head = (f"Observer of one laboratory, written by thermicon observed ({version}).", *provenance)
    return observer_text(prior, some, draws, head), draws_text(draws, provenance)


def draws_text(draws: PosteriorDraws, lines: Sequence[str]) -> str:
    """The table of draws with further lines of provenance in its header."""
    first, rest = to_text(draws.header, draws.names, draws.draws).split("\n", 1)
    return "\n".join([first, *(f"# {line}" for line in lines), rest])


def observer_text(prior: LaboratoryPrior, some: Laboratories, draws: PosteriorDraws, lines: Sequence[str]) -> str:
    """The parameter file: constants of the first draw with 95 % intervals of all, memory as the answers leave it."""
    values = prior.values(some)
    memory = {parameter.name: values[:, prior.names.index(parameter.name)] for parameter in prior.memory}
    first = {name: draws.draws[:, k] for k, name in enumerate(draws.names)}
    return dump_records(
        Table("laboratory", tuple(_record(record, first, memory, prior) for record in draws.table(0))),
        comment="\n".join(lines),
    )


def _record(record: Record, constants: dict[str, Array], memory: dict[str, Array], prior: LaboratoryPrior) -> Record:
    name = f"{record.channel} {record.quantity}" if record.channel in CHANNELS else record.quantity
    if record.quantity == "memory noise" and record.method == noise_norm(prior.norm):
        name = f"memory noise ({record.method})"
    if name in memory:
        return _narrowed(record, float(np.median(memory[name])), memory[name])
    if name in constants and record.value is not None and record.method.startswith("draw "):
        return _narrowed(record, record.value, constants[name])
    return record


def _narrowed(record: Record, value: float, each: Array) -> Record:
    low, high = np.percentile(each, [2.5, 97.5]).tolist()
    numbers = [float(f"{number:.5g}") for number in (min(low, value), value, max(high, value))]
    return replace(record, low=numbers[0], value=numbers[1], high=numbers[2], method=_method(record), use="calibrate")


def _method(record: Record) -> str:
    """The method of a record is the norm where it is memory's, and must then stay."""
    return record.method if record.quantity.startswith("memory noise") else "conditioned on a laboratory's own answers"


def off_middle(values: Array) -> Array:
    """Mean square (rows,) of how many SDs a row lies from the median of each column.

    >>> int(off_middle(np.array([[0.0], [1.0], [5.0]])).argmin())
    1
    """
    spread = values.std(axis=0)
    off = np.divide(values - np.median(values, axis=0), spread, out=np.zeros_like(values), where=spread > 0.0)
    found: Array = np.square(off).mean(axis=1)
    return found

"""The files of a conditioned laboratory.

`LAB.csv` has the form of `posterior.csv`, with further columns for memory, its form and the spread of pairs among them;
the offset of the laboratory is part of its thresholds. It does not know which pairs the laboratory confuses. `LAB.toml`
is its first draw, which is a laboratory of the sample: the medians belong to none, and may predict something else. A
score scatters by some 2 points with who the people are: the nearest few are asked again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from thermicon.base.files.records import Record, RecordTable, dump_records
from thermicon.base.numbers.arrays import Array

from ..observer.channels import FORM
from ..observer.constants import BETWEEN_LABORATORIES, name_of, names_of
from ..observer.draws import PosteriorDraws
from ..observer.draws_file import as_written, to_text
from ..observer.mechanisms.memory import NOISE
from ..observer.observer import Observer
from .conditioning import Conditioned
from .playing import Stage
from .states import OFFSETS, SEEDS, Laboratories, LaboratoryPrior

NO_SPREAD = 1e-6
"""Spread between laboratories (ln) in the draws of one: nothing, but for the logarithm that is taken of it."""
DATA_LINES = 3
"""Lines of a provenance that say what was conditioned on: file, participants, number of answers or values."""
OF_SOURCE = "R-hat, converged and likelihoods: those of the draws that were resampled"


def laboratory_draws(
    prior: LaboratoryPrior, found: Conditioned, predicted: Array, played: Stage, provenance: Sequence[str], rig: str
) -> PosteriorDraws:
    """Draws of one laboratory, its offset in the thresholds, its memory beside the constants; to the figures of a file.

    The first is in the middle by its constants and by what is `predicted` (laboratories, numbers) of the set that was
    `played` and of what was measured. Of the provenance, the lines on the data are noted.
    """
    some, values = found.after, prior.values(found.after)
    names, own = prior.draws.names, values[:, : len(prior.draws.names)].copy()
    for drive, offset in zip(names_of(Observer, "threshold_drive"), OFFSETS, strict=True):
        own[:, names.index(drive)] *= np.exp(-values[:, prior.names.index(offset)])
    own[:, names.index(BETWEEN_LABORATORIES)] = NO_SPREAD
    parameters = tuple(parameter.name for parameter in prior.memory)
    memory = np.hstack([values[:, [prior.names.index(name) for name in parameters]], some.form[:, None]])
    remembered = (*parameters, FORM)
    header = prior.draws.header
    # Offsets of the laboratories of the evidence say nothing of this one.
    counted = np.hstack([own[:, [k for k, name in enumerate(names) if name not in header.offsets]], memory])
    first = middle_of(some, counted, predicted, played)
    order = [first, *(k for k in range(len(own)) if k != first)]
    distinct = len(np.unique(np.hstack([own, memory]), axis=0))
    times = "1 round" if found.rounds == 1 else f"{found.rounds} rounds"
    how = f"in {times} of fresh laboratories, since weights left {found.effective:.0f} effective of {len(found.before)}"
    if not found.rounds:
        how = f"by weights from {len(found.before)} laboratories, effective sample size {found.effective:.0f}"
    stated = replace(
        header,
        sampler="; ".join((header.sampler, *provenance[:DATA_LINES])),
        ess=min(header.ess, found.effective_after),
        resampled=f"{how}, {distinct} distinct rows of {len(own)}",
        rig=rig,
    )
    return PosteriorDraws(stated, names, as_written(own[order]), remembered, as_written(memory[order]))


def laboratory_texts(draws: PosteriorDraws, version: str, provenance: Sequence[str]) -> tuple[str, str]:
    """Texts of the parameter file (TOML; the first draw, 95 % intervals of all) and of the table of draws (CSV)."""
    columns, values = (*draws.names, *draws.memory_names), np.hstack([draws.draws, draws.memory])
    each = dict(zip(columns, values.T, strict=True))
    records = tuple(_narrowed(record, each, draws.memory_names) for record in draws.table(0))
    head = (f"Observer of one laboratory, written by thermicon pilot ({version}).", *provenance)
    first, rest = to_text(draws.header, columns, values).split("\n", 1)
    table = "\n".join([first, *(f"# {line}" for line in (*provenance, OF_SOURCE)), rest])
    return dump_records(RecordTable("laboratory", records), comment="\n".join(head)), table


def _narrowed(record: Record, each: Mapping[str, Array], remembered: Sequence[str]) -> Record:
    """A record with the interval of the draws, where they have its constant."""
    name = name_of(record)
    if name not in each or record.value is None or not (name in remembered or record.method.startswith("draw ")):
        return record
    low, high = (float(f"{number:.5g}") for number in np.percentile(each[name], [2.5, 97.5]).tolist())
    # The method of a record is the form of memory where it is one of memory, and must then stay.
    method = record.method if name == NOISE else "conditioned on a laboratory's own answers"
    low, high = min(low, record.value), max(high, record.value)
    return replace(record, low=low, high=high, method=method, use="calibrate")


NEAREST, AGAIN = 6, 8
"""How many laboratories are asked again, and how often: the score of each is then known to within a point."""


def middle_of(some: Laboratories, constants: Array, predicted: Array, played: Stage) -> int:
    """Number of the laboratory whose constants are near their medians, and what it predicts near the means.

    The first column of `predicted` is the share felt and named; for it the nearest are asked the set once more.
    """
    each = np.column_stack([some.place, some.form])
    _, first, group, times = np.unique(each, axis=0, return_index=True, return_inverse=True, return_counts=True)
    # Resampled more than once, a laboratory has been asked with several groups of people.
    means = np.zeros((len(first), predicted.shape[1]))
    np.add.at(means, group.reshape(-1), predicted / times[group.reshape(-1), None])
    spread = predicted.std(axis=0)
    off = np.divide(means - predicted.mean(axis=0), spread, out=np.zeros_like(means), where=spread > 0.0)
    distance = off_middle(constants)[first] + np.square(off).mean(axis=1) + np.square(off[:, 0])
    near = np.argsort(distance, kind="stable")[:NEAREST]
    chosen = first[near]
    rng = np.random.default_rng(np.random.SeedSequence([0, 41]))
    asked = np.repeat(chosen, AGAIN)
    # Each has people of its own: one group for all would shift the score of whichever is chosen.
    again = replace(some.of(asked), seed=rng.integers(SEEDS, size=len(asked)))
    scores = played.confusions(again).felt_and_named.reshape(len(chosen), AGAIN).sum(axis=1)
    scores = (scores + means[near, 0] * times[near]) / (AGAIN + times[near])
    return int(chosen[np.abs(scores - predicted[:, 0].mean()).argmin()])


def off_middle(values: Array) -> Array:
    """The same of each column in logarithms, where it has them."""
    positive = (values > 0.0).all(axis=0)
    return off_centre(np.where(positive, np.log(np.where(positive, values, 1.0)), values))


def off_centre(values: Array) -> Array:
    """Mean square (rows,) of how many SDs a row lies from the median of each column."""
    spread = values.std(axis=0)
    off = np.divide(values - np.median(values, axis=0), spread, out=np.zeros_like(values), where=spread > 0.0)
    return np.asarray(np.square(off).mean(axis=1))

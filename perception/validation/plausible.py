"""Observers that the data and the assumptions leave possible, to carry their intervals to predictions.

Every constant that has an interval is drawn from it, half of the draws below its value and half above, and every
interval is filled evenly. Threshold drives follow, so that published thresholds stay where they are.
Unlike `parameters`, which varies one nominal person for a ranking, this serves every variant, and
takes in what differs between people as well, since a published mean is one of few people.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from thermicon.circuit.records import Record, Table

from ..observer.observer import Observer, variant_records
from ..observer.variants import Model, Variable
from ..sensation.fits import anchored
from ..sensation.parameters import ANCHORED, latin


def uncertain_records(variable: Variable = "temperature", model: Model = "adapting") -> tuple[Record, ...]:
    """Every record with an interval that draws are made from, for one variant: what changes its observer.

    >>> {record.use for record in uncertain_records()} == {"assumed", "calibrate"}
    True
    """
    table = variant_records(variable, model)
    whole = Observer.from_table(table, variable=variable, model=model)

    def matters(record: Record) -> bool:
        low, high = record.interval
        if record.value is None or low == high or record.quantity.startswith(ANCHORED):
            return False
        moved = _swapped(table, {record: low if low != record.central else high})
        return Observer.from_table(moved, variable=variable, model=model) != whole

    return tuple(record for record in table if matters(record))


@lru_cache(maxsize=8)
def plausible_observers(
    n: int = 32, seed: int = 0, *, variable: Variable = "temperature", model: Model = "adapting"
) -> tuple[Observer, ...]:
    """Observers of one variant, n of them drawn from the intervals of its constants; the same for the same seed.

    >>> len(plausible_observers(2)), plausible_observers(2) == plausible_observers(2)
    (2, True)
    """
    if n < 2:
        raise ValueError(f"at least two observers are needed to show an interval, not {n}")
    table, records = variant_records(variable, model), uncertain_records(variable, model)
    shipped = Observer.load(variable=variable, model=model)
    made = []
    for row in latin(len(records), n, seed).tolist():
        drawn = {record: _within(record, share) for record, share in zip(records, row, strict=True)}
        person = Observer.from_table(_swapped(table, drawn), variable=variable, model=model)
        made.append(anchored(person, shipped))
    return tuple(made)


def _within(record: Record, share: float) -> float:
    low, high = record.interval
    return float(np.interp(share, [0.0, 0.5, 1.0], [low, record.central, high]))


def _swapped(table: Table, drawn: dict[Record, float]) -> Table:
    return Table(table.name, tuple(replace(r, value=drawn[r], low=None, high=None) if r in drawn else r for r in table))

"""Observers that the data and the assumptions leave possible, to carry their intervals to predictions.

Every constant that has an interval is drawn from it, half of the draws below its value and half
above, and every interval is filled evenly. What was calibrated through others is calibrated again
for each draw: the criterion from its false alarms, the drive of a threshold step from that step.
Unlike `parameters`, which varies one nominal person for a ranking, this serves every variant, and
takes in what differs between people as well, since a published mean is one of few people.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from thermicon.circuit.records import Record, Table, load_records

from ..observer.observer import DATA, Observer, load_thresholds
from ..observer.variants import Model, Variable, source_of
from ..sensation.detection import criterion_of
from ..sensation.fits import with_unit_drives
from ..sensation.parameters import latin

SHARED = (
    "integration time constant",
    "slow adaptation time constant",
    "fast adaptation time constant",
    "fast adaptation weight",
    "gain control time constant",
    "gain control scale",
    "area exponent",
    "reference area",
    "noise correlation time",
    "conduction velocity",
    "path length to the cord",
    "decision time",
    "onset uncertainty",
    "lapse rate",
    "slope of sensation",
)
OWN = ("gain control strength", "memory noise")
STEP = ("rate of the threshold step", "duration of the threshold step")
ALARMS = "false-alarm rate of a cautious criterion"


def uncertain_records(variable: Variable = "temperature", model: Model = "adapting") -> tuple[Record, ...]:
    """Every record with an interval that draws are made from, for one variant.

    >>> {record.use for record in uncertain_records()} == {"assumed", "calibrate"}
    True
    """
    table, known, variant = load_records(DATA / "observer.toml"), load_thresholds(), source_of(variable, model)
    own = OWN if model == "adapting" else OWN[1:]
    names = (*SHARED, *(f"{name}{variant}" for name in own))
    found = [r for r in table if r.quantity in names]
    found += [r for r in known if r.quantity in (*STEP, ALARMS)]
    return tuple(r for r in found if r.interval[0] < r.interval[1])


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
    table, known = load_records(DATA / "observer.toml"), load_thresholds()
    records = uncertain_records(variable, model)
    shares = latin(len(records), n, seed)
    made = []
    for row in shares.tolist():
        drawn = {record: _within(record, share) for record, share in zip(records, row, strict=True)}
        own, others = _swapped(table, drawn), _swapped(known, drawn)
        person = Observer.from_table(own, variable=variable, model=model)
        wait = known.one("wait of a cautious observer").central
        criterion = criterion_of(others.one(ALARMS).central, person.noise_correlation_s, wait)
        made.append(with_unit_drives(others, replace(person, criterion=criterion)))
    return tuple(made)


def _within(record: Record, share: float) -> float:
    low, high = record.interval
    return float(np.interp(share, [0.0, 0.5, 1.0], [low, record.central, high]))


def _swapped(table: Table, drawn: dict[Record, float]) -> Table:
    return Table(table.name, tuple(replace(r, value=drawn[r], low=None, high=None) if r in drawn else r for r in table))

"""The observer's parameters as intervals.

A parameter is a record of `data/observer.toml` whose interval has two different ends. What is drawn
per person (path, decision, lapse) belongs to the spread between people and is left alone here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from thermicon.circuit.records import Record, Table

from ..arrays import Array
from ..observer.channels import USUAL_NORM
from ..observer.memory import MEMORY_NAMES
from ..observer.observer import CHANNELS, NORMS, Norm, Observer, on_forearm, variant_records

PER_PERSON = ("path length to the cord", "decision time", "lapse rate")
ANCHORED = "threshold drive"
NAMED = ("rating at threshold", "cost of a missing episode")
"""Constants that the norm `naming` alone makes use of."""
LOG_FROM = 1.5
"""An interval whose ends are in a larger ratio than this is drawn in its logarithm."""


@dataclass(frozen=True, slots=True)
class ObserverParameter:
    """One number of the chain that may lie anywhere between `low` and `high`, and where it comes from.

    `use` is the record's: `assumed` has no data behind it.
    """

    name: str
    low: float
    value: float
    high: float
    unit: str
    source: str
    use: str

    def __post_init__(self) -> None:
        if not self.low < self.high or not self.low <= self.value <= self.high:
            raise ValueError(
                f"{self.name}: {self.low:g}, {self.value:g}, {self.high:g} is not an interval about a value"
            )

    def at(self, share: float) -> float:
        """The value at a share (0–1) of the interval.

        >>> ObserverParameter("time", 1.0, 2.0, 4.0, "s", "assumed", "assumed").at(0.5)
        2.0
        """
        if self.low > 0.0 and self.high / self.low > LOG_FROM:
            return self.low * math.pow(self.high / self.low, share)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """The share of the interval at which a value lies, as `at` takes it.

        >>> ObserverParameter("time", 1.0, 2.0, 4.0, "s", "assumed", "assumed").share(2.0)
        0.5
        """
        if self.low > 0.0 and self.high / self.low > LOG_FROM:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def __repr__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"ObserverParameter({self.name}: {self.value:g} [{self.low:g}, {self.high:g}]{unit}; {self.source})"


def observer_parameters(
    norm: Norm = USUAL_NORM, site: str = "thenar", records: Table | None = None
) -> tuple[ObserverParameter, ...]:
    """Parameters of an observer (None: the shipped one) that are uncertain and matter for a norm and a site."""
    known = variant_records() if records is None else records
    whole = _at_site(known, site)
    return tuple(_parameter(record) for record in known if _free(record, norm, site, known, whole))


def latin(parameters: int, draws: int, seed: int) -> Array:
    """Shares of shape (draws, parameters) in 0–1, one in each of `draws` equal strata of every parameter.

    >>> bool((np.sort((latin(2, 4, seed=0) * 4).astype(int), axis=0) == np.arange(4)[:, None]).all())
    True
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    strata = (
        np.stack([rng.permutation(draws) for _ in range(parameters)], axis=-1) if parameters else np.empty((draws, 0))
    )
    shares: Array = (strata + rng.random(strata.shape)) / draws
    return shares


def parameter_name(record: Record) -> str:
    """Name of a parameter: its quantity, with the channel where each has its own, the site or the method.

    >>> parameter_name(Record("memory noise", "log units", "a task", value=0.3, channel="both", method="episodes"))
    'memory noise (episodes)'
    """
    method = record.method if record.method in NORMS else ""
    place = record.site if record.quantity == "path length to the cord" else ""
    channel = record.channel if record.channel in CHANNELS else ""
    said = ", ".join(part for part in (channel, place, method) if part)
    return f"{record.quantity} ({said})" if said else record.quantity


def _free(record: Record, norm: Norm, site: str, known: Table, whole: Observer) -> bool:
    """Whether a record is an uncertain number that `whole`, judged by this norm at this site, makes use of."""
    low, high = record.interval
    if record.value is None or low == high or record.quantity in PER_PERSON or record.quantity.startswith(ANCHORED):
        return False
    if record.quantity in NAMED and norm != "naming":
        return False
    moved = Table(known.name, tuple(replace(r, value=low) if r is record else r for r in known))
    return low != record.value and _at_site(moved, site) != whole


def _at_site(known: Table, site: str) -> Observer:
    """The observer without what only other sites make use of."""
    observer = Observer.from_table(known)
    if on_forearm(site):
        return observer
    cold, warm = (replace(observer.receptor(channel), forearm_factor=1.0) for channel in CHANNELS)
    return replace(observer, cold=cold, warm=warm)


def _parameter(record: Record) -> ObserverParameter:
    low, high = record.interval
    return ObserverParameter(parameter_name(record), low, record.central, high, record.unit, record.source, record.use)


def memory_parameters(norm: Norm, site: str = "thenar", records: Table | None = None) -> tuple[ObserverParameter, ...]:
    """The uncertain constants of memory that a norm makes use of, by the records of an observer (None: the shipped).

    >>> [parameter.name for parameter in memory_parameters("episodes")]
    ['share of the scatter of ratings', 'bar of an episode', 'memory noise (episodes)']
    """
    return tuple(parameter for parameter in observer_parameters(norm, site, records) if parameter.name in MEMORY_NAMES)

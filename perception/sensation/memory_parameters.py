"""Constants of memory that no published posterior knows of, and their intervals."""

from __future__ import annotations

from thermicon.circuit.records import Table

from ..observer.channels import Norm
from ..observer.memory_constants import MEMORY_NAMES
from .parameters import ObserverParameter, observer_parameters


def memory_parameters(norm: Norm, site: str = "thenar", records: Table | None = None) -> tuple[ObserverParameter, ...]:
    """The uncertain constants of memory that a norm makes use of, by the records of an observer (None: the shipped).

    >>> [parameter.name for parameter in memory_parameters("episodes")]
    ['share of the scatter of ratings', 'bar of an episode', 'memory noise (episodes)']
    """
    return tuple(parameter for parameter in observer_parameters(norm, site, records) if parameter.name in MEMORY_NAMES)

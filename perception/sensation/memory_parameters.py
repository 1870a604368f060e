"""Constants of memory that no posterior knows of: their intervals, and observers with other values of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from thermicon.circuit.records import Table

from ..observer.channels import Norm, noise_norm, trace_norm
from ..observer.observer import Observer
from .parameters import ObserverParameter, observer_parameters

OF_EPISODES = ("share of the scatter of ratings", "cost of a missing episode")
ONSET = "onset uncertainty"


def memory_parameters(norm: Norm, site: str = "thenar", records: Table | None = None) -> tuple[ObserverParameter, ...]:
    """The uncertain constants of memory that a norm makes use of, by the records of an observer (None: the shipped).

    >>> [parameter.name for parameter in memory_parameters("episodes")]
    ['share of the scatter of ratings', 'memory noise (episodes)']
    """
    names = {*OF_EPISODES, ONSET, f"memory noise ({noise_norm(norm)})"}
    return tuple(parameter for parameter in observer_parameters(norm, site, records) if parameter.name in names)


def with_memory(observer: Observer, values: Mapping[str, float], norm: Norm) -> Observer:
    """The observer with other constants of memory, by the names of `memory_parameters`."""
    noise = values.get(f"memory noise ({noise_norm(norm)})")
    trace = trace_norm(norm)
    changes: dict[str, Any] = {}
    if ONSET in values:
        changes["onset_uncertainty_s"] = values[ONSET]
    if trace is not None and noise is not None:
        changes[f"memory_{trace}"] = noise
    if trace is None:
        own = observer.memory
        changes["memory"] = replace(
            own,
            timing=own.timing if noise is None else noise,
            share=values.get("share of the scatter of ratings", own.share),
            missing=values.get("cost of a missing episode", own.missing),
        )
    return replace(observer, **changes)

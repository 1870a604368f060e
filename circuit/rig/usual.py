"""Possible values of a rig that are so unusual that their unit may have been mistaken."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from thermicon.base.files.inputs import shipped_table

from .faults import Unusual, unit_of, unusual

USUAL_VALUES = "usual-rig-values.toml"


def usual_values(of: str = "keys") -> Mapping[str, tuple[float, float, str]]:
    """For each key of `rig_keys`, and some of one layer alone, the low and high end of its usual values, and why.

    ``of="layout"``: for the numbers of a layout file.

    >>> low, high, source = usual_values()["contact.area_cm2"]
    >>> low < 9.0 < high, source.partition(":")[0]
    (True, 'chosen by this project')
    """
    table: dict[str, tuple[float, float, str]] = shipped_table(USUAL_VALUES)[of]
    return table


def unusual_values(document: Mapping[str, Any], of: str = "keys") -> Iterator[Unusual]:
    """Say which numbers of a rig's document (or a `layout`) are not usual, and the unit in which they would be."""
    usual = usual_values(of)
    for key, value, layer in _numbers(document):
        unit, name = unit_of(key), f"{key} of the {layer}" if layer else key
        general = re.sub(r"\.\d+\.", ".0.", key)
        low, high, _ = usual.get(f"{general} of the {layer}", usual.get(general, (value, value, "")))
        if not low <= value <= high:
            cure = _likely(value, unit, low, high) or "check its unit"
            yield unusual("slip", key=name, value=value, unit=unit, low=low, high=high, cure=cure)


def _numbers(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, float, str]]:
    """Each dotted key that holds a number, the number, and the layer of skin that it belongs to."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _numbers(value, f"{prefix}{name}.")
        elif isinstance(value, int | float):
            yield f"{prefix}{name}", value, str(table.get("name", "")) if prefix.startswith("skin.layer.") else ""
        elif isinstance(value, list | tuple):
            for place, each in enumerate(value):
                if isinstance(each, Mapping):
                    yield from _numbers(each, f"{prefix}{name}.{place}.")


def likely_unit(key: str, value: float, of: str = "keys") -> str:
    """The other unit in which an impossible value of a rig's key (or a `layout`'s) would be usual; empty for none.

    >>> likely_unit("skin.rest_C", 89.6), likely_unit("skin.rest_C", 45.5)
    ('89.6 looks like °F, 32 °C', '')
    """
    low, high, _ = usual_values(of).get(re.sub(r"\.\d+\.", ".0.", key), (value, value, ""))
    return "" if low <= value <= high else _likely(value, unit_of(key), low, high)


def _likely(value: float, unit: str, low: float, high: float) -> str:
    """The first other unit in which a value is usual, in words; empty where there is none."""
    for other, (zero, size) in shipped_table(USUAL_VALUES)["units"].get(unit, {}).items():
        ours = size * (value - zero)
        if low <= ours <= high:
            return f"{value:.4g} looks like {other}, {ours:.4g} {unit}"
    return ""

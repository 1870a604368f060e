"""What ``thermicon sweep --measure`` prints where no table is written: what people perceive at every value."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.perception.ranking.swept import ALL, MEASURES, OF_THE_SET

from .blocks import Grid, grid

if TYPE_CHECKING:
    import pandas as pd

PRINTED: Mapping[str, tuple[float, str, str]] = {
    "correct": (100.0, ".0f", " %"),
    "correct_95": (100.0, ".0f", " %"),
    "detected": (100.0, ".0f", " %"),
    "onset": (1.0, ".2f", " s"),
    "d_prime": (1.0, ".1f", ""),
    "bits": (1.0, ".2f", " bits"),
}
"""By quantity: factor, format and unit in print; d′ is that of the nearest other icon."""


def sweep_report(frame: pd.DataFrame, keys: Sequence[str], quantities: Sequence[str]) -> list[Grid]:
    """Report one row per icon and value: each quantity with its 95 % interval for a new laboratory, where it has one.

    >>> import pandas as pd
    >>> row = {"icon": "dip", "contact.area_cm2": 4.0, "correct": 0.82, "correct_low": 0.7, "correct_high": 0.91}
    >>> [cell.text for cell in sweep_report(pd.DataFrame([row]), ["contact.area_cm2"], ["correct"])[0].rows[0]]
    ['dip', '4', '82 % (70–91)']
    """
    of_icons = not {*quantities} <= {*OF_THE_SET}
    rows = []
    for row in frame.to_dict("records"):
        if of_icons or row["icon"] == ALL:
            settings = [row[key] if isinstance(row[key], str) else f"{row[key]:g}" for key in keys]
            rows.append((str(row["icon"]), *settings, *(_cell(row, quantity) for quantity in quantities)))
    columns = ("icon", *keys, *quantities)
    return [grid(columns, rows, keys, columns)]


def _cell(row: Mapping[Any, Any], quantity: str) -> str:
    factor, digits, unit = PRINTED[quantity]
    value, *interval = (float(row.get(name, math.nan)) * factor for name in MEASURES[quantity])
    if math.isnan(value):
        return "–"
    said = f"{value:{digits}}{unit}"
    return (
        said
        if not interval or any(map(math.isnan, interval))
        else f"{said} ({interval[0]:{digits}}–{interval[1]:{digits}})"
    )

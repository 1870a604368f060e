"""What ``thermicon sweep --measure`` prints where no table is written: what people perceive at every value."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from thermicon.perception.ranking.swept import ALL, MEASURES, OF_THE_SET

from .tables import table

if TYPE_CHECKING:
    import pandas as pd
    from rich.table import Table

PRINTED: Mapping[str, tuple[float, str, str]] = {
    "correct": (100.0, ".0f", " %"),
    "correct_95": (100.0, ".0f", " %"),
    "detected": (100.0, ".0f", " %"),
    "onset": (1.0, ".2f", " s"),
    "d_prime": (1.0, ".1f", ""),
    "bits": (1.0, ".2f", " bits"),
}
"""By quantity: factor, format and unit in print; d′ is that of the nearest other icon."""


def swept_table(frame: pd.DataFrame, keys: Sequence[str], quantities: Sequence[str]) -> Table:
    """One row per icon and value: each quantity with its 95 % interval for a new laboratory, where it has one.

    >>> import pandas as pd
    >>> row = {"icon": "dip", "contact.area_cm2": 4.0, "correct": 0.82, "correct_low": 0.7, "correct_high": 0.91}
    >>> made = swept_table(pd.DataFrame([row]), ["contact.area_cm2"], ["correct"])
    >>> [next(iter(column.cells)) for column in made.columns]
    ['dip', '4', '82 % (70–91)']
    """
    printed = table("icon", *keys, *quantities, numbers=keys, names=("icon", *keys, *quantities))
    of_icons = not {*quantities} <= {*OF_THE_SET}
    for row in frame.to_dict("records"):
        if not of_icons and row["icon"] != ALL:
            continue
        settings = [row[key] if isinstance(row[key], str) else f"{row[key]:g}" for key in keys]
        printed.add_row(str(row["icon"]), *settings, *(_cell(row, quantity) for quantity in quantities))
    return printed


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

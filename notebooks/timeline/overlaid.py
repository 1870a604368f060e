"""Curves of several drawings over each other on one clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .frames import CanvasFrame

Style = tuple[list[int], float]
STYLES: tuple[Style, ...] = (([], 1.75), ([7, 3], 1.75))
"""Dashes and width of the first curve and the second, which are told apart by them in grey too."""


def series_of(key: str, label: str, values: Any, role: str, style: Style, buffers: list[Any]) -> dict[str, Any]:
    """Take the values of a curve into ``buffers``, and return the series that stands for it.

    >>> series_of("a", "A", [1.0], "ink", STYLES[0], [])["buffer"]
    0
    """
    buffers.append(values)
    return {
        "key": key,
        "label": label,
        "buffer": len(buffers) - 1,
        "role": role,
        "dash": style[0],
        "width": style[1],
        "step": False,
    }


def values_on(part: CanvasFrame, panel: str, key: str, clock: Any) -> Any:
    """The values of a curve of the design view on another clock; NaN behind its end, None where there is no such."""
    for each in part.meta["panels"]:
        for series in each["series"]:
            if each["key"] == panel and series["key"] == key:
                own = part.meta["time"]["dt"] * np.arange(part.meta["time"]["n"])
                return np.interp(clock, own, part.buffers[series["buffer"]], right=np.nan).astype(np.float32)
    return None

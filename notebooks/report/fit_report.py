"""The report of ``thermicon fit``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import signed

from .blocks import Block, Grid, Text, grid

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.circuit.fitting.rig_fit import RigFit
    from thermicon.circuit.fitting.synthetic_log import Forecast

PLAN_HEAD = (
    "Half widths of the 95 % intervals to expect from one log of the shipped calibration drive, with 10 independent "
    "readings per second and noise of 20 mK and 5 mV. Logged are D the display, V the module's voltage, H the hot "
    "plate, S the skin; in brackets what is not better than assumed."
)
LETTERS = {"display_C": "D", "voltage_V": "V", "hot_plate_C": "H", "skin_C": "S"}
USUAL_DIGITS, MOST_DIGITS = 4, 7
CLOSE = 0.9
"""Correlations from here on are printed."""


def fit_report(fitted: RigFit, before: Rig) -> list[Block]:
    """Report parameters, residuals, what was not identified, and the uncertainty that the rig gets."""
    uncertain = uncertainty_line(fitted, before)
    said = [Text(line) for line in (*doubts(fitted), *([uncertain] if uncertain else []))]
    return [parameter_table(fitted), residual_table(fitted), *said]


def plan_report(expected: Sequence[Forecast]) -> list[Block]:
    """Report how well each choice of sensors will identify the keys: a row per key, a column per choice."""
    from thermicon.circuit.fitting.identify import width_text
    from thermicon.circuit.rig.faults import unit_of

    choices, rows = [" ".join(LETTERS[column] for column in each.columns) for each in expected], []
    for k, key in enumerate(expected[0].keys):
        texts = [width_text(key.log, each.half_widths[k], unit_of(key.key)) for each in expected]
        known = [each.identified[k] for each in expected]
        rows.append((key.key, *(text if sure else f"({text})" for text, sure in zip(texts, known, strict=True))))
    return [Text(PLAN_HEAD), grid(("key", *choices), rows, choices, ("key",))]


def parameter_table(fitted: RigFit) -> Grid:
    """Parameters with fitted value and interval, neither where the logs do not tell; the unit ends the key."""
    rows = []
    for item in fitted.parameters:
        if not item.identified:
            rows.append((item.key, "–", "not known", "unknown"))
            continue
        digits = _digits(item.value, 0.5 * (item.high - item.low))
        ends = f"{_short(item.low, digits)} to {_short(item.high, digits)}"
        rows.append((item.key, _short(item.value, digits), ends, item.interval.removeprefix("±")))
    return grid(("key", "fitted", "95 % interval", "±"), rows, ("fitted", "±"), ("key",))


def residual_table(fitted: RigFit) -> Grid:
    """Every measured column: rms, largest residual and its time, and the sensor's offset."""
    from thermicon.circuit.fitting.notes import milli

    rows = []
    for each in fitted.channels:
        words = each.column.rpartition("_")[0].replace("_", " ")
        sizes = [milli(value, each.unit) for value in (each.rms, each.largest)]
        offset = f"{signed(each.offset_K, '.3f')} K" if each.unit == "K" else "–"
        rows.append((f"{words} ({each.file})", *sizes, f"{each.largest_s:.1f} s", offset))
    numbers = ("rms", "largest", "at", "offset")
    return grid(("measured − fitted", *numbers), rows, numbers)


def doubts(fitted: RigFit) -> list[str]:
    """Keys that were not identified with the cure, and pairs that the logs hardly separate."""
    by_cure: dict[str, list[str]] = {}
    for item in fitted.unidentified:
        by_cure.setdefault(item.cure, []).append(item.key)
    lines = [f"not identified: {', '.join(keys)}; {cure}" for cure, keys in by_cure.items()]
    keys = [item.key for item in fitted.parameters]
    pairs = [
        f"{keys[a]} and {keys[b]} ({signed(float(fitted.correlation[a, b]), '.2f')})"
        for a, b in combinations(range(len(keys)), 2)
        if abs(fitted.correlation[a, b]) > CLOSE
    ]
    return [*lines, *([f"strongly correlated: {', '.join(pairs)}"] if pairs else [])]


def uncertainty_line(fitted: RigFit, before: Rig) -> str | None:
    """The spreads that the safety gate and virtual people use from now on, where they have changed."""
    from thermicon.circuit.rig.uncertainty import WORDS

    changed = [
        f"{words} ±{scale * getattr(fitted.rig.uncertainty, key):g} {unit} (was ±"
        f"{scale * getattr(before.uncertainty, key):g} {unit})"
        for key, (words, _, scale, unit) in WORDS.items()
        if getattr(fitted.rig.uncertainty, key) != getattr(before.uncertainty, key)
    ]
    if not changed:
        return None
    if all(getattr(fitted.rig.uncertainty, key) >= getattr(before.uncertainty, key) for key in WORDS):
        return f"uncertainty of the fitted rig, widened: {', '.join(changed)}"
    return (
        f"uncertainty of the fitted rig, for the person, contact and room of these logs, and sensors that are off by "
        f"{fitted.offset_sd_K:g} K (SD; --offset K): {', '.join(changed)}; "
        "widen it with --set uncertainty.KEY=VALUE for other people"
    )


def _short(value: float, digits: int) -> str:
    return signed(value, f"#.{digits}g").removesuffix(".")


def _digits(value: float, half: float) -> int:
    """Significant digits that show half an interval, at least the usual number."""
    if not value or not half > 0.0:
        return USUAL_DIGITS
    places = math.floor(math.log10(abs(value))) - math.floor(math.log10(half)) + 1
    return min(max(places, USUAL_DIGITS), MOST_DIGITS)

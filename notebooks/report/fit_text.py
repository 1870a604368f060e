"""What ``thermicon fit`` prints: parameters, residuals, doubts, and the table of a plan."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from .tables import table

if TYPE_CHECKING:
    from rich.table import Table

    from thermicon.circuit import Rig
    from thermicon.circuit.fitting.laboratory import Expected
    from thermicon.circuit.fitting.rig_fit import RigFit

PLAN_HEAD = (
    "Half widths of the 95 % intervals to expect from one log of the shipped calibration drive, with 10 independent "
    "readings per second and noise of 20 mK and 5 mV. Logged are D the display, V the module's voltage, H the hot "
    "plate, S the skin; in brackets what is no better than assumed anyway."
)
LETTERS = {"display_C": "D", "voltage_V": "V", "hot_plate_C": "H", "skin_C": "S"}
USUAL_DIGITS, MOST_DIGITS = 4, 7
CLOSE = 0.9
"""Correlations from here on are printed."""


def parameter_table(fitted: RigFit) -> Table:
    """Parameters with fitted value and interval, neither where the logs do not tell; the unit ends the key."""
    rows = table("key", "fitted", "95 % interval", "±", numbers=("fitted", "±"), names=("key",))
    for item in fitted.parameters:
        if not item.identified:
            rows.add_row(item.key, "–", "not known", "unknown")
            continue
        digits = _digits(item.value, 0.5 * (item.high - item.low))
        ends = f"{_short(item.low, digits)} to {_short(item.high, digits)}"
        rows.add_row(item.key, _short(item.value, digits), ends, item.interval.removeprefix("±"))
    return rows


def residual_table(fitted: RigFit) -> Table:
    """Every measured column: rms, largest residual and its time, and the sensor's offset."""
    from thermicon.circuit.fitting.left_out import milli

    rows = table("measured − fitted", "rms", "largest", "at", "offset", numbers=("rms", "largest", "at", "offset"))
    for each in fitted.channels:
        words = each.column.rpartition("_")[0].replace("_", " ")
        offset = f"{_signed(each.offset_K, 3)} K" if each.unit == "K" else "–"
        rows.add_row(
            f"{words} ({each.file})", milli(each.rms, each.unit), milli(each.largest, each.unit),
            f"{each.largest_s:.1f} s", offset,
        )  # fmt: skip
    return rows


def doubts(fitted: RigFit) -> list[str]:
    """Contact and layer in series, what was not identified with the cure, and pairs that the logs hardly separate."""
    both = fitted.series
    series = [] if both is None else [
        f"{both.words}: {_short(both.value, None)} {both.unit} {both.interval} together, which is what a log of the "
        f"display alone tells; how much of it is contact rests on the spread of the layer between people"
    ]  # fmt: skip
    lines = [f"not identified: {item.key}; {item.cure}" for item in fitted.unidentified]
    keys = [item.key for item in fitted.parameters]
    pairs = [
        f"{keys[a]} and {keys[b]} ({_signed(float(fitted.correlation[a, b]), 2)})"
        for a in range(len(keys))
        for b in range(a + 1, len(keys))
        if abs(fitted.correlation[a, b]) > CLOSE
    ]
    return [*series, *lines, *([f"strongly correlated: {', '.join(pairs)}"] if pairs else [])]


def uncertainty_line(fitted: RigFit, before: Rig) -> str | None:
    """What the safety gate and virtual people vary from now on, where it is not what it was before."""
    from thermicon.circuit.fitting.rig_file import LARGEST
    from thermicon.circuit.rig.uncertainty import WORDS

    changed = [
        f"{words} ±{scale * getattr(fitted.rig.uncertainty, key):g} {unit} (was ±"
        f"{scale * getattr(before.uncertainty, key):g} {unit})"
        for key, (words, _, scale, unit) in WORDS.items()
        if getattr(fitted.rig.uncertainty, key) != getattr(before.uncertainty, key)
    ]
    if not changed:
        return None
    if fitted.misfit:
        most = any(getattr(fitted.rig.uncertainty, key) == limit for key, limit in LARGEST.items())
        how = "as far as a rig file may state" if most else "to hold all that the rig before held"
        return f"uncertainty of the fitted rig, widened {how}: {', '.join(changed)}"
    return (
        f"uncertainty of the fitted rig, for the person, contact and room of these logs: {', '.join(changed)}; widen "
        f"it with --set uncertainty.KEY=VALUE for other people"
    )


def plan_table(expected: Sequence[Expected]) -> Table:
    """A row per key, a column per choice of sensors."""
    choices = [" ".join(LETTERS[column] for column in each.columns) for each in expected]
    rows = table("key", *choices, numbers=choices, names=("key",))
    for place, key in enumerate(expected[0].keys):
        widths = [_width(each.half_widths[place], key.log, each.identified[place], key.key) for each in expected]
        rows.add_row(key.key, *widths)
    return rows


def _width(width: float, log: bool, known: bool, key: str) -> str:
    if log:
        text = f"±{100 * width:.2g} %" if width < 1.0 else "unknown"
    else:
        text = f"±{width:.2g} {'s' if key.endswith('_s') else 'K'}"
    return text if known else f"({text})"


def _short(value: float, digits: int | None) -> str:
    text = f"{value:.{USUAL_DIGITS}g}" if digits is None else f"{value:#.{digits}g}"
    return text.replace("-", "−").removesuffix(".")


def _digits(value: float, half: float) -> int:
    """Significant digits that show half an interval, at least the usual number."""
    if not value or not half > 0.0:
        return USUAL_DIGITS
    places = math.floor(math.log10(abs(value))) - math.floor(math.log10(half)) + 1
    return min(max(places, USUAL_DIGITS), MOST_DIGITS)


def _signed(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace("-", "−")

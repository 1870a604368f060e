"""The reader of files with measurements of participants.

Each value has a condition that can be simulated. The door reads a CSV file of values, or says what is wrong with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import quoted
from thermicon.base.files.table import as_number
from thermicon.base.numbers.arrays import Array, own_arrays
from thermicon.base.words.near_words import nearest_words
from thermicon.circuit.rig.rig import AnyRig, Rig

from ..experiments.measure import ADAPTIVE, METHODS, UNITS, Condition, Kind
from ..observer.channels import CHANNELS, Channel
from .trials_file import TrialsError, check_labels, label, require, table_in

COLUMNS = ("participant", "kind", "channel", "value", "unit")
OPTIONAL = ("method", "size_K", "rate_K_per_s", "hold_s", "baseline_C", "standard_error", "trials")
EXAMPLE = ",".join((*COLUMNS, "method", "size_K", "standard_error"))
WHAT = "table of measurements"
MOST_CONDITIONS = 40

FACTORS: Mapping[Kind, Mapping[str, float]] = {
    "threshold": {"K": 1.0, "°C": 1.0, "degC": 1.0, "C": 1.0, "mK": 1e-3},
    "reaction_time": {"s": 1.0, "ms": 1e-3},
    "rating": {"points": 1.0, "%": 1.0},
}
"""What each unit is multiplied by; thresholds are changes, so that K and °C are alike."""
RANGES: Mapping[Kind, tuple[float, float, str]] = {
    "threshold": (0.005, 20.0, "thresholds are changes from the baseline, without sign"),
    "reaction_time": (0.1, 60.0, "reaction times count from the start of the change; check s against ms"),
    "rating": (
        0.1,
        100.0,
        "ratings are points of 100: multiply those of a scale of 10, and leave out what was not felt",
    ),
}
RATES = {"yes_no": 2.5, "choice": 5.0, "simple": 5.0, "magnitude": 5.0}
HOLDS = {"forced_choice": 3.0, "yes_no": 1.5, "magnitude": 0.7}
LIMIT_K = 12.0
"""Where a ramp of limits ends, if the table does not say it. Rates are 1 K/s and holds 0 s unless named above."""
NUMBERS = {
    "size_K": (0.01, 25.0, "K"),
    "rate_K_per_s": (0.01, 100.0, "K/s"),
    "hold_s": (0.0, 60.0, "s"),
    "baseline_C": (10.0, 45.0, "°C"),
    "trials": (1.0, 10_000.0, ""),
}
LONGEST_RAMP_S = 120.0


@dataclass(frozen=True, slots=True, eq=False)
class Measurements:
    """Values of some participants under some conditions, each (participants, conditions), in the conditions' units.

    NaN where nothing was measured, or `errors` and `trials` are not known; the digest is of the file's SHA-256.
    """

    conditions: tuple[Condition, ...]
    participants: tuple[str, ...]
    values: Array
    errors: Array
    trials: Array
    source: str = ""
    digest: str = ""

    def __post_init__(self) -> None:
        own_arrays(self, "values", "errors", "trials")
        wanted = (len(self.participants), len(self.conditions))
        for name, own in (("values", self.values), ("errors", self.errors), ("trials", self.trials)):
            if own.shape != wanted or 0 in wanted:
                raise ValueError(f"{name} of measurements must have shape {wanted}, with at least one row and column")
            if (own[~np.isnan(own)] <= 0.0).any() or np.isinf(own).any():
                raise ValueError(f"{name} of measurements must be above 0 and finite")
        there = self.given
        if not there.any(axis=0).all() or not there.any(axis=1).all():
            raise ValueError("every participant and every condition needs at least one value")

    @property
    def given(self) -> Array:
        """Presence of a value (participants, conditions)."""
        return ~np.isnan(self.values)

    @property
    def total(self) -> int:
        """Number of values."""
        return int(self.given.sum())

    @property
    def means(self) -> Array:
        """Geometric mean over participants (conditions,)."""
        return np.asarray(np.exp(np.nanmean(np.log(self.values), axis=0)))

    @property
    def assumed_errors(self) -> int:
        """Values whose error is neither stated nor follows from a number of trials."""
        return int((self.given & np.isnan(self.errors) & np.isnan(self.trials)).sum())

    def __repr__(self) -> str:
        counts = ((len(self.participants), "participant"), (self.total, "value"), (len(self.conditions), "condition"))
        words = [f"{count} {word}{'s' * (count != 1)}" for count, word in counts]
        return f"Measurements({', '.join(words)})"


@checked
def read_measurements(
    path: str | Path, rig: AnyRig = "thenar", columns: Mapping[str, str] | None = None
) -> Measurements:
    """Read thresholds, reaction times and ratings of participants; a `TrialsError` says what is wrong, and where.

    A CSV file has the columns participant, kind, channel, value, unit and, where they apply, method, size_K,
    rate_K_per_s, hold_s, baseline_C, standard_error and trials. The resting skin of the rig, which the values were
    measured on, is the baseline where the table names none. Participants and conditions are in the order of the file.

    Parameters
    ----------
    path
        The file.
    rig
        The rig that the values were measured on, or its name or file.
    columns
        What the file calls ours, such as ``{"value": "threshold"}``.

    Returns
    -------
    Measurements
        Values of every participant and condition.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from thermicon.circuit import Rig
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "values.csv"
    ...     _ = path.write_text("participant,kind,method,channel,value,unit\\nP1,threshold,limits,cold,1.1,K\\n")
    ...     read_measurements(path, Rig.load("thenar"))
    Measurements(1 participant, 1 value, 1 condition)
    """
    file, rig = Path(path), Rig.of(rig)
    table, digest = table_in(file, COLUMNS, EXAMPLE, WHAT, columns)
    require(file, table, COLUMNS, EXAMPLE)
    _check_columns(file, table.header)
    found: dict[tuple[str, Condition], tuple[float, float, float]] = {}
    first: dict[tuple[str, Condition], int] = {}
    for line, row in table.records((*COLUMNS, *OPTIONAL)):
        key, numbers = _row(row, f"{file}:{line}", rig)
        if key in found:
            person, condition = key
            raise TrialsError(
                f"{file}:{line}: participant {quoted(person)} has {condition.label} twice, also in line {first[key]}; "
                "give one row with the mean, its standard_error and the number of trials"
            )
        found[key], first[key] = numbers, line
    people, conditions = (tuple(dict.fromkeys(each)) for each in zip(*found, strict=True))
    check_labels(file, people)
    if len(conditions) > MOST_CONDITIONS:
        raise TrialsError(f"{file}: {len(conditions)} conditions; at most {MOST_CONDITIONS} are taken at once")
    values = np.full((3, len(people), len(conditions)), np.nan)
    for (person, condition), numbers in found.items():
        values[:, people.index(person), conditions.index(condition)] = numbers
    return Measurements(conditions, people, values[0], values[1], values[2], file.name, digest)


def _check_columns(file: Path, header: Sequence[str]) -> None:
    """Refuse columns that look like misspelt ones; others, such as notes, are nobody's business here."""
    known = (*COLUMNS, *OPTIONAL)
    for name in header:
        if name not in known and (close := nearest_words(name, known, 1, 0.75)):
            raise TrialsError(
                f"{file}: there is no column {quoted(name)}; did you mean {close[0]}? Rename it, or remove it"
            )


def _row(cells: Mapping[str, str], where: str, rig: Rig) -> tuple[tuple[str, Condition], tuple[float, float, float]]:
    """Participant, condition and result of a row: value, standard error, trials."""
    kind = cast("Kind", _one_of(cells["kind"], "kind", tuple(FACTORS), where))
    channel = cast("Channel", _one_of(cells["channel"], "channel", CHANNELS, where))
    methods, what = METHODS[kind], kind.replace("_", " ")
    method = cells.get("method", "")
    if not method and kind == "threshold":
        raise TrialsError(
            f"{where}: the method of a threshold is missing, and thresholds differ tenfold by it; add the "
            f"column method with {', '.join(methods)}"
        )
    method = _one_of(method, "method", methods, where) if method else methods[0]
    factor = FACTORS[kind][_one_of(cells["unit"], "unit", tuple(FACTORS[kind]), where, f" of a {what}")]
    low, high, cure = RANGES[kind]
    value = factor * _number(cells["value"], "value", where)
    if not low <= value <= high:
        raise TrialsError(
            f"{where}: value is {quoted(cells['value'])} {cells['unit']}, a {what} lies within {low:g} to "
            f"{high:g} {UNITS[kind]}; {cure}"
        )
    condition = _condition(cells, kind, method, channel, where, rig)
    if method == "limits" and value > (condition.size_K or 0.0):
        raise TrialsError(
            f"{where}: value is {value:g} K, and the ramp ends at {condition.size_K:g} K; give size_K, where the ramp "
            "really ended"
        )
    error = math.nan
    if cells.get("standard_error"):
        error = factor * _number(cells["standard_error"], "standard_error", where)
    if not math.isnan(error) and not 0.0 < error <= 2.0 * value:
        raise TrialsError(
            f"{where}: standard_error is {quoted(cells['standard_error'])}, for a value of {cells['value']}; it "
            "is above 0, in the unit of the value; leave it empty where it is not known"
        )
    trials = _within(cells, "trials", math.nan, where)
    if trials != trials // 1 and not math.isnan(trials):
        raise TrialsError(f"{where}: trials is {quoted(cells['trials'])}, not a whole number")
    return (label(cells["participant"], "participant", where), condition), (value, error, trials)


def _condition(cells: Mapping[str, str], kind: Kind, method: str, channel: Channel, where: str, rig: Rig) -> Condition:
    size = _within(cells, "size_K", LIMIT_K if method == "limits" else math.nan, where)
    if method in ADAPTIVE and not math.isnan(size):
        raise TrialsError(f"{where}: size_K belongs to limits, reaction times and ratings; leave it empty for {method}")
    if method not in ADAPTIVE and math.isnan(size):
        raise TrialsError(
            f"{where}: size_K is missing: give the change of the display in K, without sign, that was "
            f"{'timed' if kind == 'reaction_time' else 'rated'}"
        )
    rate, hold = _within(cells, "rate_K_per_s", RATES.get(method, 1.0), where), HOLDS.get(method, 0.0)
    if size / rate > LONGEST_RAMP_S:
        raise TrialsError(f"{where}: a ramp of {size:g} K at {rate:g} K/s takes more than {LONGEST_RAMP_S:g} s")
    baseline = _within(cells, "baseline_C", rig.skin.rest_C, where)
    found = None if math.isnan(size) else size
    return Condition(kind, method, channel, baseline, found, rate, _within(cells, "hold_s", hold, where))


def _one_of(text: str, column: str, known: tuple[str, ...], where: str, of: str = "") -> str:
    if text in known:
        return text
    if not text:
        raise TrialsError(f"{where}: {column} is empty; choose of {', '.join(known)}")
    same = [name for name in known if name.casefold() == text.casefold().replace(" ", "_").replace("-", "_")]
    hint = f"did you mean {same[0]}?" if same else f"choose of {', '.join(known)}"
    raise TrialsError(f"{where}: {column} is {quoted(text)}, which is not a {column}{of}; {hint}")


def _number(text: str, column: str, where: str) -> float:
    value = as_number(text)
    if not math.isfinite(value):
        cure = "leave it empty where it is not known" if column in OPTIONAL else "correct it, or remove the row"
        raise TrialsError(
            f"{where}: {column} is {quoted(text) if text else 'empty'}, not a number with a decimal point; {cure}"
        )
    return value


def _within(cells: Mapping[str, str], column: str, default: float, where: str) -> float:
    text = cells.get(column, "")
    if not text:
        return default
    value, (low, high, unit) = _number(text, column, where), NUMBERS[column]
    if not low <= value <= high:
        hint = "; that looks like kelvin" if column == "baseline_C" and 280.0 < value < 320.0 else ""
        raise TrialsError(f"{where}: {column} is {text}, outside {low:g} to {high:g} {unit}{hint}".rstrip())
    return value

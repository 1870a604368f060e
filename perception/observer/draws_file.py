"""The file of posterior draws.

It is written by `python -m thermicon.perception.evidence`. Reading refuses a table of other evidence or another form.
"""

import csv
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from thermicon.base.files.inputs import quoted, read_text
from thermicon.base.files.records import RecordError
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.near_words import did_you_mean

from .channels import FORM as FORM_OF_MEMORY
from .channels import MEMORY_FORMS, VARIABLES, Variable, check_variable
from .constants import ANY, SHARE, objection_to, ranges_of
from .mechanisms.memory import MEMORY_NAMES
from .observer import DATA, Observer

MOST_MB, LARGEST = 200.0, 1e9
"""Size of a file, and of a number in it: far more than any constant in its unit."""
FORM = 1
"""Version of the form; a table of another one is refused."""
FIGURES = 6
TABLE = "sha256 of the table"
"""Label of the line with the digest of the draws."""
FIRST_LINE = "# written by thermicon calibrate from inputs "
LABORATORY_LINE = "# written by thermicon observed from inputs "
"""How the draws of one laboratory begin."""
CURE = "write it again, by a pilot with its answers or python -m thermicon.perception.evidence sample -o FILE"
KEEP_AGAIN = "keep it again, by a pilot with its answers"
CONSTANTS = DATA / "constants.csv"
APPROXIMATE = "normal approximation"


@dataclass(frozen=True, slots=True)
class DrawsHeader:
    """The origin of a table of draws: digests, variant, sampler and diagnostics, all as text in the file.

    `r_hat` is the largest and `ess` the least over all constants. Draws of one laboratory say how they were
    `resampled`, and on which `rig` it played; others leave both empty.
    """

    inputs: str
    evidence: str
    priors: str
    program: str
    variable: Variable
    left_out: tuple[str, ...]
    sampler: str
    seed: int
    likelihoods: int
    r_hat: float
    ess: float
    converged: bool
    offsets: tuple[str, ...]
    resampled: str = ""
    rig: str = ""

    def __post_init__(self) -> None:
        check_variable(self.variable)

    @property
    def status(self) -> str:
        """Diagnostics in a few words."""
        if self.resampled:
            return f"resampled {self.resampled}"
        if APPROXIMATE in self.sampler:
            return f"{APPROXIMATE}, not sampled"
        reached = "" if self.converged else "NOT CONVERGED, "
        return f"{reached}R-hat up to {self.r_hat:.3f}, ESS from {self.ess:.0f}"


SAID: Mapping[str, str] = {
    "variable": "sensory variable",
    "likelihoods": "likelihoods computed",
    "r_hat": "largest R-hat",
    "ess": "least bulk ESS",
    "offsets": "offsets of laboratories",
}
"""Fields that the header calls otherwise."""
OF_LABORATORY = ("resampled", "rig")
"""Fields that only one laboratory's draws have."""
LABELS = {own.name: SAID.get(own.name, own.name.replace("_", " ")) for own in fields(DrawsHeader)[1:]}
"""Names of the header's lines by field; `inputs`, the first, ends the first line."""


def shipped_file(variable: Variable) -> Path:
    """The path of the shipped draws of a variant."""
    return DATA / ("posterior.csv" if variable == VARIABLES[0] else f"posterior-{variable.replace(' ', '-')}.csv")


def to_text(header: DrawsHeader, names: Sequence[str], draws: Array) -> str:
    """The whole file, numbers to six figures."""
    text, table = StringIO(), StringIO()
    text.write(f"{LABORATORY_LINE if header.resampled else FIRST_LINE}{header.inputs}\n# form: {FORM}\n")
    for field, label in LABELS.items():
        if header.resampled or field not in OF_LABORATORY:
            text.write(f"# {label}: {_to_text(getattr(header, field))}\n")
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([_figures(value) for value in row] for row in draws.tolist())
    rows = table.getvalue()
    text.write(f"# {TABLE}: {_digest(rows.splitlines())}\n{rows}")
    return text.getvalue()


def as_written(values: Array) -> Array:
    """Numbers as a table has them, to six figures."""
    return np.array([float(_figures(value)) for value in values.ravel().tolist()]).reshape(values.shape)


def _figures(value: float) -> str:
    return f"{value:.{FIGURES}g}"


def _digest(rows: Sequence[str]) -> str:
    """First 16 digits of the SHA-256 of the table below the header, whatever its line ends."""
    return hashlib.sha256("\n".join(row.rstrip() for row in rows).encode("utf-8")).hexdigest()[:16]


def _check_table(name: str, head: Sequence[str], rows: Sequence[str]) -> None:
    """Refuse a table that is not the one the header was written for; tables without a digest are taken as they are."""
    line = f"# {TABLE}: "
    stated = next((text.removeprefix(line).strip() for text in head if text.startswith(line)), None)
    if stated is not None and stated != (own := _digest(rows)):
        raise RecordError(
            f"{name}: the draws have sha256 {own}, the header says {stated}: the table was changed after it was "
            f"written: use the original, or remove the line that begins with {line.strip()!r} to use it as it is"
        )


def _to_text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ", ".join(value) or "nothing"
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def read_draws(path: Path) -> tuple[DrawsHeader, tuple[str, ...], Array, tuple[str, ...], Array]:
    """Header, names and draws, of constants and of memory; a RecordError says what is wrong, where, and the cure."""
    lines = read_text(path, "table of posterior draws", MOST_MB, RecordError).splitlines()
    head = [line for line in lines if line.startswith("#")]
    if not head or not head[0].startswith((FIRST_LINE, LABORATORY_LINE)):
        laboratory = "a pilot with answers keeps one of its laboratory"
        raise RecordError(f"{path.name}, line 1: this is not a table of posterior draws: {CURE}; {laboratory}")
    header = _header(path.name, head)
    _check_table(path.name, head, lines[len(head) :])
    rows = [line.split(",") for line in lines[len(head) :]]
    if len(rows) < 2:
        raise RecordError(f"{path.name}: the table has no draws: {CURE}")
    names = tuple(rows[0])
    _check_names(path.name, _inferred(header.variable), names)
    draws = _numbers(path.name, names, rows[1:], len(head) + 2)
    remembered = [name in MEMORY_NAMES for name in names]
    constants = tuple(name for name in names if name not in MEMORY_NAMES)
    memory = tuple(name for name in names if name in MEMORY_NAMES)
    return header, constants, draws[:, np.logical_not(remembered)], memory, draws[:, remembered]


def _numbers(file: str, names: Sequence[str], rows: Sequence[Sequence[str]], first_line: int) -> Array:
    """The rows as numbers (rows, names)."""
    draws, ranges = np.empty((len(rows), len(names))), {**ranges_of(Observer), FORM_OF_MEMORY: SHARE}
    within = [ranges.get(name, ANY) for name in names]
    for number, row in enumerate(rows):
        where = f"{file}, line {first_line + number}"
        if len(row) != len(names):
            raise RecordError(f"{where}: {len(row)} numbers for {len(names)} constants: {CURE}")
        for place, text in enumerate(row):
            draws[number, place] = _number(text, f"{where}, {names[place]}")
            why = objection_to(within[place], float(draws[number, place]))
            if names[place] == FORM_OF_MEMORY and draws[number, place] not in range(len(MEMORY_FORMS)):
                why = f"is none of 0 ({MEMORY_FORMS[0]}) and 1 ({MEMORY_FORMS[1]})"
            if why:
                raise RecordError(f"{where}, {names[place]}: {text} {why}: {CURE}")
    return draws


def _header(name: str, head: Sequence[str]) -> DrawsHeader:
    known = dict(line[2:].split(": ", 1) for line in head[1:] if ": " in line)
    cure = KEEP_AGAIN if head[0].startswith(LABORATORY_LINE) else CURE
    if known.get("form") != str(FORM):
        raise RecordError(
            f"{name}, line 2: form {known.get('form', 'none')} of draws, this program reads {FORM}: {cure}"
        )
    missing = [label for field, label in LABELS.items() if label not in known and field not in OF_LABORATORY]
    if missing:
        raise RecordError(f"{name}: the header has no line {missing[0]!r}: {cure}")
    inputs = head[0].removeprefix(FIRST_LINE).removeprefix(LABORATORY_LINE).strip()
    current = current_inputs()
    if inputs != current:
        raise RecordError(f"{name}, line 1: made from evidence and priors {inputs}, this program has {current}: {cure}")
    read: dict[str, Any] = {"inputs": inputs, **{field: known.get(label, "") for field, label in LABELS.items()}}
    for field, kind in {"seed": int, "likelihoods": int, "r_hat": float, "ess": float}.items():
        read[field] = kind(_number(read[field], f"{name}, {LABELS[field]}"))
    for field in ("left_out", "offsets"):
        read[field] = () if read[field] == "nothing" else tuple(read[field].split(", "))
    try:
        return DrawsHeader(**{**read, "converged": read["converged"] == "yes"})
    except ValueError as error:
        raise RecordError(f"{name}: {error}") from error


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) <= LARGEST:
        raise RecordError(f"{where}: {quoted(text)} is not a finite number of at most {LARGEST:g}: {CURE}")
    return value


def _check_names(name: str, expected: Sequence[str], names: Sequence[str]) -> None:
    if len(set(names)) < len(names):
        raise RecordError(f"{name}: two columns have one name: {CURE}")
    for each in names:
        if each not in expected and each not in MEMORY_NAMES:
            raise RecordError(
                f"{name}: {each!r} is not a constant of this observer: {did_you_mean(each, {*expected, *MEMORY_NAMES})}"
            )
    for each in expected:
        if each not in names:
            raise RecordError(f"{name}: there is no column {each!r}: {CURE}")


def _inferred(variable: Variable) -> tuple[str, ...]:
    """Names of all constants that were inferred for a variant."""
    with CONSTANTS.open(encoding="utf-8", newline="") as file:
        file.readline()
        rows = csv.DictReader(file)
        return tuple(row["name"] for row in rows if row["variable"] == variable)


def current_inputs(table: Path = CONSTANTS) -> str:
    """Digest of the evidence and priors that this program's constants, or another shipped table, were made from."""
    with table.open(encoding="utf-8") as file:
        return file.readline().rpartition(" ")[2].strip()

"""The door for answers: a CSV file of trials, or what is wrong with it, where, and what helps."""

from __future__ import annotations

import csv
import hashlib
import io
import math
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.circuit.inputs import LIKE_MILLISECONDS, InputError, line_fault, quoted, read_bytes, read_text, text_of
from thermicon.icons.near_words import did_you_mean

from .trials import Trials

COLUMNS = ("participant", "trial", "presented", "responded")
TIME = "time_s"
EXAMPLE = f"{','.join(COLUMNS)},{TIME}"
WHAT = "table of trials"
MOST_MB, MOST_ROWS, MOST_PARTICIPANTS = 20, 200_000, 1000
LONGEST_LABEL, LONGEST_TIME_S = 100, 3600.0
MARKS = (",", ";", "\t")
LEAST_TIMES, SLOW_S, SLOWEST_S = 3, 60.0, 600.0
"""Times by which a unit is judged; medians above which whole numbers from 100 on, or any, can only be milliseconds."""
PAUSE, MOST_PAUSES = 30.0, 5
"""Times over SLOW_S and so many times the median are doubtful; of so many, each has a warning of its own."""
LIKE_TIMES = re.compile(
    r"(.*\.)?(rt|latency|((reaction|response|answer)[ _]?)?time)[ _(\[]*(s|sec(ond)?s?|ms|msecs?|milliseconds)?[)\]]?",
    re.IGNORECASE,
)
"""Names under which other programs record times of answers, such as time_ms, RT, key_resp.rt and response_time (s)."""


class TrialsError(InputError):
    """A table of answers cannot be used; the message says what, where and the cure."""


@dataclass(frozen=True, slots=True)
class Cells:
    """Rows of a table with a header: `rows` hold cells by column, `lines` where each stands in the file.

    `digest` has the first 16 digits of the SHA-256 of the file, by which a result names what it was made from.
    """

    header: tuple[str, ...]
    rows: tuple[dict[str, str], ...]
    lines: tuple[int, ...]
    digest: str


def read_trials(path: str | Path, icons: Sequence[str]) -> Trials:
    """Read the answers of an identification experiment.

    Parameters
    ----------
    path
        A CSV file with the columns participant, trial, presented, responded and, if recorded, time_s. Semicolons and
        tabs also separate columns; lines that begin with # are comments.
    icons
        Names of the icons of the set, which are all answers that there are.

    Returns
    -------
    Trials
        Participants in the order of the file.

    Raises
    ------
    TrialsError
        For a file that cannot be read, is too large or has no rows, for missing columns, for a trial that stands twice,
        for names that are not in the set, for times that are negative, over an hour or not numbers, and for times that
        are plainly milliseconds.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "trials.csv"
    ...     _ = path.write_text("participant,trial,presented,responded\\nP1,1,cool,cool\\nP1,2,warm,cool\\n")
    ...     read_trials(path, ["cool", "warm"])
    Trials(1 participant, 2 trials, 2 icons)
    """
    file = Path(path)
    cells = read_cells(file, COLUMNS, (TIME,), EXAMPLE, WHAT)
    _check_unit_of_times(file, cells)
    names, known = tuple(icons), set(icons)
    places = {name: place for place, name in enumerate(names)}
    participants: dict[str, int] = {}
    answers: list[tuple[int, int, int]] = []
    times: list[tuple[int, float]] = []
    timed: list[tuple[str, int, float]] = []
    first: dict[tuple[str, str], int] = {}
    for row, line in zip(cells.rows, cells.lines, strict=True):
        where = f"{file}:{line}"
        person, trial = label(row["participant"], "participant", where), label(row["trial"], "trial", where)
        if (person, trial) in first:
            raise TrialsError(
                f"{where}: participant {quoted(person)} has trial {quoted(trial)} twice, also in line "
                f"{first[person, trial]}; number the trials of a participant on, or remove the copy"
            )
        first[person, trial] = line
        pair = [_icon(row[column], column, known, where) for column in ("presented", "responded")]
        number = participants.setdefault(person, len(participants))
        answers.append((number, places[pair[0]], places[pair[1]]))
        if row.get(TIME):
            timed.append((person, line, _time(row[TIME], where)))
            if pair[0] == pair[1]:
                times.append((number, timed[-1][2]))
    check_labels(file, participants)
    counts = np.zeros((len(participants), len(names), len(names)))
    np.add.at(counts, tuple(np.array(answers).T), 1.0)
    medians = tuple(
        float(np.median(each)) if (each := [time for person, time in times if person == number]) else math.nan
        for number in range(len(participants))
    )
    doubts = (*_unread_times(file, cells.header), *_pauses(file, timed))
    return Trials(names, tuple(participants), counts, medians, file.name, cells.digest, doubts)


def _unread_times(file: Path, header: Sequence[str]) -> list[str]:
    """That times in a column of another name are not read, in a table without the one that is."""
    if TIME in header:
        return []
    return [
        f"{file}: times in the column {quoted(name)} are not read: name it {TIME} and give s, or leave it as it is if "
        "they are of no interest"
        for name in header
        if LIKE_TIMES.fullmatch(name)
    ]


def _pauses(file: Path, timed: Sequence[tuple[str, int, float]]) -> list[str]:
    """Times of (participant, line, s) that are far longer than the others of the participant, or of all if few."""
    each: dict[str, list[float]] = {}
    for person, _, value in timed:
        each.setdefault(person, []).append(value)
    together, found = [value for _, _, value in timed], list[str]()
    for person, line, value in timed:
        own = each[person] if len(each[person]) >= LEAST_TIMES else together
        middle = float(np.median(own))
        if len(own) >= LEAST_TIMES and value > max(SLOW_S, PAUSE * middle):
            whose = f"of participant {quoted(person)}" if own is not together else "of all times"
            found.append(
                f"{file}:{line}: {TIME} is {value:g} s, and the median {whose} is {middle:.3g} s: correct it, or leave "
                "it empty; the answer counts in either case"
            )
    if (more := len(found) - MOST_PAUSES) > 0:
        found[MOST_PAUSES:] = [f"{file}: {more} more {'time is' if more == 1 else 'times are'} that long"]
    return found


def _check_unit_of_times(path: Path, cells: Cells) -> None:
    """Refuse answers of a participant, or of all together, whose times can only be milliseconds."""
    times: dict[str, list[float]] = {}
    for row in cells.rows:
        with suppress(ValueError):
            if math.isfinite(value := float(row.get(TIME, ""))):
                times.setdefault(row["participant"], []).append(value)
    together = [value for each in times.values() for value in each]
    slow = [name for name, each in times.items() if is_milliseconds(each)]
    others = [name for name, each in times.items() if len(each) >= LEAST_TIMES and name not in slow]
    if slow and others:
        more = f" and {len(slow) - 1} more" if len(slow) > 1 else ""
        middle, whose = float(np.median(times[slow[0]])), f" of participant {quoted(slow[0])}{more}"
    elif slow or is_milliseconds(together):
        middle, whose = float(np.median(together)), ""
    else:
        return
    raise TrialsError(f"{path}: {TIME}{whose} has a median of {middle:g}: {LIKE_MILLISECONDS}")


def is_milliseconds(times: Sequence[float]) -> bool:
    """Whether times of answers are plainly not in s: whole numbers from 100 on with a median over a minute, or over 10.

    >>> is_milliseconds([1240, 980, 2315]), is_milliseconds([1.24, 0.98, 2.315]), is_milliseconds([61.5, 80, 75.2])
    (True, False, False)
    """
    if len(times) < LEAST_TIMES:
        return False
    middle, whole = float(np.median(times)), all(time >= 100.0 and time == int(time) for time in times)
    return middle > SLOWEST_S or (middle > SLOW_S and whole)


def read_header(path: Path) -> tuple[str, ...]:
    """Names of the columns of a CSV file, as they stand in its first line; empty where there is none."""
    text = read_text(path, WHAT, MOST_MB, TrialsError)
    head = _first_line(text)
    try:
        return tuple(cell.strip() for cell in next(csv.reader([head], delimiter=max(MARKS, key=head.count)), []))
    except csv.Error:
        return ()


def _first_line(text: str) -> str:
    return next((line for line in text.splitlines() if line.strip() and not line.startswith("#")), "")


def read_cells(path: Path, needed: Sequence[str], optional: Sequence[str], example: str, what: str) -> Cells:
    """Rows of a CSV file that has the needed columns; a TrialsError lists what is missing and what was found."""
    data = read_bytes(path, what, MOST_MB, TrialsError)
    text = text_of(data, path, what, TrialsError)
    head = _first_line(text)
    mark = max(MARKS, key=head.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=mark)
    header: tuple[str, ...] = ()
    rows, lines = list[dict[str, str]](), list[int]()
    try:
        for cells in reader:
            if not any(cell.strip() for cell in cells) or cells[0].startswith("#"):
                continue
            where = f"{path}:{reader.line_num}"
            if not header:
                header = tuple(cell.strip() for cell in cells)
                _check_header(where, header, needed, optional, example)
                continue
            if len(cells) > len(header) and any(cell.strip() for cell in cells[len(header) :]):
                raise TrialsError(
                    f"{where}: {len(cells)} cells, where the first line names {len(header)}; "
                    "put names with commas in quotes, and write decimal points"
                )
            padded = [cell.strip() for cell in cells] + [""] * len(header)
            rows.append(dict(zip(header, padded[: len(header)], strict=True)))
            lines.append(reader.line_num)
            if len(rows) > MOST_ROWS:
                raise TrialsError(f"{path}: more than {MOST_ROWS:,} rows; one experiment a file is enough")
    except csv.Error as problem:
        raise TrialsError(f"{path}:{reader.line_num}: this row cannot be read ({problem}); save it as CSV") from None
    if not rows:
        raise TrialsError(f"{path}: no row below the names of the columns; write one row per trial")
    return Cells(header, tuple(rows), tuple(lines), hashlib.sha256(data).hexdigest()[:16])


def _check_header(
    where: str, header: Sequence[str], needed: Sequence[str], optional: Sequence[str], example: str
) -> None:
    missing = [name for name in needed if name not in header]
    if missing:
        close = {cell.lower(): cell for cell in header}
        hints = [f"rename {close[name]!r} to {name}" for name in missing if name in close]
        found = ", ".join(cell[:LONGEST_LABEL] for cell in header[:12]) or "none"
        cure = "; ".join(hints) or f"the first line is such as: {example}"
        raise TrialsError(
            f"{where}: {'column' if len(missing) == 1 else 'columns'} missing: {', '.join(missing)}; found: {found}; "
            f"{cure}"
        )
    for name in (*needed, *optional):
        if list(header).count(name) > 1:
            raise TrialsError(f"{where}: the column {name} appears twice; rename or remove one of them")


def label(cell: str, column: str, where: str) -> str:
    """A short text that is not empty, such as the label of a participant."""
    if not cell:
        raise TrialsError(f"{where}: {column} is empty; fill it in, or remove the row")
    if fault := line_fault(cell, LONGEST_LABEL):
        raise TrialsError(f"{where}: {column} {fault}")
    return cell


def check_labels(path: Path, participants: Sequence[str] | dict[str, int]) -> None:
    """Refuse labels of participants that differ by case alone, and more participants than an experiment has."""
    folded: dict[str, str] = {}
    for name in participants:
        other = folded.setdefault(name.casefold(), name)
        if other != name:
            raise TrialsError(
                f"{path}: participants {quoted(other)} and {quoted(name)} differ by case alone; "
                f"did you mean {quoted(other)}? Spell each participant one way"
            )
    if len(folded) > MOST_PARTICIPANTS:
        raise TrialsError(
            f"{path}: {len(folded):,} participants; at most {MOST_PARTICIPANTS:,} are taken: check that the column "
            "participant does not number trials"
        )


def _icon(cell: str, column: str, known: set[str], where: str) -> str:
    name = label(cell, column, where)
    if name in known:
        return name
    same = [icon for icon in known if icon.casefold() == name.casefold()]
    hint = f"did you mean {same[0]}? Names differ by case" if same else did_you_mean(name, known)
    cure = "" if same else "; where somebody answered none of the icons, remove the row" * (column == "responded")
    raise TrialsError(f"{where}: {column} is {quoted(name)}, which is not an icon of the set; {hint}{cure}")


def _time(cell: str, where: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= LONGEST_TIME_S:
        raise TrialsError(
            f"{where}: {TIME} is {quoted(cell)}, not a time of 0 to {LONGEST_TIME_S:g} s; leave it empty where none "
            "was recorded"
        )
    return value

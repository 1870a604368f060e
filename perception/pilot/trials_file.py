"""The door for answers: a CSV file of trials, or what is wrong with it, where, and what helps."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from thermicon.circuit.inputs import LIKE_MILLISECONDS, InputError, line_fault, quoted, read_bytes, table_fault, text_of
from thermicon.icons.files.table import Kind, Table, as_number, read_table
from thermicon.icons.near_words import did_you_mean

from .trials import Trials

COLUMNS = ("participant", "trial", "presented", "responded")
TIME = "time_s"
EXAMPLE = f"{','.join(COLUMNS)},{TIME}"
WHAT = "table of trials"
MOST_MB, MOST_ROWS, MOST_PARTICIPANTS = 20, 200_000, 1000
LONGEST_LABEL, LONGEST_TIME_S = 100, 3600.0
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
    table, digest = table_in(file, COLUMNS, EXAMPLE, WHAT)
    rows = list(table.records((*COLUMNS, TIME)))
    _check_unit_of_times(file, [row for _, row in rows])
    names, known = tuple(icons), set(icons)
    places = {name: place for place, name in enumerate(names)}
    participants: dict[str, int] = {}
    answers: list[tuple[int, int, int]] = []
    times: list[tuple[int, float]] = []
    timed: list[tuple[str, int, float]] = []
    first: dict[tuple[str, str], int] = {}
    for line, row in rows:
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
    doubts = (*_unread_times(file, table.header), *_pauses(file, timed))
    return Trials(names, tuple(participants), counts, medians, file.name, digest, doubts)


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


def _check_unit_of_times(path: Path, rows: Sequence[Mapping[str, str]]) -> None:
    """Refuse answers of a participant, or of all together, whose times can only be milliseconds."""
    times: dict[str, list[float]] = {}
    for row in rows:
        if math.isfinite(value := as_number(row.get(TIME, ""))):
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


def table_in(path: Path, needed: Sequence[str], example: str, what: str) -> tuple[Table, str]:
    """Return the table in a file, and the first 16 digits of the file's SHA-256, by which a result names it.

    A TrialsError lists which columns of those `needed` are missing, and what was found.
    """
    data = read_bytes(path, what, MOST_MB, TrialsError)
    said = table_fault(path, TrialsError)

    def fault(kind: Kind, line: int | None, wrong: str, cure: str) -> Exception:
        return said(kind, line, wrong, "one experiment a file is enough" if kind == "size" else cure)

    table = read_table(text_of(data, path, what, TrialsError), fault, example, MOST_ROWS)
    if missing := [name for name in needed if name not in table.header]:
        close = {cell.lower(): cell for cell in table.header}
        hints = [f"rename {close[name]!r} to {name}" for name in missing if name in close]
        cure = "; ".join(hints) or f"the first line is such as: {example}"
        raise TrialsError(
            f"{path}:{table.line}: {'column' if len(missing) == 1 else 'columns'} missing: {', '.join(missing)}; "
            f"found: {table.found}; {cure}"
        )
    if needed and not table.rows:
        raise TrialsError(f"{path}: no row below the names of the columns; write one row per trial")
    return table, hashlib.sha256(data).hexdigest()[:16]


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
    value = as_number(cell)
    if not 0.0 <= value <= LONGEST_TIME_S:
        raise TrialsError(
            f"{where}: {TIME} is {quoted(cell)}, not a time of 0 to {LONGEST_TIME_S:g} s; leave it empty where none "
            "was recorded"
        )
    return value

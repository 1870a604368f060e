"""The door for answers: a CSV file of trials, or what is wrong with it, where, and what helps."""

import hashlib
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np

from thermicon.circuit.inputs import InputError, line_fault, quoted, read_bytes, table_fault
from thermicon.icons.files.table import Kind, Table, read_table
from thermicon.icons.near_words import did_you_mean

from .trials import Trials

COLUMNS = ("participant", "trial", "presented", "responded")
EXAMPLE = ",".join(COLUMNS)
WHAT = "table of trials"
MOST_MB, MOST_ROWS, MOST_PARTICIPANTS = 20, 200_000, 1000
LONGEST_LABEL = 100


class TrialsError(InputError):
    """A table of answers cannot be used; the message says what, where and the cure."""


def read_trials(path: str | Path, icons: Sequence[str], columns: Mapping[str, str] | None = None) -> Trials:
    """Read the answers of an identification experiment to icons of a set, whose names are all answers that there are.

    A CSV file has the columns participant, trial, presented and responded; others are left alone. Semicolons and tabs
    also separate columns; lines that begin with # are comments. Participants are in the order of the file;
    `columns` says what the file calls ours. A
    `TrialsError` says what is wrong, where, and what helps.

    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "trials.csv"
    ...     _ = path.write_text("participant,trial,presented,responded\\nP1,1,cool,cool\\nP1,2,warm,cool\\n")
    ...     read_trials(path, ["cool", "warm"])
    Trials(1 participant, 2 trials, 2 icons)
    """
    file = Path(path)
    table, digest = table_in(file, COLUMNS, EXAMPLE, WHAT, columns)
    names, known = tuple(icons), set(icons)
    places = {name: place for place, name in enumerate(names)}
    answers: dict[str, list[tuple[int, int]]] = {}
    first: dict[tuple[str, str], int] = {}
    for line, row in table.records(COLUMNS):
        where = f"{file}:{line}"
        person, trial = label(row["participant"], "participant", where), label(row["trial"], "trial", where)
        if (person, trial) in first:
            raise TrialsError(
                f"{where}: participant {quoted(person)} has trial {quoted(trial)} twice, also in line "
                f"{first[person, trial]}; number the trials of a participant on, or remove the copy"
            )
        first[person, trial] = line
        shown, said = (places[_icon(row[column], column, known, where)] for column in ("presented", "responded"))
        answers.setdefault(person, []).append((shown, said))
    check_labels(file, answers)
    counts = np.zeros((len(answers), len(names), len(names)))
    for number, pairs in enumerate(answers.values()):
        np.add.at(counts[number], tuple(np.array(pairs).T), 1.0)
    return Trials(names, tuple(answers), counts, file.name, digest)


def table_in(
    path: Path, needed: Sequence[str], example: str, what: str, columns: Mapping[str, str] | None = None
) -> tuple[Table, str]:
    """Return the table in a file, and the first 16 digits of the file's SHA-256, by which a result names it.

    A TrialsError lists which columns of those `needed` are missing, and what was found.
    """
    data = read_bytes(path, what, MOST_MB, TrialsError)
    said = table_fault(path, TrialsError)

    def fault(kind: Kind, line: int | None, wrong: str, cure: str) -> Exception:
        return said(kind, line, wrong, "one experiment a file is enough" if kind == "size" else cure)

    table = read_table(data, fault, example, MOST_ROWS, needed, columns)
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


def check_labels(path: Path, participants: Collection[str]) -> None:
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

"""Tables of a study that survive: whole rows on the disk, a lock for each participant, and one file of all answers.

A row counts once its line is complete. Lines that are torn by a crash, or glued to another, are never read as answers:
the next run of the participant moves them into a file beside the table and asks those trials again.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

HERE = Path(__file__).resolve().parent
ANSWERS = ("participant", "trial", "presented", "responded", "time_s")
EVENTS = ("onset", "duration", "trial_type", "stim_file", "block", "trial", "response", "response_time", "marker")
ROOM_BYTES = 1_000_000
"""Tried to write before the display is touched: more than the tables of one participant have."""


Row = dict[str, str]


class NoDisk(Exception):
    """A file that cannot be read or written; the message says which, why and what to do."""


class DurableTable:
    """A table that is on the disk after every row; a file that is empty gets its header first."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self.path, self.columns = path, columns
        self._file: BinaryIO | None = None

    def add(self, row: Mapping[str, object]) -> None:
        """Return when the row is on the disk."""
        text = line_of(self.path, [row.get(name, "n/a") for name in self.columns])
        with told(self.path):
            if self._file is None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._file = self.path.open("ab", buffering=0)
                if self.path.stat().st_size == 0:
                    text = line_of(self.path, self.columns) + text
            put(self._file, text)


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn what the system says of a file into a sentence."""
    try:
        yield
    except OSError as problem:
        why = problem.strerror or problem
        raise NoDisk(f"{path}: {why}; make room there, allow writing, or give another --output") from None


def put(file: BinaryIO, content: bytes) -> None:
    """Write bytes to an open file, and return when they are on the disk."""
    while content:
        content = content[os.write(file.fileno(), content) :]
    os.fsync(file.fileno())


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that is there completely or, after a crash, as it was before."""
    draft = path.with_name(path.name + ".part")
    with told(path):
        try:
            with draft.open("wb", buffering=0) as file:
                put(file, content)
            draft.replace(path)
        except OSError:
            draft.unlink(missing_ok=True)
            raise


def line_of(path: Path, cells: Iterable[object]) -> bytes:
    """A line of a table as bytes."""
    line = io.StringIO()
    csv.writer(line, delimiter=delimiter_of(path), lineterminator="\n").writerow(cells)
    return line.getvalue().encode("utf-8")


def delimiter_of(path: Path) -> str:
    """What parts the cells of a table: a tab in a .tsv file."""
    return "\t" if path.suffix == ".tsv" else ","


def cells_of(path: Path, line: bytes) -> tuple[str, ...]:
    """The cells of a line without its end; none where it is not text."""
    try:
        return tuple(next(csv.reader([line.decode("utf-8-sig")], delimiter=delimiter_of(path)), ()))
    except (UnicodeDecodeError, csv.Error):
        return ()


def read_table(
    path: Path, columns: tuple[str, ...], is_row: Callable[[Row], bool] = lambda row: True
) -> tuple[list[Row], list[bytes]]:
    """Rows of a table, and its damaged lines as bytes; both are empty where the file is empty or does not exist."""
    with told(path):
        *lines, tail = path.read_bytes().split(b"\n") if path.exists() else [b""]
    if lines and cells_of(path, lines[0]) != columns:
        raise SystemExit(f"{path}: its first line is not {','.join(columns)}; repair it, or move the file away")
    rows, torn = [], []
    for line in lines[1:]:
        cells = cells_of(path, line)
        row = dict(zip(columns, cells, strict=False))
        if len(cells) == len(columns) and is_row(row):
            rows.append(row)
        elif line.strip():
            torn.append(line)
    return rows, torn + [tail] * bool(tail)


def read_study() -> dict[str, Any]:
    """What thermicon wrote of the study beside this file."""
    facts: dict[str, Any] = json.loads((HERE / "study.json").read_text(encoding="utf-8"))
    return facts


def set_aside(path: Path, columns: Sequence[str], rows: Sequence[Row], torn: Sequence[bytes]) -> None:
    """Move damaged lines of a table into a file beside it, and say so."""
    if not torn:
        return
    number = 1
    while (beside := path.with_name(f"{path.stem}.torn-{number}{path.suffix}")).exists():
        number += 1
    write_whole(beside, b"\n".join(torn))
    write_whole(path, b"".join(line_of(path, cells) for cells in [columns, *(row.values() for row in rows)]))
    print(f"{path.name}: {lines_left_out(torn)}, kept in {beside.name}")


def lines_left_out(torn: Sequence[bytes]) -> str:
    """How many damaged lines do not count."""
    return f"{len(torn)} line{'s' if len(torn) > 1 else ''} torn or doubled, left out"


def locked(file: BinaryIO, path: Path) -> bool:
    """Lock an open file, which must not have been removed meanwhile; False where another run has it."""
    try:
        try:
            import fcntl
        except ImportError:  # on Windows
            msvcrt = import_module("msvcrt")
            file.seek(0)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat())


@dataclass(frozen=True, slots=True)
class StudyFiles:
    """Answers and events in a folder; `study` has what thermicon wrote of the study."""

    folder: Path
    study: Mapping[str, Any]

    @property
    def task(self) -> str:
        """The name of the study in those of its files."""
        return str(self.study["name"])

    @property
    def none(self) -> str:
        """The answer where none came in time: the play was not felt, as `thermicon pilot` reads it."""
        return "" if "none" in self.study["choices"] else "none"

    def answers_file(self, who: str) -> Path:
        """Where the answers of a participant are."""
        return self.folder / f"sub-{who}_task-{self.task}_answers.csv"

    def threshold_file(self, who: str) -> Path:
        """Where the threshold of a participant is."""
        return self.folder / f"sub-{who}_task-{self.task}_threshold.json"

    def events_files(self, who: str) -> list[Path]:
        """The events of each run of a participant."""
        return sorted((self.folder / f"sub-{who}" / "beh").glob(f"sub-{who}_task-{self.task}_run-*_events.tsv"))

    def new_run(self, who: str) -> str:
        """The path with which the names of this run's files begin; a run that was resumed has a number of its own."""
        number, beside = 1, self.folder / f"sub-{who}" / "beh"
        while any(beside.glob(f"sub-{who}_task-{self.task}_run-{number}_*")):
            number += 1
        return str(beside / f"sub-{who}_task-{self.task}_run-{number}")

    def read_answers(self, who: str) -> tuple[list[Row], list[bytes]]:
        """Answers of a participant, one for each trial, and damaged lines; `none` where none came in time."""
        trials = set()

        def is_new(row: Row) -> bool:
            trial = row["trial"]
            if row["participant"] != who or trial in trials or not ("0" < trial[:1] <= "9" and trial.isdecimal()):
                return False
            trials.add(trial)
            return True

        return read_table(self.answers_file(who), ANSWERS, is_new)

    def given_answers(self, who: str) -> dict[int, tuple[str, str]]:
        """What was presented and answered by trial; damaged lines of answers and events go beside their table."""
        answers, torn = self.read_answers(who)
        set_aside(self.answers_file(who), ANSWERS, answers, torn)
        for path in self.events_files(who):
            set_aside(path, EVENTS, *read_table(path, EVENTS))
        return {int(row["trial"]): (row["presented"], self.said_in(row)) for row in answers}

    def said_in(self, row: Row) -> str:
        """What was answered in a trial; empty where no answer came in time."""
        return "" if row["responded"] == self.none else row["responded"]

    @contextmanager
    def claimed(self, who: str) -> Iterator[None]:
        """Lock a participant in the folder, where there must be room; the system frees the lock of a killed run."""
        folder, answers = self.folder, self.answers_file(who)
        path, made = folder / f"sub-{who}_task-{self.task}.lock", not folder.exists()
        with told(folder):
            folder.mkdir(parents=True, exist_ok=True)
            file = path.open("ab", buffering=0)
        with file:
            with told(folder):
                free = locked(file, path)
            if not free:
                raise SystemExit(
                    f"participant {who} runs already into {folder}: end that run, or give another --output"
                )
            try:
                with told(folder):
                    put(file, bytes(ROOM_BYTES))
                    file.truncate(0)
                if answers.exists():
                    with told(answers):
                        answers.open("ab").close()
                yield
            finally:
                if os.name != "posix":  # there a file that is open cannot be removed
                    file.close()
                with suppress(OSError):
                    path.unlink()
                    if made:
                        folder.rmdir()  # where it is still empty

    def collect(self) -> None:
        """Join the answers of all participants into answers.csv; practice is not in them."""
        goal = self.folder / "answers.csv"
        rows: list[Row] = []
        for who in self.study["participants"]:
            answers, torn = self.read_answers(who)
            rows += answers
            if torn:
                print(f"{self.answers_file(who).name}: {lines_left_out(torn)}")
        if not rows:
            raise SystemExit(f"there are no answers in {self.folder} yet")
        write_whole(goal, b"".join(line_of(goal, cells) for cells in [ANSWERS, *(row.values() for row in rows)]))
        people, given = len({row["participant"] for row in rows}), sum(bool(self.said_in(row)) for row in rows)
        silent = f"; {len(rows) - given} trials without an answer" if given < len(rows) else ""
        print(f"wrote {goal}: {given} answers of {people} participant{'s' if people > 1 else ''}{silent}")

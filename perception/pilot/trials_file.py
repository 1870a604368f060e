"""The reader of answers in a CSV file of trials."""

import hashlib
import re
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from pathlib import Path

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError, line_fault, quoted, read_bytes, table_fault
from thermicon.base.files.layout import NOTHINGS
from thermicon.base.files.table import Table, as_number, read_table
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.near_words import did_you_mean, nearest_words
from thermicon.icons import IconSet
from thermicon.icons.files.shipped import set_of

from .trials import Trials

COLUMNS = ("participant", "trial", "presented", "responded")
EXAMPLE = ",".join(COLUMNS)
WHAT = "table of trials"
MOST_MB, MOST_ROWS, MOST_PARTICIPANTS = 20, 200_000, 1000
LONGEST_LABEL = 100
MOST, PER_CENT = 1e6, "write numbers of answers (a per cent of a row times its number of trials)"
ALIKE = 0.55
"""A cell that is so much alike an icon is a slip of the pen, not an instruction."""
UNFELT = ("", "none", "no answer", "no response", "no_response", "not felt", "timeout", "null", "–", "-", "--", "---")
"""What experiments write where nothing was answered: the play was not felt."""
SILENT = "none"
"""What a cell that says in other words that nothing was felt may be said to stand for."""
NOTHING = (*UNFELT, "missing", *NOTHINGS)
"""The same, and what stands for trials that are lost: these are none."""
WIDE = re.compile(
    r"(?:(?:trial[_ .-]?)?(\d+)[_ .-])?(icon|presented|shown|stim(?:ulus)?|answer|resp(?:onded|onse)?|trial)"
    r"[_ .-]?(\d+)?",
    re.I,
)
ASKED, WIDE_EXAMPLE = ("icon", "presented", "shown", "stim", "stimulus"), "participant,icon_1,answer_1,icon_2,answer_2"
"""Words of `WIDE` for what was presented, and how such a line begins."""

OTHERS = {
    "participant": "(?i)participant|subj|who|vp|person|proband|observ|^id$|_id$|response ?id$",
    "trial": "(?i)^trial|trial_?(n|index|number|sequence)|durchgang|^n[or]$",
    "presented": "(?i)icon|shown|stim|target|played|reiz",
    "responded": "(?i)answer|resp|key|choice|guess|antwort|felt|feel",
}
"""How experiments call our columns; of several, the first whose cells may be what is looked for is proposed."""
ENDING = re.compile(r"(?i)\.(csv|cue|json|txt|toml|wav|png|mp4)$")


class TrialsError(InputError):
    """A table of answers cannot be used; the message says what, where and the cure."""


@checked
def read_trials(
    path: str | Path | Sequence[str | Path],
    icons: IconSet | str | Path | Sequence[str],
    columns: Mapping[str, str] | None = None,
) -> Trials:
    """Read the answers of an identification experiment to icons of a set, whose names are all answers that there are.

    A CSV file has the columns participant, trial, presented and responded, where trials are numbered anew in each block
    also block; or one row per participant with icon_1, answer_1 and so on; or a matrix of counts, a row for each icon
    presented and a column for each answer, which is one group. Other columns are left alone, semicolons and tabs also
    separate them, and lines that begin with # are comments. A play that was not felt has an answer of `UNFELT`, such as
    an empty cell; others of `NOTHING`, such as missing, are no trials. Participants are in the order of the file. Icons
    may be written with other cases, with _ or a space for -, and as files with a folder.

    Parameters
    ----------
    path
        The file, or several, each of a participant, who is called like it where no column says it.
    icons
        The set, its name or file, or the names of its icons.
    columns
        What the file calls ours, such as ``{"responded": "answer"}``, its icons, such as ``{"dip": "num_2"}``, and what
        was not felt, such as ``{"none": "nothing felt"}``.

    Returns
    -------
    Trials
        The answers, counted.

    Raises
    ------
    TrialsError
        Says what is wrong, where, and what helps.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "trials.csv"
    ...     _ = path.write_text("participant,trial,presented,responded\\nP1,1,cool,cool\\nP1,2,warm,cool\\n")
    ...     read_trials(path, ["cool", "warm"])
    Trials(1 participant, 2 trials, 2 icons)
    """
    given = set_of(icons) if isinstance(icons, str | Path) else icons
    files = [Path(path)] if isinstance(path, str | Path) else [Path(each) for each in path]
    if not files:
        raise TrialsError("no file of answers is given; give at least one")
    names = tuple(each if isinstance(each, str) else each.name for each in given)
    places = {name: place for place, name in enumerate(names)}
    cells_meant = {*places, SILENT}
    theirs = {name: cell for name, cell in (columns or {}).items() if name not in cells_meant}
    for name in theirs.keys() - {*COLUMNS, "block"}:
        raise TrialsError(
            f"{name} is neither a column of answers nor an icon of the set; "
            f"{did_you_mean(name, (*COLUMNS, 'block', *cells_meant))}"
        )
    meant = _Cells(places, {cell: name for name, cell in (columns or {}).items() if name in cells_meant})
    runs: dict[str, list[dict[tuple[str, str], tuple[int, int]]]] = {}
    lines: dict[tuple[str, tuple[str, str]], int] = {}
    passed, strange, digests, owner = 0, ("", ""), list[str](), dict[str, Path]()
    folded = [name.casefold() for name in names]
    for file in files:
        table, digest = table_in(file, (*COLUMNS, "block"), EXAMPLE, WHAT, theirs)
        digests.append(digest)
        if not set(COLUMNS) & set(table.header) and not any(map(WIDE.fullmatch, table.header)):
            grid, _ = table_in(file, names, EXAMPLE, WHAT)
            table = grid if len(grid.rows) <= len(names) + 1 else table
        if "responded" not in table.header and len(places.keys() & set(table.header)) > 1:
            if len(files) > 1:
                raise TrialsError(f"{file}: a matrix of counts stands alone; give it without other files")
            matrix = _matrix(file, table, places, meant)
            return replace(_counted(matrix[None], names, ("all",), file.name, digest), grouped=True)
        for line, (participant, block, number, *said) in _asked(file, table, len(files) > 1, meant):
            where = f"{file}:{line}"
            cells = [meant.icon(cell) for cell in said]
            icon, answer = ("" if cell not in places and cell.casefold() in NOTHING else cell for cell in cells)
            silent = len(names) + (cells[1].casefold() not in UNFELT)
            if answer not in places and icon not in places and not nearest_words(icon.casefold(), folded, 1, ALIKE):
                passed, strange = passed + 1, strange if strange[0] else (icon, where)
                continue
            person, trial = label(participant, "participant", where), label(number, "trial", where)
            person = person if owner.setdefault(person, file) == file else file.stem
            key, own = (block, trial), runs.setdefault(person, [{}])
            shown = places[_icon(icon, "presented", places, where)]
            answered = places[_icon(answer, "responded", places, where)] if answer else silent
            if own[-1] and key == next(reversed(own[-1])):
                before, first_answer = own[-1][key]
                if before == shown and max(first_answer, answered) >= len(names):  # two screens of one trial
                    own[-1][key], passed = (shown, min(first_answer, answered)), passed + 1
                    continue
            if key in own[-1]:
                if len(own[-1]) == 1 or key != next(iter(own[-1])):
                    raise TrialsError(
                        f"{where}: participant {quoted(person)} has trial {quoted(trial)} twice, also in line "
                        f"{lines[person, key]}; number the trials on, add a column block, or remove the copy"
                    )
                own.append({})  # the numbers start anew, as they do with each block
            lines[person, key], own[-1][key] = line, (shown, answered)
    file = files[0]
    digest = digests[0] if len(files) == 1 else hashlib.sha256("".join(digests).encode()).hexdigest()[:16]
    check_labels(file, runs)
    counts = np.zeros((len(runs), len(names), len(names) + 2))
    for place, (person, own) in enumerate(runs.items()):
        if any(run == before for before, run in pairwise(own)):
            raise TrialsError(
                f"{file}: participant {quoted(person)} has the same trials twice, with the same icons and answers; "
                "remove the copy, or name the blocks in a column block"
            )
        pairs = list(chain.from_iterable(run.values() for run in own))
        np.add.at(counts[place], tuple(np.array(pairs).T), 1.0)
    if not counts[..., :-2].any():
        if strange[0]:
            _icon(strange[0], "presented", places, strange[1])
        raise TrialsError(f"{file}: no row has both an icon and an answer of the set: no names are left to score")
    return replace(_counted(counts, names, tuple(runs), file.name, digest), passed=passed)


class _Cells:
    """Icons that cells mean: by their names, by what a user said, by case and _, and by the name of a file."""

    def __init__(self, places: Mapping[str, int], said: Mapping[str, str]) -> None:
        self.known = {**{name: name for name in places}, **said}
        self.plain: dict[str, list[str]] = {}
        for cell, name in self.known.items():
            self.plain.setdefault(_plain(cell), []).append(name)

    def icon(self, cell: str) -> str:
        """The icon that a cell means; the cell itself where it means none, or several."""
        alike = self.plain.get(_plain(cell), [])
        return self.known.get(cell, alike[0] if len(alike) == 1 else cell)


def _plain(cell: str) -> str:
    """A name without folder, ending, case and kind of space."""
    return re.sub(r"[\s_]+", "-", ENDING.sub("", re.split(r"[/\\]", cell)[-1])).casefold()


def _counted(counts: Array, icons: tuple[str, ...], people: tuple[str, ...], file: str, digest: str) -> Trials:
    """Trials from counts (participants, icons, answers, not felt, missing); who has none took no part."""
    there = np.flatnonzero(counts[..., :-1].any(axis=(1, 2)))
    who, own = tuple(people[k] for k in there), counts[there]
    lost = int(counts[..., -1].sum())
    return Trials(icons, who, own[..., :-2], file, digest, own[..., -2], missing=lost)


def _asked(path: Path, table: Table, each: bool, meant: _Cells) -> Iterator[tuple[int, list[str]]]:
    """Line, and participant, block, trial, icon and answer of each trial, from one row per trial or per participant.

    Where `each` file is of a participant, it is called like the file where it has no such column.
    """
    own = path.stem if each and "participant" not in table.header else ""
    found = {(m[1] or m[3], m[2].lower() in ASKED): m[0] for m in map(WIDE.fullmatch, table.header) if m}
    numbers = dict.fromkeys(number for number, asked in found if number and asked and "presented" not in table.header)
    if not numbers:
        require(
            path,
            table,
            COLUMNS[1:] if own else COLUMNS,
            f"{EXAMPLE}, or, with one row per participant, {WIDE_EXAMPLE}",
            meant,
        )
        for line, row in table.records((*COLUMNS, "block")):
            yield line, [own or row["participant"], row.get("block", ""), *(row[column] for column in COLUMNS[1:])]
        return
    require(path, table, () if own else COLUMNS[:1], WIDE_EXAMPLE, meant)
    if single := [name for (number, asked), name in found.items() if number and (number, not asked) not in found]:
        raise TrialsError(f"{path}:{table.line}: {single[0]} stands alone; a trial has two columns: {WIDE_EXAMPLE}")
    for line, row in table.records(("participant", "block", *found.values())):
        for number in numbers:
            pair = row[found[number, True]], row[found[number, False]]
            yield line, [own or row["participant"], row.get("block", ""), number, *pair]


def _matrix(path: Path, table: Table, places: Mapping[str, int], meant: _Cells) -> Array:
    """Counts (icons, icons + 2) of a matrix: rows are icons presented, columns answers, then not felt, and missing."""
    first, *names = (name for place, name in enumerate(table.header) if name or not place)
    none = [name for name in names if name not in places and name.casefold() in NOTHING]
    top = f"{path}:{table.line}"
    said = [
        len(places) + (name.casefold() not in UNFELT)
        if name in none
        else places[_icon(meant.icon(name), "a column", places, top)]
        for name in names
    ]
    counts: Array = np.zeros((len(places), len(places) + 2))
    across, down = (re.search(OTHERS[name], first) for name in ("responded", "presented"))
    turned = across is not None and (down is None or across.start() < down.start())  # rows are answers
    for line, row in table.records((first, *names)):
        where = f"{path}:{line}"
        shown = places[_icon(meant.icon(row[first]), "a row", places, where)]
        cells = [row[name] or "0" for name in names]
        if counts[shown].any() or shown not in said:
            raise TrialsError(f"{where}: {row[first]} has two rows, or no column; an icon has one of each")
        numbers = [as_number(cell, table.mark) for cell in cells]
        if wrong := [cell for cell, size in zip(cells, numbers, strict=True) if size % 1 or not 0 <= size < MOST]:
            raise TrialsError(f"{where}: {quoted(wrong[0])} is not a count; {PER_CENT}")
        if turned and none:
            raise TrialsError(f"{top}: rows are answers, by {quoted(first)}; give silence as a row of its own set")
        np.add.at(counts[shown], said, numbers)  # silence may have several columns
    if turned:
        counts[:, :-2] = counts[:, :-2].T
    sums = counts.sum(axis=1)
    if not counts[:, :-2].any():
        raise TrialsError(f"{path}: every count is 0; write how often each answer was given")
    if (np.abs(sums[sums > 0] - 100) <= 1).all() and (sums[sums > 0] != 100).any():
        raise TrialsError(f"{path}: the rows sum to 99 to 101: these are per cents; {PER_CENT}")
    if (sums[sums > 0] == 100).all():
        warnings.warn(f"{path}: the rows sum to 100, read as counts; if they are per cents, {PER_CENT}", stacklevel=3)
    return counts


def table_in(
    path: Path, names: Sequence[str], example: str, what: str, columns: Mapping[str, str] | None = None
) -> tuple[Table, str]:
    """Return the table in a file, whose line of names has some of `names`, and 16 digits of the file's SHA-256."""
    data = read_bytes(path, what, MOST_MB, TrialsError)
    table = read_table(data, table_fault(path, TrialsError), example, MOST_ROWS, names, columns)
    return table, hashlib.sha256(data).hexdigest()[:16]


def require(path: Path, table: Table, needed: Sequence[str], example: str, meant: _Cells | None = None) -> None:
    """Raise a TrialsError where columns are missing, which lists those that were found, or where there is no row."""
    if missing := [name for name in needed if name not in table.header]:
        if "presented" in needed and {"kind", "value"} <= set(table.header):
            raise TrialsError(f"{path}:{table.line}: these are measurements, not answers; give them as measurements")
        free = [cell for cell in table.header if cell and cell not in (*needed, *table.names.renamed)]
        known = _proposed(table, missing, free, meant) if meant else {}
        raise TrialsError(
            f"{path}:{table.line}: {'column' if len(missing) == 1 else 'columns'} missing: {', '.join(missing)}; "
            f"found: {table.found}; write a line such as: {example}; or say what they are called"
        ).to(columns=known or {missing[0]: "THEIRS"})
    if not table.rows:
        raise TrialsError(f"{path}: no row below the names of the columns; write one row per trial")


def _proposed(table: Table, missing: Sequence[str], free: list[str], meant: _Cells) -> dict[str, str]:
    """Which free columns the missing ones may be: by their cells, icons or numbers, and then by their names."""
    texts = {cell: [*table.texts(cell)] for cell in free if table.header.count(cell) == 1}
    icons = [cell for cell, own in texts.items() if 2 * sum(meant.icon(each) in meant.known for each in own) > len(own)]
    numbers = [cell for cell, own in texts.items() if all(map(str.isdecimal, own))]
    known = dict[str, str]()
    for name in missing:
        left = [cell for cell in texts if cell not in known.values()]
        people = sorted({*left} - {*icons}, key=lambda cell: (len({*texts[cell]}), left.index(cell)))
        fit = {"trial": numbers, "participant": people}.get(name, icons)
        named = [cell for cell in (*fit, *left) if cell in left and re.search(OTHERS[name], cell)]
        likely = named or [cell for cell in fit if cell in left and fit is icons]
        known.update({name: likely[0]} if likely else {})
    return known


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


def _icon(cell: str, column: str, known: Mapping[str, int], where: str) -> str:
    name = label(cell, column, where)
    if name in known:
        return name
    where_to = {
        "responded": f"; where nothing was felt, leave the cell empty, or put {SILENT} for ICON",
        "a column": "; leave out totals",
    }
    hint = f"{did_you_mean(name, known)}{where_to.get(column, '')}; or say which it stands for"
    raise TrialsError(f"{where}: {column} is {quoted(name)}, which is not an icon of the set; {hint}").to(
        columns={next(iter(nearest_words(name, known)), "ICON"): name}
    )

"""A person who obeys: does to a file, or to its command, what the sentence that refuses it says."""

import ast
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from thermicon.base.files.column_names import Unit
from thermicon.base.files.table import as_number, read_table
from thermicon.circuit import read_drive
from thermicon.circuit.fitting.log import NAMES as LOG_NAMES
from thermicon.circuit.fitting.log import read_log
from thermicon.circuit.rig.rig import Rig
from thermicon.icons import parse
from thermicon.icons.recordings.recorded import NAMES, read_readings
from thermicon.notebooks.files.trace_files import COLUMNS, read_curves
from thermicon.notebooks.messages import is_ours
from thermicon.perception.pilot import measurements_file, trials_file

Options = dict[str, Any]
ICONS = ("cool-step", "warm-step", "dip", "cooling-step", "double-dip")


class Door(NamedTuple):
    """What reads a kind of file, by its path and options, and the columns that it knows."""

    read: Callable[..., Any]
    names: tuple[str, ...] = ()


DOORS = {
    "fit": Door(read_log, LOG_NAMES),
    "convert": Door(read_readings, NAMES),
    "compare": Door(lambda path, columns=None: read_curves(str(path), theirs=columns), COLUMNS[1:]),
    "simulate": Door(read_drive, ("time_s", "current_A")),
    "answers": Door(lambda path, columns=None: trials_file.read_trials(path, ICONS, columns), trials_file.COLUMNS),
    "measurements": Door(
        lambda path, columns=None: measurements_file.read_measurements(path, "thenar", columns),
        measurements_file.COLUMNS,
    ),
    "cue": Door(lambda path: parse(path.read_bytes(), path.name)),
    "rig": Door(Rig.load),
}
ELSEWHERE = (
    "export|save |convert|write (?:numbers|times|it|one row|how|its)|open it|unpack|as the (?:device|rig)|cut the file"
    "|put (?:semicolons|names)|own file|sort them|line is|keep (?:every|an hour)|split the|no column is left|are needed"
    "|add the (?:times|column)|give (?:the|size_K|one row)|name the blocks|number the trials|one of each|stands alone"
    "|at most 100|needs at least|log faster|whole number|units? of the times|connect it|without their decimals"
    "|no names are left|name another column|needed is|THEIRS|ICON"
)
"""Cures for which a person needs another program, another file, or to know what the sentence cannot."""
SCALES = {
    "subtract 273.15": (1.0, -273.15),
    "subtract 32 and divide by 1.8": (1 / 1.8, -32 / 1.8),
    "multiply by 86,400": (86_400.0, 0.0),
}
FACTOR = re.compile(r"divide (?:the column |it )?by ([\d,]+)")


def told(door: str, path: Path, options: Options) -> tuple[Any, Exception | None]:
    """What a door reads in a file, or the error that refuses it, which must be one of ours."""
    try:
        return DOORS[door].read(path, **options), None
    except Exception as error:
        assert is_ours(error), (door, options, error)
        return None, error


def obeyed(error: Exception, door: str, text: str, options: Options) -> tuple[str, str, Options] | None:
    """The door, the text and the options after one cure of an error; None where it needs what no sentence can give."""
    said = " ".join(str(error).split())
    lines = text.split("\n")
    if door == "cue":
        return _with_suggestions(error, lines)
    if door == "rig":
        after = _with_keys(said, text)
        return after if after and after[1] != text else None
    if "\0" in text:
        return None  # a person opens such a file in the program that wrote it
    if "as measurements" in said:
        return "measurements", text, {}
    place = re.search(r"\.\w+:(\d+)\b", said)
    at = int(place[1]) - 1 if place else -1
    meant = re.search(r"(\w+) is '(.*?)'.*did you mean (\S+?)[?;]", said)
    if place and meant and meant[2] in lines[at]:
        lines[at] = re.sub(rf"(?<![\w-]){re.escape(meant[2])}(?![\w-])", meant[3], lines[at], count=1)
        return door, "\n".join(lines), options
    if (found := re.search(r"\(columns=(\{.*\})\)", said)) and not re.search("THEIRS|ICON", found[1]):
        return door, text, {**options, "columns": {**options.get("columns", {}), **ast.literal_eval(found[1])}}
    if found := re.search(r"\(column='(.*)'\)", said):
        return door, text, {**options, "column": found[1]}
    if found := re.search(r"rows of '(.+?)' and .* follow one another", said):
        return door, "\n".join([lines[0], *(line for line in lines if f",{found[1]}," in line)]), options
    if found := re.search(r"call their column (time \(\w+\))", said):
        return door, re.sub(r"(?i)\btime\b *\(?\w*\)?", found[1], text, count=1), options
    factor = next((SCALES[words] for words in SCALES if words in said), None)
    if factor or (by := FACTOR.search(said)):
        factor = factor or (1 / float(by[1].replace(",", "")), 0.0)
        name = re.search(r"\b(\w+_(?:A|V|C|s)) (?:has|reaches|goes|runs)", said)
        assert name, said
        return door, _scaled(text, door, options, name[1], factor), options
    if place and re.search(r"remove (?:this line|it\b|the row|the copy)", said):
        more = re.findall(r"\d+", said.partition("likewise in line ")[2])
        for line in sorted({at - ("the row before" in said), *(int(each) - 1 for each in more)}, reverse=True):
            del lines[line]
        return door, "\n".join(lines), options
    if place and (found := re.search(r"the column (.+) appears twice", said)):
        before, _, after = lines[at].rpartition(found[1])
        lines[at] = f"{before}other{after}"
        return door, "\n".join(lines), options
    if place and (name := re.search(r"(\w+) (?:is (?:empty|['\"])|belongs to)", said)):
        cell = re.search(r"is '(.*?)'", said)
        for pattern in (r"write (\S+); units", r"choose of ([^,]+)"):
            if found := re.search(pattern, said):
                return door, _changed(text, door, options, at, name[1], found[1]), options
        if cell and "marks between thousands" in said:
            return door, _changed(text, door, options, at, name[1], re.sub(r"[., '](?=\d{3})", "", cell[1])), options
        if re.search("leave the cell empty|leave it empty", said):
            for line in {at, *(int(each) - 1 for each in re.findall(r"\d+", said.partition("likewise in line ")[2]))}:
                text = _changed(text, door, options, line, name[1], "")
            return (door, text, options) if text != "\n".join(lines) else None
    if found := re.search(r"no column ['\"](.+)['\"]; did you mean (\S+)\?", said):
        return (door, text.replace(found[1], found[2], 1), options) if found[1] in text else None
    if found := re.search(r"did you mean '(.+)'\? Spell", said):
        return door, re.sub(rf"(?i)\b{re.escape(found[1])}\b", found[1], text), options
    if place and (found := re.search(r"(\w+) is \S+(?: (\S+),)?.*(?:outside|lies within) (\S+) to", said)):
        bound = float(found[3]) * (1000 if found[2] in ("ms", "mK") else 1)
        return door, _changed(text, door, options, at, found[1], f"{bound:g}"), options
    if found := re.search(r"(\w+_[AV]) is .* no display takes more than (\S+)", said):
        most = float(found[2])
        return (
            door,
            _rewritten(text, door, options, found[1], lambda _, value: "" if abs(value) > most else None, True),
            options,
        )
    assert re.search(ELSEWHERE, said), said
    return None


def _with_suggestions(error: Any, lines: list[str]) -> tuple[str, str, Options] | None:
    first = next((each for each in error.errors if each.suggestion is not None), None)
    if first is None:
        assert all(each.help for each in error.errors), error
        return None
    place = 0 if first.code == "E009" else first.line - 1
    lines[place : place + (first.code != "E009")] = [first.suggestion]
    return "cue", "\n".join(lines), {}


def _with_keys(said: str, text: str) -> tuple[str, str, Options] | None:
    if found := re.search(r"([\w-]+): unknown key; did you mean (?:\w+\.)*(\w+)\b", said):
        return "rig", re.sub(rf"(?m)\b{found[1]}\b(?= = |\])", found[2], text), {}
    if found := re.search(r"(\w+) = (\S+?)(?: \S+)?: must be (?:at least|at most|greater than) (\S+)", said):
        bound = f"{found[1]} = {float(found[3]) or 1.0}"

        def bounded(line: re.Match[str]) -> str:
            return bound if float(line[1]) == float(found[2]) else line[0]

        return "rig", re.sub(rf"(?m)^{found[1]} = ([-+.\de]+)(?=$| +#)", bounded, text), {}
    return None


def _scaled(text: str, door: str, options: Options, name: str, factor: tuple[float, float]) -> str:
    """A text whose column of one of our names is multiplied and added to."""
    return _rewritten(text, door, options, name, lambda line, value: f"{value * factor[0] + factor[1]:.15g}")


def _changed(text: str, door: str, options: Options, at: int, name: str, new: str) -> str:
    """A text with another cell in a column and a line."""
    return _rewritten(text, door, options, name, lambda line, value: new if line == at + 1 else None)


def _rewritten(
    text: str, door: str, options: Options, name: str, change: Callable[[int, float], str | None], ours: bool = False
) -> str:
    """A text with other cells in a column, by their lines and numbers, or by the numbers that they are in our unit."""
    theirs = options.get("columns")
    table = read_table(
        text.encode("utf-8", "replace"), lambda *about: ValueError(about), "", 10**6, DOORS[door].names, theirs
    )  # type: ignore[arg-type, return-value]
    if name not in table.header:
        return text  # of a wide table, which has such a cell for each trial
    lines, at, mark = text.split("\n"), table.header.index(name), table.mark or ","
    factor = table.names.renamed.get(name, ("", Unit("")))[1].factor if ours else 1.0
    for line, row in zip(table.lines, table.rows, strict=True):
        cell = row[at] if at < len(row) else ""
        new = change(line, factor * as_number(cell, table.mark))
        if new in (None, cell, "nan"):
            continue
        parts = re.split(rf"(?<![\w.]){re.escape(cell)}(?![\w.])", lines[line - 1])
        before = sum(other == cell for other in row[:at])
        if cell and len(parts) > before + 1:
            lines[line - 1] = cell.join(parts[: before + 1]) + str(new) + cell.join(parts[before + 1 :])
        else:
            padded = [*row, *([""] * (at - len(row)))]
            lines[line - 1] = mark.join([*padded[:at], str(new), *padded[at + 1 :]])
    return "\n".join(lines)

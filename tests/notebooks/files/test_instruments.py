"""Forms that instruments write: read at once or by obeying a sentence, with the numbers that were written."""

import ast
import re
import warnings
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks.files.instrument_forms import FORMS, MET, Form, right
from tests.notebooks.files.test_forms import DOORS, REFUSED, outcome
from thermicon.icons.recordings.recorded import Readings, read_readings
from thermicon.notebooks.messages import is_ours

Options = dict[str, Any]
SCALES = {
    "subtract 273.15": (1.0, -273.15), "subtract 32 and divide by 1.8": (1 / 1.8, -32 / 1.8),
    "divide by 1000": (0.001, 0.0), "divide by 100": (0.01, 0.0), "divide by 10": (0.1, 0.0),
}  # fmt: skip
"""What cures do to the numbers of a temperature."""
ELSEWHERE = "export|save |convert|write numbers|write times|add the times|put semicolons|own file|sort them|line is"
"""Cures for which a person needs another program, or another file."""


def obeyed(said: str, text: str, options: Options) -> tuple[str, Options]:
    """The text and the options after a person did what a sentence says."""
    said = " ".join(said.split())
    if found := re.search(r"\(columns=(\{.*\})\)", said):
        columns = ast.literal_eval(found[1])
        assert "THEIRS" not in columns.values(), said
        return text, {**options, "columns": {**options.get("columns", {}), **columns}}
    if found := re.search(r"call their column (time \(\w+\))", said):
        return re.sub(r"(?i)\btime\b *\(?\w*\)?", found[1], text, count=1), options
    if found := re.search(r"(\w+_[AV]) reaches .* divide it by 1000", said):
        head, *rows = (line.split(",") for line in text.strip().split("\n"))
        at = head.index(found[1])
        changed = ([*row[:at], f"{float(row[at]) / 1000:.9g}", *row[at + 1 :]] for row in rows)
        return "\n".join(",".join(row) for row in (head, *changed)), options
    if found := re.search(r":(\d+)[: ].*remove (?:this line|it|the row)", said):
        lines = text.split("\n")
        del lines[int(found[1]) - 1 - ("the row before" in said)]
        return "\n".join(lines), options
    if found := re.search(r"divide the column by ([\d,]+)", said):
        by = float(found[1].replace(",", ""))
        return re.sub(r"(?m)^\d[\d.]*", lambda m: f"{float(m[0]) / by:.9g}", text), options
    scale = next(each for words, each in SCALES.items() if words in said)
    return re.sub(r"(?m)(-?\d+(?:\.\d+)?)\s*$", lambda m: f"{float(m[1]) * scale[0] + scale[1]:.6g}", text), options


def read(path: Path, text: str, options: Options) -> tuple[Readings | None, str]:
    """The readings in a text, or what is said of it."""
    path.write_text(text, "cp932" if "電" in text or "時間(s)" in text else "utf-8")
    given = {key: value for key, value in options.items() if key != "control"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return read_readings(path, **given), ""
        except Exception as error:
            assert is_ours(error), error
            return None, str(error)


def attempts(path: Path, made: Form) -> list[str]:
    """What is said at each attempt, "" where the right numbers are read: the first, and two that obey."""
    text, options, said = made.text, made.options, list[str]()
    for _ in range(3):
        found, told = read(path, text, options)
        assert found is None or right(found.time_s, found.level_C, made), (made.name, found)
        said.append(told)
        if found is not None or re.search(ELSEWHERE, told):
            break
        text, options = obeyed(told, text, options)
    return said


def test_most_forms_are_read_at_once_and_the_others_by_obeying_a_sentence(tmp_path: Path) -> None:
    said = {made.name: attempts(tmp_path / "a.csv", made) for made in FORMS if made.name not in UNREAD}
    assert len(FORMS) == 80 and sum(each[0] == "" for each in said.values()) >= 60
    assert not {name: each for name, each in said.items() if each[-1]}
    groups = [made.group for made in FORMS]
    assert min(map(groups.count, groups)) >= 5 and all(made.source for made in FORMS)


UNREAD = {"ESPHome log", "Teleplot", "BIOPAC AcqKnowledge text"}
"""Refused in words: a clock within a word, two numbers behind a label, a count above the rows."""


@pytest.mark.parametrize("made", [made for made in FORMS if made.name in UNREAD], ids=lambda made: made.name)
def test_a_form_that_is_not_read_gives_no_wrong_number(tmp_path: Path, made: Form) -> None:
    found, said = read(tmp_path / "a.csv", made.text, {})
    assert (found is None and "no line names" in said) or "rows have " in said


@pytest.mark.parametrize("made", MET, ids=lambda made: made.name)
def test_a_table_that_was_met_is_read_or_its_cause_is_named_and_its_cure_works(tmp_path: Path, made: Form) -> None:
    said = attempts(tmp_path / "a.csv", made)
    assert re.search(made.said, " ".join(said[0].split())) if made.said else said == [""]
    assert len(set(said)) == len(said) and (said[-1] == "" or re.search(ELSEWHERE, said[-1])), said


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("name", REFUSED)
def test_a_cure_of_a_refused_table_leads_to_the_numbers_or_to_another_cause(
    tmp_path: Path, name: str, door: str
) -> None:
    data, path = REFUSED[name][0], tmp_path / "a.csv"
    text, options = data.decode("utf-8", "replace") if isinstance(data, bytes) else data, Options()
    said = list[str]()
    for _ in range(3):
        path.write_text(text, "utf-8")
        good, told = outcome(DOORS[door], path, options.get("columns", {}))
        said.append("" if good else told)
        if good or re.search(ELSEWHERE, told):
            break
        text, options = obeyed(told, text, options)
    assert len(set(said)) == len(said) and (said[-1] == "" or re.search(ELSEWHERE, said[-1])), said

"""Cures are obeyed at all doors: a sentence that refuses a file leads to the right numbers, or to another cause.

THERMICON_TABLES=2000 damages so many files of each package of doors in place of 200.
"""

import os
import random
import re
import resource
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks.cli.test_fuzz_inputs import SLOWEST_S, mutate
from tests.notebooks.files.instrument_forms import FORMS, MET, Form, right
from tests.notebooks.files.obeying import ELSEWHERE, Options, obeyed, told
from tests.notebooks.files.test_forms import DOORS as COLUMNS_AT
from tests.notebooks.files.test_forms import FORMS as TABLES
from tests.notebooks.files.test_forms import REFUSED
from tests.notebooks.files.test_forms import right as right_columns
from tests.notebooks.readers import KINDS
from tests.perception.pilot import test_tables

COUNT, MOST_MORE_GB = int(os.environ.get("THERMICON_TABLES", "200")), 0.6
UNREAD = {"ESPHome log", "Teleplot", "BIOPAC AcqKnowledge text", "Empatica E4 TEMP.csv"}
"""Refused in words: a clock within a word, two numbers behind a label, a count or a rate above the rows."""
TABLE_DOORS = ("fit", "convert", "compare", "simulate")


def attempts(
    path: Path, door: str, data: str | bytes, options: Options, right: Callable[[Any, Options], bool] = lambda *_: True
) -> list[str]:
    """What is said at each attempt, "" where a file is read as is right: the first, and two that obey."""
    data = data.encode("utf-8", "replace") if isinstance(data, str) else data
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("cp932" if "電".encode("cp932") in data else "latin-1")
    text, said = text.replace("\r\n", "\n").replace("\r", "\n"), list[str]()
    for _ in range(3):
        path.write_bytes(data)
        with warnings.catch_warnings(record=True) as raised:
            warnings.simplefilter("always")
            found, error = told(door, path, options)
        if error is None and right(found, options):
            return [*said, ""]
        notes = [*map(str, getattr(found, "notes", ())), *(str(each.message) for each in raised)]
        error = error or ValueError(" ".join(notes))
        sentence = " ".join(str(error).split())
        headless = door == "rig" and "is missing" in sentence  # keys of a table that lost its name need a person
        assert sentence not in said or headless or "remove" in sentence + said[-1], (door, sentence, data[:300])
        said.append(sentence)
        if (after := obeyed(error, door, text, options)) is None:
            break
        door, text, options = after
        data = text.encode("utf-8", "replace")
    return said


def largest_gb() -> float:
    """Memory that this process had at most, in which other tests ran before."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def form_attempts(path: Path, made: Form) -> list[str]:
    data = made.text.encode("cp932" if "電" in made.text or "時間(s)" in made.text else "utf-8")
    options = {key: value for key, value in made.options.items() if key != "control"}
    return attempts(path, "convert", data, options, lambda found, _: right(found.time_s, found.level_C, made))


def test_most_forms_are_read_at_once_and_the_others_by_obeying_a_sentence(tmp_path: Path) -> None:
    said = {made.name: form_attempts(tmp_path / "a.csv", made) for made in FORMS if made.name not in UNREAD}
    assert len(FORMS) == 80 and sum(each[0] == "" for each in said.values()) >= 60
    assert not {name: each for name, each in said.items() if each[-1]}
    groups = [made.group for made in FORMS]
    assert min(map(groups.count, groups)) >= 5 and all(made.source for made in FORMS)


@pytest.mark.parametrize("made", [made for made in FORMS if made.name in UNREAD], ids=lambda made: made.name)
def test_a_form_that_is_not_read_gives_no_wrong_number(tmp_path: Path, made: Form) -> None:
    (tmp_path / "a.csv").write_text(made.text)
    assert re.search("no line names|rows have ", str(told("convert", tmp_path / "a.csv", {})[1]))


@pytest.mark.parametrize("made", MET, ids=lambda made: made.name)
def test_a_table_that_was_met_is_read_or_its_cause_is_named_and_its_cure_works(tmp_path: Path, made: Form) -> None:
    said = form_attempts(tmp_path / "a.csv", made)
    assert re.search(made.said, said[0]) if made.said else said == [""]


@pytest.mark.parametrize("door", TABLE_DOORS)
@pytest.mark.parametrize("name", REFUSED)
def test_a_refused_table_is_named_and_its_cure_leads_to_the_numbers(tmp_path: Path, name: str, door: str) -> None:
    data, words = REFUSED[name]

    def sound(_: object, options: Options) -> bool:
        return right_columns(COLUMNS_AT[door](tmp_path / "a.csv", options.get("columns", {})))

    said = attempts(tmp_path / "a.csv", door, data, {}, sound)
    assert said[0] == "" or re.search(words, said[0]), said
    assert said[-1] == "" or re.search(ELSEWHERE, said[-1]), said


TRIALS = (
    *test_tables.MESSAGES["trials"],
    *("\n".join(test_tables.table_of(shape, test_tables.asked_and_said())) for shape in ("wide", "matrix", "stimuli")),
)
VALUES = ["\n".join((test_tables.VALUES, *test_tables.GOOD, row, "")) for row in test_tables.MESSAGES["measurements"]]
PILOTS = [*(("answers", each) for each in TRIALS), *(("measurements", each) for each in VALUES)]
SOUND: dict[str, tuple[tuple[str, ...], list[str | bytes]]] = {
    "tables": (TABLE_DOORS, [*TABLES.values(), *(data for data, _ in REFUSED.values()),
                             *(each.text for each in (*FORMS, *MET))]),
    "answers": (("answers",), [*TRIALS]), "measurements": (("measurements",), [*VALUES]),
    "cue": (("cue",), [*KINDS["cue"].texts]), "rig": (("rig",), [*KINDS["rig"].texts]),
}  # fmt: skip


@pytest.mark.parametrize(
    ("door", "text"), [*(("answers", each) for each in TRIALS), *(("measurements", each) for each in VALUES)]
)
def test_a_cure_of_a_refused_pilot_leads_to_another_cause(tmp_path: Path, door: str, text: str) -> None:
    attempts(tmp_path / "a.csv", door, text, {})


@pytest.mark.parametrize("kind", SOUND)
@pytest.mark.parametrize("count", [COUNT, pytest.param(10 * COUNT, marks=pytest.mark.slow)])
def test_damaged_files_are_read_or_refused_with_cures_that_lead_on(tmp_path: Path, kind: str, count: int) -> None:
    rng, (doors, sound) = random.Random(f"cures of {kind}"), SOUND[kind]
    before = largest_gb()
    for _ in range(count):
        data = rng.choice(sound)
        text = data if isinstance(data, str) else data.decode("latin-1")
        for _ in range(rng.choice([1, 1, 1, 2, 4])):
            text = mutate(text, rng)
        spoilt = text.encode("utf-8", "replace") if isinstance(data, str) else text.encode("latin-1", "replace")
        for door in doors:
            begin = time.process_time()
            attempts(tmp_path / ("a.toml" if kind == "rig" else "a.csv"), door, spoilt, {})
            assert time.process_time() - begin < 3 * SLOWEST_S, (door, spoilt)
    assert largest_gb() - before < MOST_MORE_GB

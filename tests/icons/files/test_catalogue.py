"""Every example of the catalogue of errors does what it promises."""

import re
from pathlib import Path

import pytest

from thermicon.icons import CueErrors, parse, read_cue
from thermicon.icons.files.catalogue import Entry, catalogue, explain
from thermicon.icons.model.errors import codes

ENTRIES = list(catalogue().values())
SHOWN = [entry for entry in ENTRIES if entry.wrong]


def test_every_code_is_listed() -> None:
    assert list(catalogue()) == sorted(codes())
    assert all(entry.meaning.endswith(".") and bool(entry.wrong) != bool(entry.cure) for entry in ENTRIES)


@pytest.mark.parametrize("entry", SHOWN, ids=lambda entry: entry.code)
def test_the_wrong_example_gives_this_error_alone_and_the_right_one_none(entry: Entry) -> None:
    with pytest.raises(CueErrors, match=entry.code) as caught:
        parse(entry.wrong, "alerts.cue")
    assert [error.code for error in caught.value.errors] == [entry.code]
    assert str(caught.value) == entry.message()
    assert len(parse(entry.right))


def test_the_codes_without_an_example_are_those_of_the_door(tmp_path: Path) -> None:
    made = {"E004": b"#" * 300_000, "E005": b" \n", "E006": b"cue 1\0", "E007": "icon é".encode("latin-1")}
    for code, data in made.items():
        (tmp_path / code).write_bytes(data)
    paths = {"E001": tmp_path / "none.cue", "E002": tmp_path, **{code: tmp_path / code for code in made}}
    recorded = {"E013", "E014", "E015", "E016"}  # read by tests/icons/recordings/test_recorded.py
    assert {entry.code for entry in ENTRIES if not entry.wrong} == {*paths, "E003"} | recorded
    for code, path in paths.items():
        with pytest.raises(CueErrors, match=code):
            read_cue(path)


def test_explain_gives_the_section() -> None:
    text = explain(" e102 ")
    assert text.startswith("E102 missing unit\nEvery number needs a unit")
    assert "\n  alerts.cue:3:11  E102 missing unit\n" in text
    assert explain("102") == text
    assert "Split the set" in explain("E004")


@pytest.mark.parametrize(
    ("code", "nearest"),
    [("E199", "E1"), ("missing units", "E102 missing unit"), ("", "E"), ("x" * 1000, "nearest are")],
)
def test_an_unknown_code_is_told_with_its_neighbours(code: str, nearest: str) -> None:
    with pytest.raises(ValueError, match=rf"there is no error .*; the nearest are .*{nearest}|nearest are") as caught:
        explain(code)
    assert nearest in str(caught.value)
    assert len(re.findall(r"E\d\d\d ", str(caught.value))) == 2

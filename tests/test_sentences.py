"""What verdicts, notes and refusals say, whole; and that no slip in a module that says it goes unnoticed.

A new sentence needs a case of `sentences.py` on both sides of its condition, or it is named here as missed.
"""

import tomllib
from copy import deepcopy
from pathlib import Path
from types import ModuleType

import pytest

from tests import sentences
from tests.missed import Cases, missed, said
from thermicon.base.files.inputs import shipped_table
from thermicon.circuit.delivery import prepare
from thermicon.circuit.safety import words
from thermicon.notebooks.report import gate_words

SAID = tomllib.loads((Path(__file__).parent / "sentences.toml").read_text(encoding="utf-8"))
MODULES: dict[str, tuple[ModuleType, Cases]] = {
    "words": (words, sentences.WORDS),
    "gate_words": (gate_words, sentences.GATE_WORDS),
    "prepare": (prepare, sentences.PREPARE),
}


def text(result: object) -> str:
    """What a case says, in one text."""
    return " | ".join(map(text, result)) if isinstance(result, list | tuple) else str(result)


@pytest.mark.parametrize("name", MODULES)
def test_everything_is_said_as_it_was_agreed(name: str) -> None:
    module, cases = MODULES[name]
    assert {name: text(case(module)) for name, case in cases.items()} == SAID[name]


@pytest.mark.parametrize("name", MODULES)
def test_a_slip_in_what_is_said_is_noticed(name: str) -> None:
    """Such as a condition turned, a number moved by a fiftieth, a quotient in place of a product, a text left out."""
    assert missed(*MODULES[name]) == []


def test_every_line_on_single_faults_is_said_by_some_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    table = shipped_table(words.FAULT_WORDS)
    cases = {name: case for name, case in sentences.WORDS.items() if name.startswith("fault")}
    monkeypatch.setattr(words, "shipped_table", lambda _: deepcopy(table))
    for kind, entry in table.items():
        places = [(entry, "name"), (entry, "does")]
        places += [(row, column) for row in entry["prevented"] for column in range(3) if row[column]]
        for where, place in places:
            whole = where[place]
            where[place] = ""
            assert any(text(said(case, words)) != SAID["words"][name] for name, case in cases.items()), (kind, whole)
            where[place] = whole

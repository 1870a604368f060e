"""The kept tables of the grammar read as the grammar does, and are made again where they are damaged."""

from importlib import resources
from pathlib import Path

import pytest

from thermicon.icons.language import grammar_tables
from thermicon.icons.language.grammar_tables import built, grammar, packed, unpacked
from thermicon.icons.userfolder import HASH_BYTES

CUE = resources.files("thermicon.icons").joinpath("library", "six-icons.cue").read_text(encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    tmp_path.chmod(0o700)
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))
    monkeypatch.setattr(grammar_tables, "grammar", grammar.__wrapped__)
    return tmp_path / "grammar"


def test_the_second_reader_uses_the_tables_of_the_first(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = grammar_tables.grammar()
    (kept,) = folder.iterdir()
    monkeypatch.setattr(grammar_tables, "built", None)  # would fail if it were called
    assert grammar_tables.grammar().parse(CUE) == first.parse(CUE)
    assert kept.stat().st_mode & 0o077 == 0


def test_damaged_tables_are_made_again(folder: Path) -> None:
    grammar_tables.grammar()
    (kept,) = folder.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[:-1] + b"x")
    assert grammar_tables.grammar().parse(CUE).data == "start"
    assert unpacked(kept.read_bytes()) is not None


def test_without_a_private_folder_the_grammar_is_read_all_the_same(folder: Path) -> None:
    folder.parent.chmod(0o777)
    assert grammar_tables.grammar().parse(CUE).data == "start"
    assert not folder.exists() or not list(folder.iterdir())


def test_terminals_and_options_survive() -> None:
    text = resources.files("thermicon.icons").joinpath("grammar.lark").read_text(encoding="utf-8")
    fresh = built(text)
    kept = unpacked(packed(fresh))
    assert kept is not None
    assert [each.name for each in kept.terminals] == [each.name for each in fresh.terminals]
    assert kept.options.propagate_positions
    assert len(packed(fresh)) > HASH_BYTES

"""The private state of lark that recovery depends on."""

import pickle
import re
import sys
from importlib import resources
from pathlib import Path

import pytest
from lark import Lark, Token

from thermicon.base.files.cache_folder import sealed_content
from thermicon.icons.language.grammar import grammar
from thermicon.icons.model.units import UNITS
from thermicon.icons.model.words import CLAUSES, VOCABULARY

CUE = resources.files("thermicon.icons").joinpath("library", "six-icons.cue").read_text(encoding="utf-8")


def test_the_lexer_can_be_moved_to_an_offset() -> None:
    parser = grammar().parse_interactive(CUE)
    parser.lexer_thread.state.line_ctr.char_pos = CUE.index("icon ")
    token = next(parser.lexer_thread.lex(parser.parser_state))
    assert (token.type, token.start_pos) == ("ICON", CUE.index("icon "))


def test_both_stacks_can_be_unwound_together() -> None:
    parser = grammar().parse_interactive("")
    state = parser.parser_state
    depth = len(state.state_stack)
    parser.feed_token(Token("CUE", "cue", 0, 1, 1, 1, 1, 3))
    assert (len(state.state_stack), len(state.value_stack)) == (depth + 1, depth)
    state.state_stack.pop()
    state.value_stack.pop()
    parser.feed_token(Token("BROKEN", "", 0, 1, 1, 1, 1, 0))
    assert [token.type for token in parser.feed_eof().children] == ["BROKEN"]


def test_the_table_gives_an_action_and_where_it_leads() -> None:
    parser = grammar().parse_interactive("")
    states = parser.parser_state.parse_conf.states
    first = states[parser.parser_state.state_stack[-1]]
    action, state = first["CUE"]
    assert (action.name, type(state)) == ("Shift", int)
    rules = {entry[1] for table in states.values() for entry in table.values() if entry[0].name == "Reduce"}
    assert {"icon", "statement"} & {str(rule.origin.name).lstrip("_") for rule in rules}
    assert all(isinstance(rule.expansion, list | tuple) for rule in rules)
    assert {kind for kind in first if kind.isupper()} == parser.accepts()


def test_words_and_units_that_editors_colour_are_those_of_the_grammar() -> None:
    text = resources.files("thermicon.icons").joinpath("grammar.lark").read_text(encoding="utf-8")
    code, quantity = re.sub(r"//[^\n]*", "", text), r"(?m)^[A-Z_]*(?:ABSOLUTE|DIFFERENCE|RATE|TIME|CURRENT): .*$"
    assert set(re.findall(r'"([a-z]+)"', re.sub(quantity, "", code))) == {*CLAUSES}.union(*VOCABULARY.values())
    units = re.findall(r'"([^"]+)"', " ".join(re.findall(quantity, code)))
    assert set(units) == {unit for kind in UNITS.values() for unit in kind if unit}


@pytest.mark.skipif(sys.platform == "win32", reason="owners and modes are those of POSIX")
def test_kept_tables_read_the_same_and_no_others_are_unpickled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))
    made = grammar.__wrapped__()
    (kept,) = (tmp_path / "grammar").iterdir()
    whole, read = kept.read_bytes(), list[bytes]()
    monkeypatch.setattr(Lark, "load", lambda file: read.append(file.read()) or made)

    def is_read() -> bool:
        read.clear()
        grammar.__wrapped__()
        return bool(read)

    assert is_read()
    for broken in (b"", whole[:-1], whole[:32] + pickle.dumps(print)):
        kept.write_bytes(broken)
        assert sealed_content(kept) is None
        assert not is_read()
        assert sealed_content(kept) is not None, "they are made again"
    kept.chmod(0o666)
    assert not is_read()
    (elsewhere := tmp_path / "elsewhere").write_bytes(whole)
    kept.unlink()
    kept.symlink_to(elsewhere)
    assert not is_read()
    (tmp_path / "grammar").chmod(0o777)
    assert not is_read()


def test_cue_text_is_read_from_kept_tables_as_from_new(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))
    first, second = (grammar.__wrapped__().parse(CUE) for _ in range(2))
    assert first == second

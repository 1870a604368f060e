"""Colours of cue text: every shipped file is coloured whole, with the words of the grammar and no others."""

import re
from importlib import resources
from importlib.metadata import entry_points

import pytest
from pygments.lexers import get_lexer_by_name, guess_lexer_for_filename
from pygments.token import Error, Keyword, Name, Number, String, Token

from thermicon.icons.files.shipped import library_names
from thermicon.icons.language.highlight import KEYWORDS, NAME, NUMBER, SPELLINGS, CueLexer

PACKAGE = resources.files("thermicon.icons")
GRAMMAR = PACKAGE.joinpath("grammar.lark").read_text(encoding="utf-8")
TEXTS = {name: PACKAGE.joinpath(f"library/{name}.cue").read_text(encoding="utf-8") for name in library_names()}
EVERYTHING = """cue 1
set all "Everything \\"there\\" is" { site thenar; control display; baseline 32 °C; doi "10.1/x"; tags "a, b" }
icon hold(amount in [-6, 6] °C, pause in 1..3 step 0.5 s, n in [1,2]) means "{amount}\\n" by "A" licence "MIT" {
  change by amount at 3K/s ; hold for pause # a comment
  repeat n { step cool by 1 K; hold for 1e-1min; return over .5 s; rest for 200 ms }
  pulse by −3 °C for 500 ms
  sawtooth by 3 °C every 4 s for 10 s starting cool cut
  total at most 1 min; total pause
}
icon other { play hold_amount=-6_pause=1.5_n=1; warm to 38 degC at 1 °C/min; to 0.5 A at 10 mA/s }
"""


def tokens(text: str) -> list[tuple[object, str]]:
    return list(CueLexer(stripnl=False, ensurenl=False).get_tokens(text))


def kinds(text: str) -> dict[str, object]:
    return {part: kind for kind, part in tokens(text) if part.strip()}


@pytest.mark.parametrize("text", [*TEXTS.values(), EVERYTHING], ids=[*TEXTS, "everything"])
def test_nothing_is_an_error_and_nothing_is_lost(text: str) -> None:
    found = tokens(text)
    assert [part for kind, part in found if kind is Error] == []
    assert "".join(part for _, part in found) == text


def test_the_words_are_those_of_the_grammar() -> None:
    code = re.sub(r"//[^\n]*", "", GRAMMAR)
    units = re.findall(
        r'"([^"]+)"', " ".join(re.findall(r"^[A-Z_]*(?:ABSOLUTE|DIFFERENCE|RATE|TIME|CURRENT): .*$", code, re.M))
    )
    rest = re.sub(r"^(?:ABSOLUTE|DIFFERENCE|RATE|TIME|CURRENT|CURRENT_RATE): .*$", "", code, flags=re.M)
    assert set(re.findall(r'"([a-z]+)"', rest)) == KEYWORDS
    assert set(units) == set(SPELLINGS)


@pytest.mark.parametrize(("name", "pattern"), [("NAME", NAME), ("NUMBER", NUMBER)])
def test_names_and_numbers_are_those_of_the_grammar(name: str, pattern: str) -> None:
    written = re.search(rf"^{name}: /(.*)/$", GRAMMAR, re.MULTILINE)
    assert written is not None
    assert pattern.replace("(?:", "(") == written[1]


def test_every_word_is_coloured_by_its_place() -> None:
    found = kinds(EVERYTHING)
    assert found["hold_amount=-6_pause=1.5_n=1"] is Name.Function
    assert (found["amount"], found["pause"], found["n"]) == (Name.Variable,) * 3
    assert (found["display"], found["thenar"]) == (Keyword.Constant, Name.Constant)
    assert (found["means"], found["A"], found["\\n"]) == (Name.Attribute, Keyword.Type, String.Escape)
    assert (found["K/s"], found["mA/s"], found["min"], found["degC"]) == (Keyword.Type,) * 4
    assert (found["−3"], found[".5"], found["1e-1"]) == (Number,) * 3
    assert (found["most"], found["cut"], found["total"], found["step"]) == (Keyword,) * 4
    assert kinds("icon hold { }")["hold"] is Name.Function
    assert kinds("on thumb { }") == {
        "on": Keyword.Reserved,
        "thumb": Name,
        "{": Token.Punctuation,
        "}": Token.Punctuation,
    }


def test_what_is_wrong_is_not_coloured_as_right() -> None:
    assert kinds("holdfor 4 s")["holdfor"] is Name
    assert kinds("hold for 4 sec")["sec"] is Name
    assert kinds("cool by 6 °F")["°"] is Error
    assert tokens('means "never closed\nhold')[-1] == (Keyword, "hold")


def test_it_is_found_by_name_and_by_file() -> None:
    (own,) = (point for point in entry_points(group="pygments.lexers") if point.value.endswith(":CueLexer"))
    assert own.load() is CueLexer
    for alias in ("cue", "thermal-cue"):
        assert isinstance(get_lexer_by_name(alias), CueLexer)
    assert isinstance(guess_lexer_for_filename("mine.cue", TEXTS["six-icons"]), CueLexer)


def test_cue_text_is_told_from_other_files_of_that_name() -> None:
    assert CueLexer.analyse_text("# a comment\n\ncue 1\n") == 1.0
    assert CueLexer.analyse_text("package cue\n\nx: 1\n") == 0.0

"""Totality of parsing: a set or CueErrors for any text."""

import re
import time
from itertools import count
from typing import Any

import pytest
from hypothesis import strategies as st

from tests.builders import messages
from tests.properties import for_any
from thermicon.icons import CueErrors, IconSet, load_library, parse
from thermicon.icons.language.source import MOST_BYTES

TEXT = """cue 1 icon set { } ; " cool warm by to 6 °C K s ms at over return hold for repeat rest 3 -1 1e999 0 @ # means
tags site control baseline skin current A A/s on sine ( a-b a_b \\ BROKEN é
change step pulse square triangle sawtooth by every starting up down cut play total most least in ) [ ] , .. . x y
x_y=1 {x} 1..3 [1,2] (x -6 2.5 °C/s mA"""
WORDS = [*re.findall(r"\S+", TEXT), "\n", "\u2028", "\t"]


def parsed(text: str | bytes) -> IconSet | None:
    try:
        icons = parse(text)
    except CueErrors as found:
        assert found.errors
        assert str(found)
        assert all(1 <= e.column <= len(e.source) + 1 for e in found.errors if e.line)
        assert list(found.errors) == sorted(found.errors, key=lambda e: (e.line, e.column))
        return None
    assert parse(str(icons)) == icons
    return icons


PARAMETERS = [*re.findall(r"\S+", "x y in [ ] ( ) , .. step 1 -2 0.5 K °C/s s { 1..3"), "\n"]


@for_any(
    st.lists(st.sampled_from(PARAMETERS), max_size=16), st.lists(st.sampled_from(WORDS), max_size=10), examples=200
)
def test_any_family(parameters: list[str], words: list[str]) -> None:
    parsed(f"cue 1\nicon f({' '.join(parameters)}) {{ change by x at 1 K/s; {' '.join(words)} }}")


@for_any(st.text(), examples=150)
def test_any_text(text: str) -> None:
    parsed(text)


@for_any(st.binary(), examples=100)
def test_any_bytes(data: bytes) -> None:
    parsed(data)


@for_any(st.lists(st.sampled_from(WORDS), max_size=40), st.sampled_from(["", " "]), st.booleans(), examples=250)
def test_any_words(words: list[str], between: str, inside: bool) -> None:
    text = between.join(words)
    parsed(f"cue 1\nicon x {{ {text} }}" if inside else text)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_any_newline_and_a_byte_order_mark(newline: str) -> None:
    text = str(load_library("six-icons")).replace("\n", newline)
    assert parse("\ufeff" + text) == load_library("six-icons")
    with pytest.raises(CueErrors, match=r"a\.cue:2:19  E102"):
        parse(newline.join(["cue 1", "icon x { hold for 4 }"]), "a.cue")


HOSTILE = messages(__file__, "hostile.toml")


def text_of(row: dict[str, Any]) -> str:
    """A text as it stands, or one of nearly the largest size: units between head and tail, `<n>` being its number."""
    if "text" in row:
        return str(row["text"])
    parts, left = [row["head"]], MOST_BYTES - len((row["head"] + row.get("tail", "")).encode())
    for n in count():
        part = row["unit"].replace("<n>", str(n)).replace("<n+1>", str(n + 1)).replace("<n+2>", str(n + 2))
        left -= len(part.encode())
        if left < 0:
            break
        parts.append(part)
    return "".join(parts) + row.get("tail", "")


def soon(row: dict[str, Any]) -> None:
    text = text_of(row)
    begin = time.process_time()
    try:
        assert parse(text).entries
        assert not row["code"]
    except CueErrors as found:
        assert str(found)
        assert row["code"] in {error.code for error in found.errors}, str(found.errors[0])
    assert time.process_time() - begin < 20


@pytest.mark.parametrize("name", HOSTILE["quick"])
def test_a_hostile_text_is_answered_soon(name: str) -> None:
    soon(HOSTILE["quick"][name])


@pytest.mark.parametrize("repeats", [16, 20])
def test_plays_that_double_are_counted(repeats: int) -> None:
    plays = "".join(f"icon i{n} {{ play i{n + 1}; play i{n + 1} }}\n" for n in range(repeats))
    soon({"text": f"cue 1\n{plays}icon i{repeats} {{ rest for 1 ms }}", "code": "E220" if repeats > 16 else ""})


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE["full"])
def test_a_text_of_the_largest_size_is_answered_soon(name: str) -> None:
    soon(HOSTILE["full"][name])

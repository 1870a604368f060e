"""Parsing is total: whatever the text, there is a set or there are CueErrors, soon, and nothing else."""

import re
import time

import pytest
from hypothesis import strategies as st

from tests.properties import for_any
from thermicon.icons import CueErrors, IconSet, load_library, parse

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


@pytest.mark.parametrize(
    "text",
    [
        "cue 1\nicon x { " + "repeat 2 { " * 20_000,
        "cue 1\n" + "icon a {" * 20_000,
        "cue 1\nicon x { " + "hold for 1 s " * 15_000,
        "cue 1\nicon x { hold for " + "1" * 200_000 + " s }",
        "cue 1\nicon x { hold for 1e" + "9" * 200_000 + " s }",
        "{" * 200_000,
        "}" * 200_000,
        '"' * 200_000,
        "@;" * 100_000,
        "cue 1\nicon x { " + "repeat 1000000000 { " * 19 + "hold for 1 s" + " }" * 20,
    ],
    ids=lambda text: text[:24],
)
def test_hostile_texts_are_refused_soon(text: str) -> None:
    begin = time.process_time()  # of this process: a busy machine must not fail it
    parsed(text)
    assert time.process_time() - begin < 5


def test_a_large_file_is_refused_before_it_is_read() -> None:
    with pytest.raises(CueErrors, match=r"E004 file too large\n  5,000,000 bytes\n  a cue file has at most 250,000"):
        parse(b"icon " * 1_000_000)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_any_newline_and_a_byte_order_mark(newline: str) -> None:
    text = str(load_library("six-icons")).replace("\n", newline)
    assert parse("\ufeff" + text) == load_library("six-icons")
    with pytest.raises(CueErrors, match=r"a\.cue:2:19  E102"):
        parse(newline.join(["cue 1", "icon x { hold for 4 }"]), "a.cue")


@pytest.mark.parametrize(
    ("data", "kind"),
    [(b"PK\3\4...", "a Word document"), (b"%PDF-1.7", "a PDF"), (b"\x89PNG\r\n", "PNG"), (b"\xff\xd8\xff\xe0", "JPEG")],
)
def test_other_kinds_of_file_are_named(data: bytes, kind: str) -> None:
    with pytest.raises(CueErrors, match=f"E006 binary file\n  this is .*{kind}"):
        parse(data, "x")

"""Parsing is total: whatever the text, there is a set or there are CueErrors, soon, and nothing else."""

import re
import time

import pytest
from hypothesis import strategies as st

from tests.properties import for_any
from thermicon.icons import CueErrors, IconSet, load_library, parse
from thermicon.icons.files.shipped import library_names

TEXT = """cue 1 icon set { } ; " cool warm by to 6 °C K s ms at over return hold for repeat rest 3 -1 1e999 0 @ # means
tags site control baseline skin current A A/s on sine ( a-b a_b \\ BROKEN é
change step pulse square triangle sawtooth by every starting up down cut play total most least in ) [ ] , .. . x y
x_y=1 {x} 1..3 [1,2] (x -6 2.5 °C/s mA"""
WORDS = [*re.findall(r"\S+", TEXT), "\n", "\u2028", "\t"]
FAMILY = "change by x at y; step by -1 K; hold for 1 s; return at y; total at most 30 s"
SOUND = [str(load_library(name)) for name in library_names()] + [
    f'cue 1\nicon f(x in [-6, 3] °C, y in 1..3 step 0.5 K/s) means "{{x}} at {{y}}" {{ {FAMILY} }}\n'
    "icon g { play f_x=-6_y=1; sine by 3 °C every 4 s for 10 s starting cool cut; return over 1 s }",
    'cue 1\nset a "x" { control current; site wrist }\n'
    'icon k means "a" tags "b, c" { to 0.5 A at 1 A/s; repeat 2 { to 100 mA over 20 ms; to 0.5 A over 1 s }\n'
    " return at 500 mA/s }",
]


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


PARAMETERS = [
    "x",
    "y",
    "in",
    "[",
    "]",
    "(",
    ")",
    ",",
    "..",
    "step",
    "1",
    "-2",
    "0.5",
    "K",
    "°C/s",
    "s",
    "\n",
    "{",
    "1..3",
]


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


@pytest.mark.slow
@for_any(st.sampled_from(SOUND), st.data(), examples=250)
def test_any_damage_to_a_sound_file(text: str, data: st.DataObject) -> None:
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        length = data.draw(st.integers(0, 5))
        text = text[:start] + data.draw(st.sampled_from(["", *WORDS])) + text[start + length :]
    parsed(text)


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
        "cue 1\nicon x { " + "repeat 3 { " * 9 + "warm by 1e-6 K at 1 K/s" + " }" * 10,
        "cue 1; icon x(a in 0.01..10 step 0.01 K, b in 0.1..10 step 0.1 s) { "
        + "pulse by a for b;" * 6
        + " hold for 1 s }",
        "cue 1; icon x(a in 0.001..10 step 0.001 K, b in 0.001..10 step 0.001 s) { pulse by a for b }",
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

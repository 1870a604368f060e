"""Parsing is total: whatever the text, there is a set or there are CueErrors, soon, and nothing else."""

import re
import time
from collections.abc import Callable

import pytest
from hypothesis import strategies as st

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


@pytest.mark.parametrize(
    ("data", "kind"),
    [(b"PK\3\4...", "a Word document"), (b"%PDF-1.7", "a PDF"), (b"\x89PNG\r\n", "PNG"), (b"\xff\xd8\xff\xe0", "JPEG")],
)
def test_other_kinds_of_file_are_named(data: bytes, kind: str) -> None:
    with pytest.raises(CueErrors, match=f"E006 binary file\n  this is .*{kind}"):
        parse(data, "x")


PAIR = "a in 1..1000 step 1 ms, b in 1..10 step 1 ms"


def full(head: str, unit: str | Callable[[int], str], tail: str = "") -> Callable[[], str]:
    """What makes a text of nearly the largest size: units between head and tail."""

    def text() -> str:
        make = unit if callable(unit) else lambda _: unit
        parts = [head]
        left = MOST_BYTES - len((head + tail).encode())
        while (left := left - len((part := make(len(parts) - 1)).encode())) >= 0:
            parts.append(part)
        return "".join(parts) + tail

    return text


def doubling(depth: int) -> str:
    plays = "".join(f"icon i{n} {{ play i{n + 1}; play i{n + 1} }}\n" for n in range(depth))
    return f"cue 1\n{plays}icon i{depth} {{ rest for 1 ms }}"


def nested(depth: int, parameters: str, inside: str) -> str:
    opening = f"repeat {'n' if parameters else 3} {{ "
    return f"cue 1\nicon x{parameters} {{ {opening * depth}{inside}{' }' * (depth + 1)}"


QUICK: dict[str, tuple[str | Callable[[], str], str]] = {
    "plays doubling 16 deep": (doubling(16), ""),
    "plays doubling 20 deep": (doubling(20), "E220"),
    "repeats tripling 19 deep": (nested(19, "", "warm by 1e-6 K at 1 K/s"), "E220"),
    "repeats of a family 12 deep": (nested(12, f"({PAIR}, n in [1, 2, 3])", "hold for a; hold for b"), "E231"),
    "a wave of 1 µs for an hour": ("cue 1\nicon x { sine by 1 K every 0.001 ms for 60 min }", "E220"),
    "the largest sine": ("cue 1\nicon x { sine by 28 K every 1 min for 60 min }", ""),
    "10,000 members": (f"cue 1\nicon f({PAIR}) {{ warm by 1 K over a; hold for b }}", ""),
    "a hundred statements of a hundred thousand": (
        f"cue 1\nicon f({PAIR}, c in 1..10 step 1 K) {{ warm by c over a; " + "hold for b; " * 100 + "}",
        "E231",
    ),
    "a hundred thousand members that fail": (
        f"cue 1\nicon f({PAIR}, c in 1..10 step 1 K) {{ warm by c over a; rest for b }}",
        "E205",
    ),
    "a million members": (f"cue 1\nicon f({PAIR}, c in 1..100 step 1 K) {{ warm by c over a; hold for b }}", "E231"),
    "errors on lines of their own": (full("cue 1\nicon x {\n", "hodl for 1 s\n", "}"), "E101"),
    "errors on one line": (full("cue 1\nicon x { ", "hold for 4; ", "}"), "E102"),
    "parentheses": (full("cue 1\nicon f", "("), "E113"),
    "headers that break": (full("cue 1\n", "icon f(a in [\n"), "E118"),
    "blocks that never close": ("cue 1\nicon x { " + "repeat 2 { " * 20_000, "E115"),
    "a number without end": ("cue 1\nicon x { hold for 1e" + "9" * 200_000 + " s }", "E218"),
    "quotation marks": ('"' * 200_000, "E101"),
    "a list without commas": (full("cue 1\nicon f(a in [1", " 1", "] ms) { hold for a }"), "E118"),
}
FULL: dict[str, tuple[str | Callable[[], str], str]] = {
    "100,000 members": (
        f"cue 1\nicon f({PAIR}, c in 1..10 step 1 K) {{ warm by c over a; hold for b }}",
        "",
    ),
    "families of ten thousand": (
        full("cue 1\n", lambda n: f"icon f{n}({PAIR}) {{ warm by 1 K over a; hold for b }}\n"),
        "E231",
    ),
    "one line": (full("cue 1\nicon x { ", "hold for 1 ms; ", "}"), ""),
    "ten thousand icons": (full("cue 1\n", lambda n: f"icon i{n}{{rest for 1s}};"), ""),
    "icons with one name": (full("cue 1\n", "icon a {rest for 1 s}\n"), "E211"),
    "plays of no icon": (full("cue 1\n", lambda n: f"icon i{n} {{play j{n}}}\n"), "E230"),
    "a chain of plays": (full("cue 1\n", lambda n: f"icon i{n} {{play i{n + 1}}}\n"), "E115"),
    "sines of many sizes": (
        full("cue 1\n", lambda n: f"icon x{n} {{ sine by {1 + n / 1000} K every 1 s for 1 s }}\n"),
        "E220",
    ),
    "a long list of values": (full("cue 1\nicon f(a in [1", lambda n: f",{n + 2}", "] ms) { hold for a }"), ""),
    "one value many times": (full("cue 1\nicon f(a in [1", ",1", "] ms) { hold for a }"), "E213"),
    "thousands of parameters": (
        full("cue 1\nicon f(x in [1] s", lambda n: f",p{n} in[1]s", ") { hold for x }"),
        "E227",
    ),
    "thousands of families": (full("cue 1\n", lambda n: f"icon f{n}(a in [1,2]s) {{hold for a}}\n"), ""),
    "thousands of uses": (full(f"cue 1\nicon f({PAIR}) {{ ", "hold for b; hold for a; ", "}"), "E231"),
    "thousands of holes": (full('cue 1\nicon f(a in [1] s) means "', "{b}", '" { hold for a }'), "E226"),
    "thousands of totals": (full("cue 1\nicon x { hold for 1 s; ", "total 2 s; ", "}"), "E222"),
    "nested repeats": (
        full("cue 1\nicon x { ", "repeat 1 { warm by 1e-6 K over 1 ms; " * 10 + " }" * 10 + "; ", "}"),
        "",
    ),
    "newlines": (full("cue 1\nicon f(", "\n"), "E113"),
}


def soon(given: str | Callable[[], str], code: str) -> None:
    text = given() if callable(given) else given
    begin = time.process_time()
    try:
        assert parse(text).entries
        assert not code
    except CueErrors as found:
        assert str(found)
        assert code in {error.code for error in found.errors}, str(found.errors[0])
    assert time.process_time() - begin < 20


@pytest.mark.parametrize("name", QUICK)
def test_a_hostile_text_is_answered_soon(name: str) -> None:
    soon(*QUICK[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", FULL)
def test_a_text_of_the_largest_size_is_answered_soon(name: str) -> None:
    soon(*FULL[name])

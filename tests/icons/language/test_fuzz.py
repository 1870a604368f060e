"""Thousands of damaged files: each gives a set or CueErrors, soon, with places in the file and suggestions that cure.

Run with ``pytest -m slow tests/icons``; some minutes on two cores. Mutations are seeded, so that a failure comes again.
"""

import multiprocessing
import random
import re
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor

import pytest

from thermicon.icons import CueErrors, IconSet, load_library, parse
from thermicon.icons.files.shipped import _folder, library_names

EVERYTHING = """cue 1  # the version
set everything "All of it" {
  site thenar; control skin
  baseline 32 °C
  by "A. Person"; doi "10.1/x"; licence "CC0"; tags "a, b"
}
icon ramps means "there and back" by "me" tags "first, second" {
  cool by 6 °C at 3 °C/s; hold for 4 s; warm to 30 °C over 500 ms
  change by -1.5 K at 30 K/min; change to 31 degC over 0.1 min; return at 3 °C/s
  rest for 1 s; total at least 5 s
}
icon shapes
  means "steps and \\"waves\\""
{
  step cool by 2 K; hold for 1 s; step to 32 °C; pulse by -3 °C for 500 ms; pulse warm by 1 K for 1 s
  repeat 2 { sine by 3 °C every 4 s for 8 s starting cool
    repeat 3 { square by 1 K every 2 s for 3 s cut; return over 1 s } }
  triangle by 1 °C every 2 s for 4 s starting warm cut; sawtooth by 1 °C every 2 s for 4 s
}
icon ramp(amount in [-6, −3, 3, 6] °C,
          rate in 1..3 step 0.5 °C/s, count in [1, 2], pause in [500, 1000] ms) means "{amount} at {rate}" {
  repeat count { change by amount at rate; hold for pause; return at rate }
  total at most 60 s
}
icon all { play ramps; play shapes; play ramp_amount=-6_rate=1_count=1_pause=500 }
"""
CURRENT = """cue 1
set push { control current }
icon k { to 0.5 A at 1 A/s; step by 100 mA; hold for 1 s; sine by 0.2 A every 1 s for 2 s starting down }
icon f(by in [0.1, 0.2] A) { pulse by by for 1 s }
"""
CORPUS = [
    EVERYTHING,
    CURRENT,
    *(_folder().joinpath(f"{name}.cue").read_text(encoding="utf-8") for name in library_names()),
    *(str(load_library(name)) for name in library_names()),
]
KNOWN = sorted({token for text in CORPUS for token in re.findall(r"\w+|[^\w\s]", text)})
TOKENS = [*KNOWN, "\n", "9" * 30, "\0", "é"]
CHUNKS, EACH = 20, 1000
SLOWEST_S = 5.0


def characters(text: str, rng: random.Random) -> str:
    at, other = sorted(rng.randrange(len(text) + 1) for _ in range(2))
    near = min(at + rng.randint(1, 8), len(text))
    return rng.choice(
        [
            text[:at] + text[near:],
            text[:near] + text[at:near] + text[near:],
            text[:at] + text[other : other + 1] + text[at + 1 : other] + text[at : at + 1] + text[other + 1 :],
            text[:at] + rng.choice("{}()[];,.\"\\#°-−'\t\u00a0\u2028x9=@") + text[at:],
        ]
    )


def tokens(text: str, rng: random.Random) -> str:
    parts = re.findall(r"\w+|\s+|[^\w\s]", text)
    at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
    change = rng.randrange(4)
    if change == 0:
        del parts[at]
    elif change == 1:
        parts.insert(at, rng.choice([" ", ""]) + rng.choice(TOKENS) + rng.choice([" ", ""]))
    elif change == 2:
        parts[at], parts[other] = parts[other], parts[at]
    else:
        parts[at] = rng.choice(TOKENS)
    return "".join(parts)


def lines(text: str, rng: random.Random) -> str:
    parts = text.split("\n")
    at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
    change = rng.randrange(4)
    if change == 0 and len(parts) > 1:
        del parts[at]
    elif change == 1:
        parts.insert(other, parts[at])
    elif change == 2:
        parts[at], parts[other] = parts[other], parts[at]
    else:
        parts[at : at + 2] = ["".join(parts[at : at + 2])]
    return "\n".join(parts)


def splice(text: str, rng: random.Random) -> str:
    other = rng.choice(CORPUS)
    return text[: rng.randrange(len(text) + 1)] + other[rng.randrange(len(other)) :]


def octets(text: str, rng: random.Random) -> str:
    data = bytearray(text.encode("utf-8"))
    for _ in range(rng.randint(1, 3)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return data.decode("utf-8", "surrogateescape")


MUTATIONS: list[Callable[[str, random.Random], str]] = [characters, characters, tokens, tokens, tokens, lines, splice]


def mutated(rng: random.Random) -> str | bytes:
    text = rng.choice(CORPUS)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        text = rng.choice(MUTATIONS)(text, rng) or "x"
    return octets(text, rng).encode("utf-8", "surrogateescape") if rng.random() < 0.1 else text


def examine(data: str | bytes) -> float:
    """Parse a text, prove what was said about it, and return how long the parsing took."""
    begin = time.process_time()
    try:
        icons: IconSet | None = parse(data, "a.cue")
        found = None
    except CueErrors as errors:
        icons, found = None, errors
    taken = time.process_time() - begin
    if found is None:
        assert icons is not None
        assert parse(str(icons)) == icons
        return taken
    if found.errors[0].line == 0:
        return taken
    text = data if isinstance(data, str) else data.decode("utf-8")
    rows = re.split(r"\r\n|\r|\n", text.removeprefix("\ufeff"))
    assert list(found.errors) == sorted(found.errors, key=lambda error: (error.line, error.column))
    assert str(found)
    for error in found.errors:
        assert error.source == rows[error.line - 1]
        assert 1 <= error.column <= len(error.source) + 1
        assert 1 <= error.length <= max(1, len(error.source) - error.column + 1)
        assert error.what
        assert not re.search(r"[A-Z]{2,}_|_[A-Z]{2,}|Token|None\b|NaN|LBRACE|BROKEN", error.what + error.help) or (
            error.what.count('"') >= 2
        )
    for error in [error for error in found.errors if error.suggestion is not None][:2]:
        cured = [*rows]
        if error.code == "E009":
            cured.insert(0, str(error.suggestion))
        else:
            cured[error.line - 1] = str(error.suggestion)
        try:
            parse("\n".join(cured))
        except CueErrors as left:
            there = 1 if error.code == "E009" else error.line
            assert there not in {other.line for other in left.errors}, f"{error.render()}\n---\n{left}"
            assert len(left.errors) + left.more <= len(found.errors) + found.more
    return taken


def damage(chunk: int) -> tuple[float, str]:
    """Examine a thousand damaged files; returns the longest time and its text."""
    rng = random.Random(f"cue {chunk}")
    worst = (0.0, "")
    for number in range(EACH):
        data = mutated(rng)
        try:
            worst = max(worst, (examine(data), repr(data)))
        except Exception as error:
            raise AssertionError(f"mutation {number} of chunk {chunk}: {data!r}\n{error!r}") from None
    return worst


@pytest.mark.slow
def test_damaged_files() -> None:
    if "fork" in multiprocessing.get_all_start_methods():
        with ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
            worst = max(pool.map(damage, range(CHUNKS)))
    else:
        worst = max(map(damage, range(CHUNKS)))
    print(f"the slowest of {CHUNKS * EACH:,} took {worst[0]:.2f} s")
    assert worst[0] < SLOWEST_S, worst[1]


@pytest.mark.parametrize("text", CORPUS, ids=lambda text: re.sub(r"\W+", "-", text[:30]))
def test_the_corpus_is_sound(text: str) -> None:
    assert parse(text).entries

"""Damaged cue files: a set or CueErrors in short time, with suggestions that cure."""

import re
import time
from pathlib import Path
from random import Random

from hypothesis import strategies as st

from tests.properties import for_any
from thermicon.icons import CueErrors, IconSet, load_library, parse
from thermicon.icons.files.shipped import library_names

CORPUS = [
    *(path.read_text("utf-8") for path in sorted(Path(__file__).parents[1].glob("*.cue"))),
    *(str(load_library(name)) for name in library_names()),
]
KNOWN = sorted({token for text in CORPUS for token in re.findall(r"\w+|[^\w\s]", text)})
TOKENS = [*KNOWN, "\n", "9" * 30, "\0", "é"]
SLOWEST_S = 5.0


def damaged(rng: Random) -> str | bytes:
    """A sound text with some of its tokens, characters, lines or bytes changed, moved or lost."""
    text = rng.choice(CORPUS)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 8])):
        pattern = rng.choice([r"\w+|\s+|[^\w\s]", r"\w+|\s+|[^\w\s]", r"(?s:.)", r"[^\n]*\n"])
        parts = re.findall(pattern, text) or ["x"]
        at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
        match rng.randrange(5):
            case 0:
                del parts[at : at + rng.randint(1, 3)]
            case 1:
                parts[at], parts[other] = parts[other], parts[at]
            case 2:
                parts.insert(at, parts[other])
            case 3:
                parts.insert(at, rng.choice([" ", ""]) + rng.choice(TOKENS) + rng.choice([" ", ""]))
            case _:
                parts[at] = rng.choice([*TOKENS, *"{}()[];,.\"\\#°-−'\t\u00a0\u2028x9=@"])
        text = "".join(parts) or "x"
    if rng.random() < 0.9:
        return text
    data = bytearray(text.encode("utf-8", "surrogateescape"))
    data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data)


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


@for_any(st.integers(0, 10**9), examples=1000)
def test_any_damaged_file(seed: int) -> None:
    assert examine(damaged(Random(seed))) < SLOWEST_S

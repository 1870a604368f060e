"""The formatter of cue texts."""

import re
from collections import Counter
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import strategies as st

import thermicon.icons
from tests.builders import messages
from tests.icons.model.test_roundtrip import families, icons, sets
from tests.properties import for_any
from thermicon.icons import CueErrors, Family, Icon, IconSet, format_text, parse
from thermicon.icons.files.shipped import library_names
from thermicon.icons.language.format_text import tidy_number

COMMENTS = ["# one", "#", '# a "text" { } ; (', "#two  ", "# °C −5 °", "##"]
NUMBERS = ["{}", "+{}", "{}.", "0{}", "{}e0", "{}E+00", "{}.0"]
BLANK = [" ", "  ", "\t", "\u00a0", " \u202f"]


def body(statements: list[str], settings: str = "") -> str:
    return f"cue 1\n\n{settings}icon x {{\n" + "".join(f"  {line}\n" for line in statements) + "}\n"


class Scribbler:
    """Writes one sound file, with the liberties that the language leaves to its author."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)

    def pick(self, *options: Any) -> Any:
        return self.random.choice(options)

    def comment(self) -> str:
        return self.pick("", *BLANK) + self.pick(*COMMENTS) if self.pick(True, False) else ""

    def lines(self) -> str:
        """Where a line may end, it may end several times, and each line may hold a comment."""
        return "".join(f"{self.comment()}{self.pick('', *BLANK)}\n" for _ in range(self.pick(0, 1, 1, 2, 4)))

    def end(self) -> str:
        return (
            self.pick(" ; ", ";", f";{self.comment()}\n", f"{self.comment()}\n") + self.lines() + self.pick("", *BLANK)
        )

    def number(self, value: int) -> str:
        return self.pick(*NUMBERS).format(value)

    def size(self) -> str:
        return self.number(self.pick(1, 2)) + self.pick("", " ", "\t") + self.pick("K", "°C", "degC")

    def time(self) -> str:
        return self.pick(f"{self.number(2)} s", f"{self.number(2)}s", ".5s", "500 ms", "5e-1 s", "+0.50s")

    def statement(self, names: list[str], depth: int = 2) -> str:
        gap = self.pick(*BLANK)
        size, time = self.pick(*names, self.size()), self.time()
        lines = [
            f"cool by {size} over {time}{self.end()}return at 3 K/s",
            f"pulse warm{gap}by{gap}{size} for {time}",
            f"change by {self.pick('-2', '−.5 ', '+2. ', '2')}K at 3 degC/s{self.end()}return over {time}",
            f"hold{gap}for {time}",
            f"sine by {size} every 1 s for 2 s starting cool{gap}cut",
        ]
        if depth:
            lines.append(f"repeat{gap}{self.pick('2', '+2')}{gap}{{{self.block(names, depth - 1)}}}")
        return self.pick(*lines)

    def block(self, names: list[str], depth: int) -> str:
        inner = [self.statement(names, depth) for _ in range(self.pick(1, 2))]
        return self.lines() + self.end().join(inner) + self.pick(" ", self.end())

    def icon(self, name: str) -> str:
        names = self.pick([], ["a"], ["a", "bb"])
        over = ""
        if names:
            values = ["[1 ,2 , 3]", " 1..3 step 1", "  1 .. 3 step+1"]
            parts = [f"{each} in{self.pick(*values)} K" for each in names]
            over = f"({self.lines()}" + f",{self.lines()}".join(parts) + f"{self.lines()})"
            over = self.pick("", " ") + over
        keys = [f'{key} "{text}"' for key, text in (("means", "x" * 60), ("by", "y # z"), ("tags", "a, b" * 20))]
        keys = keys[: self.pick(0, 1, 2, 3)]
        header = "".join(f" {self.lines()}{key}" for key in keys) + f"{self.pick('', ' ')}{self.lines()}{{"
        used = "".join(f"{self.end()}pulse by {each} for 1 s" for each in names)
        return f"icon {name}{over}{header}{self.block(names, 2).rstrip(' ;')}{used}{self.pick(' ', self.end())}}}"

    def file(self) -> str:
        blocks = [f"cue{self.pick(*BLANK)}1"]
        if self.pick(True, False):
            site = f"site wrist{self.end()}" if self.pick(True, False) else ""
            level = self.pick("32.", "32", "+32 ")
            end = self.pick("", self.end())
            blocks.append(f'set {self.pick("", "s")} "t"{{{self.lines()}{site}baseline {level}degC{end}}}')
        blocks += [self.icon(name) for name in ("x", "y")[: self.pick(1, 2)]]
        return self.lines() + self.end().join(blocks) + self.pick("", self.comment(), self.end())


def comments_of(text: str) -> Counter[str]:
    """Comments of a text, found in a way of their own: a "#" outside quotation marks."""
    bare = re.sub(r'"(?:[^"\\\n]|\\.)*"|(#[^\n]*)', lambda match: match[1] or '""', text)
    return Counter(match.rstrip() for match in re.findall(r"#[^\n]*", bare))


@for_any(st.integers(0, 10**9), examples=150)
def test_any_sound_text(seed: int) -> None:
    text = Scribbler(seed).file()
    written = format_text(text)
    assert parse(written) == parse(text)
    assert format_text(written) == written
    assert comments_of(written) == comments_of(text)
    lines = written.split("\n")
    assert all(line == line.rstrip() for line in lines)
    assert written.endswith("\n")
    assert not written.endswith("\n\n")
    assert "\n\n\n" not in written
    assert not any("{" in a.partition("#")[0] and not b for a, b in pairwise(lines))


@for_any(st.one_of(icons(), families(), sets()), examples=100)
def test_the_text_of_a_model_is_in_canonical_layout(model: Icon | Family | IconSet) -> None:
    assert format_text(str(model)) == str(model)


@pytest.mark.parametrize("name", library_names())
def test_shipped_files_are_in_canonical_layout(name: str) -> None:
    text = (Path(thermicon.icons.__path__[0]) / "library" / f"{name}.cue").read_text(encoding="utf-8")
    assert format_text(text) == text


TIDY, LAID_OUT = (messages(__file__, "cases.toml")[name] for name in ("tidy", "laid_out"))


@pytest.mark.parametrize("written", TIDY)
def test_a_statement(written: str) -> None:
    assert format_text(body([written, "hold for 1 s"])) == body([TIDY[written], "hold for 1 s"])


@pytest.mark.parametrize("case", LAID_OUT)
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_a_text_is_laid_out(case: str, newline: str) -> None:
    written, out = LAID_OUT[case]
    text = written.replace("\n", newline)
    assert format_text("\ufeff" + text) == format_text(text.encode("utf-8-sig")) == out
    assert str(parse(out)) == str(parse(text))


@pytest.mark.parametrize("digits", ["." + "1" * 39, "−." + "1" * 38, "+0" + "." + "1" * 37])
def test_a_tidy_number_is_not_too_long_to_read(digits: str) -> None:
    text = format_text(f"cue 1; icon x {{ change by {digits} K over 1 s }}")
    assert parse(text) == parse(format_text(text))
    assert len(tidy_number(digits)) <= 40


def test_what_cannot_be_parsed_is_told_as_parse_tells_it() -> None:
    text = "cue 1\nicon x { hold for 4 }\nicon y { rest for -1 s }"
    with pytest.raises(CueErrors, match="E102") as told:
        format_text(text, "a.cue")
    with pytest.raises(CueErrors, match="E102") as parsed:
        parse(text, "a.cue")
    assert str(told.value) == str(parsed.value)

"""Every error of the table with sound suggestions."""

from dataclasses import dataclass

import pytest

from tests.builders import messages
from thermicon.icons import CueErrors, parse
from thermicon.icons.model.errors import CueError, codes

FRAMES = {
    "statement": "cue 1\nicon x {{\n{}\n}}",
    "family": "cue 1\nicon {} {{\n{}\n  hold for 1 s\n}}",
    "spatial": "cue 1\nset {{ elements left, right }}\nicon x {{\n{}\n}}",
    "file": "{}",
}


@dataclass(frozen=True, slots=True)
class Mistake:
    """A text, what must be told of it and where (line and column, 0 for no place), and the corrected line if given."""

    source: str
    told: tuple[str, int, int]
    words: str
    suggestion: str | None = None
    obeyed: str = ""

    @staticmethod
    def of(kind: str, code: str, marked: str, said: str | list[str]) -> "Mistake":
        parts = [*marked.split("\n", 1), "change by a at 1 K/s"][:2] if kind == "family" else [marked]
        before, mark, after = FRAMES[kind].format(*parts).partition("▸")
        place = (before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1) if mark else (0, 0)
        told = [said] if isinstance(said, str) else said
        obeyed = "".join(FRAMES[kind].format(text) for text in told[2:])
        return Mistake(before + after, (code, *place), *told[:2], obeyed=obeyed)


ALL = [
    Mistake.of(kind, code, marked, said)
    for kind, by_code in messages(__file__, "mistakes.toml").items()
    for code, rows in by_code.items()
    for marked, said in rows.items()
]
SEVERAL = messages(__file__)["several"]


def errors_of(text: str | bytes) -> tuple[CueError, ...]:
    with pytest.raises(CueErrors, match=r"E\d\d\d ") as caught:
        parse(text, "a.cue")
    return caught.value.errors


@pytest.mark.parametrize("mistake", ALL, ids=lambda mistake: f"{mistake.told[0]}-{mistake.words[:20]}")
def test_a_mistake_is_told_and_a_suggestion_cures_its_line(mistake: Mistake) -> None:
    (error,) = errors_of(mistake.source)
    assert (error.code, error.line, error.column) == mistake.told
    assert mistake.words in error.render()
    assert mistake.suggestion in (None, error.suggestion or "")
    assert not mistake.obeyed or parse(mistake.obeyed)
    if error.suggestion is None:
        return
    lines = mistake.source.split("\n")
    if error.code == "E009":
        lines.insert(0, "")
    lines[0 if error.code == "E009" else error.line - 1] = error.suggestion
    try:
        parse("\n".join(lines))
    except CueErrors as left:
        assert error.line not in {other.line for other in left.errors}, str(left)


@pytest.mark.parametrize(("line", "meant"), messages(__file__)["meaning"].items())
def test_a_suggestion_keeps_every_word_that_was_meant_or_is_not_made(line: str, meant: str | list[str]) -> None:
    (error,) = errors_of(f"cue 1\nicon x {{ hold for 1 s }}\nicon y {{\n  {line}\n}}")
    assert error.suggestion == (meant if isinstance(meant, str) else None)
    assert isinstance(meant, str) or meant[0] in error.render()


def test_every_code_is_reached() -> None:
    at_the_door = {f"E00{n}" for n in range(1, 8)}
    recordings = {"E013", "E014", "E015", "E016"}
    assert {mistake.told[0] for mistake in ALL} | at_the_door | recordings == set(codes())


def test_the_layout() -> None:
    source = "cue 1\nicon x {\n  cool to 26 at 3 °C/s\n}\n"
    with pytest.raises(CueErrors, match="E102") as caught:
        parse(source, "alarm.cue")
    assert str(caught.value) == (
        "alarm.cue:3:11  E102 missing unit\n"
        "  3 |   cool to 26 at 3 °C/s\n"
        "    |           ^^ this number has no unit\n"
        '  a temperature such as "26 °C", or a change such as "by 6 °C"\n'
        "  did you mean:  cool to 26 °C at 3 °C/s"
    )


@pytest.mark.parametrize("source", SEVERAL, ids=lambda source: source[6:30])
def test_each_mistake_is_told_once_in_the_order_of_the_text(source: str) -> None:
    found = [[error.code, error.line, error.suggestion or ""] for error in errors_of(source)]
    assert found == SEVERAL[source]
    with pytest.raises(CueErrors, match="(?s)" + r".*\n.*".join(code for code, *_ in found)):
        parse(source)


def test_carets_stand_under_tabs_and_wide_characters() -> None:
    (error,) = errors_of("cue 1\nicon x {\n\thold for 4\n}")
    assert error.column == 11
    assert "  3 | \thold for 4\n    | \t         ^ this" in error.render()
    (error,) = errors_of('cue 1\nicon x means "熱" { hold for 4 }')
    assert error.column == 29
    caret, source = error.render().split("\n")[2].index("^"), error.render().split("\n")[1].index("4 }")
    assert caret == source + 1


def test_an_endless_line_is_shown_in_part() -> None:
    (error,) = errors_of("cue 1\nicon x { " + "hold for 1 s; " * 200 + "hold for 4 }")
    assert error.column == 2819
    assert all(len(row) < 160 for row in error.render().split("\n"))
    assert "…" in error.render()


def test_errors_that_are_not_shown_are_counted() -> None:
    (error,) = errors_of("cue 1\nicon x { hold for 4 }")
    for more, said in ((1, "and 1 more error"), (2, "and 2 more errors")):
        assert str(CueErrors((error,), more)).endswith(f"... {said}")


def test_of_many_errors_a_hundred_are_shown_and_a_thousand_read() -> None:
    for count, more in ((150, "50"), (1200, "at least 900")):
        with pytest.raises(CueErrors, match=f"and {more} more errors") as caught:
            parse("cue 1\nicon x {\n" + "blah\n" * count + "}")
        assert len(caught.value.errors) == 100


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"a\.cue  E005 empty file"),
        (" \n", r"E005 empty file\n  nothing but white space"),
        (b"cue 1\n\0", "E006 binary file\n  a zero byte at byte offset 6"),
        ("cue 1\n\0", "E006 binary file\n  a zero byte is on line 2"),
        (b"cue 1\n# caf\xe9\n", "E007 not UTF-8\n  byte 0xE9 at byte offset 11, on line 2"),
        ("cue 1 # \ud800", "E007 not UTF-8\n  half a character"),
        (b"#" * 250_001, "E004 file too large\n  250,001 bytes"),
        (b"PK\3\4...", "E006 binary file\n  this is .*a Word document"),
        (b"%PDF-1.7", "E006 binary file\n  this is .*a PDF"),
        (b"\x89PNG\r\n", "E006 binary file\n  this is .*PNG"),
        (b"\xff\xd8\xff\xe0", "E006 binary file\n  this is .*JPEG"),
    ],
)
def test_bytes_that_are_no_cue_text(data: str | bytes, message: str) -> None:
    with pytest.raises(CueErrors, match=message):
        parse(data, "a.cue")

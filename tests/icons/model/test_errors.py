"""Every mistake in the table is told with its code, place and words; every suggestion is itself sound."""

from typing import Any, NamedTuple

import pytest

from tests.builders import messages
from thermicon.icons import CueErrors, parse
from thermicon.icons.model.errors import CueError, codes

DOWN = "cool by 6 °C at 3 °C/s"


class Mistake(NamedTuple):
    """A text, the code and place of its error, words of the message, and the corrected line ("" for none)."""

    source: str
    code: str
    line: int
    column: int
    words: str
    suggestion: str | None = None


def _mistake(row: dict[str, Any]) -> Mistake:
    after = f"\n{row['after']}" if "after" in row else ""
    if "parameters" in row:
        statement = row.get("statement", "change by a at 1 K/s")
        text = f"cue 1\nicon x({row['parameters']} {{\n  {statement}\n  hold for 1 s\n}}{after}"
    elif "statement" in row:
        text = f"cue 1\nicon x {{ {row.get('before', '')}\n  {row['statement']}\n}}{after}"
    else:
        text = row["source"]
    return Mistake(text, row["code"], *row["place"], row["words"], row.get("suggestion"))


_TABLES = messages(__file__, "mistakes.toml")
ALL = [_mistake(row) for rows in _TABLES.values() for row in rows]


def errors_of(text: str | bytes) -> tuple[CueError, ...]:
    with pytest.raises(CueErrors, match=r"E\d\d\d ") as caught:
        parse(text, "a.cue")
    return caught.value.errors


@pytest.mark.parametrize("mistake", ALL, ids=lambda mistake: f"{mistake.code}-{mistake.words[:20]}")
def test_a_mistake_is_told_and_a_suggestion_cures_its_line(mistake: Mistake) -> None:
    (error,) = errors_of(mistake.source)
    assert (error.code, error.line, error.column) == (mistake.code, mistake.line, mistake.column)
    assert mistake.words in error.render()
    if mistake.suggestion is not None:
        assert (error.suggestion or "") == mistake.suggestion
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


def test_every_code_is_reached() -> None:
    at_the_door = {f"E00{n}" for n in range(1, 8)}
    recordings = {"E013", "E014", "E015", "E016"}
    assert {mistake.code for mistake in ALL} | at_the_door | recordings == set(codes())


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


def test_three_mistakes_give_three_errors() -> None:
    source = f"cue 1\nicon x {{\n  cool by 6 at 3 °C/s\n  hold 4 s\n  {DOWN}\n  return at 3 °C\n}}\n"
    found = errors_of(source)
    assert [(e.code, e.line, e.column) for e in found] == [("E102", 3, 11), ("E116", 4, 8), ("E104", 6, 15)]
    with pytest.raises(CueErrors, match=r"(?s)E102.*\n\n.*E116.*\n\n.*E104"):
        parse(source)


def test_syntax_and_meaning_come_in_the_order_of_the_text() -> None:
    source = f"cue 1\nicon a {{ rest for -1 s }}\nicon b {{ hold }}\nicon c {{ {DOWN}; rest for 1 s }}\nicon a {{ }}\n"
    assert [(e.code, e.line) for e in errors_of(source)] == [
        ("E203", 2),
        ("E116", 3),
        ("E205", 4),
        ("E217", 5),
        ("E211", 5),
    ]


def test_a_broken_statement_draws_no_others_after_it() -> None:
    found = errors_of(f"cue 1\nicon x {{\n {DOWN[:-5]}\n hold for 2 s\n return at 3 °C/s\n rest for 1 s\n}}")
    assert [e.code for e in found] == ["E102"]


def test_a_broken_header_does_not_hide_its_body() -> None:
    found = errors_of("cue 1\nicon 1st {\n hold 4 s\n}\nicon y {\n repaet 3 { hold for 4 }\n}")
    assert [(e.code, e.line) for e in found] == [("E113", 2), ("E116", 3), ("E101", 6), ("E102", 6)]


def test_a_mistake_in_the_set_block_draws_no_others_after_it() -> None:
    found = errors_of("cue 1\nset {\n control curent\n}\nicon x { to 1 A at 1 A/s; return over 1 s }")
    assert [(e.code, e.suggestion) for e in found] == [("E215", "control current")]


def test_a_cure_never_joins_lines() -> None:
    found = errors_of("cue 1\nicon big\n\ndip { hold for 1 s }")
    assert [(e.code, e.line, e.suggestion) for e in found] == [("E113", 4, None)]


def test_carets_stand_under_a_tab() -> None:
    (error,) = errors_of("cue 1\nicon x {\n\thold for 4\n}")
    assert error.column == 11
    assert "  3 | \thold for 4\n    | \t         ^ this" in error.render()


def test_carets_count_wide_and_combining_characters() -> None:
    (error,) = errors_of('cue 1\nicon x means "熱" { hold for 4 }')
    assert error.column == 29
    caret, source = error.render().split("\n")[2].index("^"), error.render().split("\n")[1].index("4 }")
    assert caret == source + 1


def test_an_endless_line_is_shown_in_part() -> None:
    (error,) = errors_of("cue 1\nicon x { " + "hold for 1 s; " * 200 + "hold for 4 }")
    assert error.column == 2819
    assert all(len(row) < 160 for row in error.render().split("\n"))
    assert "…" in error.render()


@pytest.mark.parametrize(("more", "said"), [(1, "and 1 more error"), (2, "and 2 more errors")])
def test_errors_that_are_not_shown_are_counted(more: int, said: str) -> None:
    (error,) = errors_of("cue 1\nicon x { hold for 4 }")
    assert str(CueErrors((error,), more)).endswith(f"... {said}")


@pytest.mark.slow
def test_of_many_errors_a_hundred_are_shown() -> None:
    with pytest.raises(CueErrors, match="and 50 more errors") as caught:
        parse("cue 1\nicon x {\n" + "hodl for 1 s\n" * 150 + "}")
    assert (len(caught.value.errors), caught.value.more) == (100, 50)
    with pytest.raises(CueErrors, match="and at least 900 more errors"):
        parse("cue 1\nicon x {\n" + "hodl for 1 s\n" * 5000 + "}")


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
    ],
)
def test_bytes_that_are_no_cue_text(data: str | bytes, message: str) -> None:
    with pytest.raises(CueErrors, match=message):
        parse(data, "a.cue")

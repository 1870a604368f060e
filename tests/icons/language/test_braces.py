"""The brace of a block may stand on a line of its own, behind a set as behind an icon."""

import pytest

from thermicon.icons import CueErrors, format_text, parse

CANONICAL = 'cue 1\n\nset a "T" {\n  site x\n}\n\nicon b means "c" {\n  hold for 1 s\n}\n'


@pytest.mark.parametrize("between", [" ", "\n", "\n\n\n", "  \n\t"])
def test_a_brace_may_stand_on_a_line_of_its_own(between: str) -> None:
    text = f'cue 1\nset a "T"{between}{{\n site x\n}}\nicon b means "c"{between}{{\n hold for 1 s\n}}\n'
    assert str(parse(text)) == CANONICAL
    assert format_text(text) == CANONICAL


def test_a_set_without_a_name_may_have_its_brace_below() -> None:
    text = "cue 1\nset\n{ control display }\nicon b { hold for 1 s }\n"
    assert parse(text).context.control == "display"
    assert "set {\n  control display\n}" in format_text(text)


def test_comments_before_the_brace_of_a_set_are_kept() -> None:
    text = "cue 1\nset a # first\n# second\n{\n site x\n}\nicon b { hold for 1 s }\n"
    laid_out = format_text(text)
    assert "set a {  # first\n  # second\n  site x\n}" in laid_out
    assert format_text(laid_out) == laid_out


@pytest.mark.parametrize("head", ["set a", "set", "icon a"])
def test_a_block_that_never_opens_is_reported_once(head: str) -> None:
    with pytest.raises(CueErrors, match="E114 missing block") as caught:
        parse(f"cue 1\n{head}\nicon b {{ hold for 1 s }}\n")
    assert [error.code for error in caught.value.errors] == ["E114"]

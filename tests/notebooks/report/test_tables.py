"""Tables on narrow terminals: wrapped or folded, but with every letter."""

import re
from collections import Counter

import pytest

from thermicon.icons import load_library
from thermicon.notebooks.report.blocks import Grid, grid
from thermicon.notebooks.report.terminal import lines as rendered

NAMES = ("icon", "most confused with")
RANK = ("icon", "detected", "onset", "channel", "felt+named", "most confused with")
STYLE = re.compile(r"\x1b\[[0-9;]*m")


def letters(text: str) -> Counter[str]:
    return Counter(re.sub(r"[\s─]", "", STYLE.sub("", text)))


def ranked() -> tuple[Grid, str]:
    names = [icon.name for icon in load_library("wave-confusions")]
    rows = [(name, "100 %", "0.92 s", "cold", "91 %", f"{name} 24 %") for name in names]
    return grid(RANK, rows, RANK[1:3], RANK), "".join(("".join(RANK), *("".join(row) for row in rows)))


@pytest.mark.parametrize("width", [80, 60, 40])
def test_no_letter_of_a_name_or_a_heading_is_lost(width: int) -> None:
    made, text = ranked()
    lines = rendered([made], width)
    assert max(len(STYLE.sub("", line)) for line in lines) <= width
    assert letters("".join(lines)) == letters(text)


def test_at_80_columns_the_names_of_shipped_sets_stay_on_one_line() -> None:
    made, _ = ranked()
    shown = [STYLE.sub("", line) for line in rendered([made], 80)]
    for name in (icon.name for icon in load_library("wave-confusions")):
        assert sum(name in line for line in shown) >= 1


def test_a_pipe_gets_one_line_per_row() -> None:
    made, _ = ranked()
    assert len(rendered([made], 40, is_terminal=False)) == 2 + 12

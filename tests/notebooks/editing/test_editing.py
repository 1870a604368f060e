"""What an editor asks of a text: icons removed, all other text as it is; and what may follow, for completion."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from thermicon.icons.language.source import grammar
from thermicon.notebooks.editing.completions import CONTEXTS, completions
from thermicon.notebooks.editing.cue_check import read_text
from thermicon.notebooks.editing.number_literals import CannotEdit, only

TEXT = """cue 1

# about a
icon a means "x } icon b" {
  hold for 1 s  # }
}

icon b { play a; repeat 2 { warm by 1 K at 1 K/s; return at 1 K/s } }
icon c { hold for 1 s }; icon d { hold for 2 s }
# the end
"""


def names(text: str) -> tuple[str, ...]:
    reading = read_text(text)
    assert reading.troubles == ()
    return reading.names


def test_the_chosen_stay_and_a_family_is_written_out() -> None:
    kept = only(TEXT, ("a", "c"))
    assert names(kept) == ("a", "c")
    assert [words in kept for words in ("# about a", 'means "x } icon b"', "# the end")] == [True] * 3
    assert names(only(TEXT, ("a", "d"))) == ("a", "d")
    family = "cue 1\nicon ramp(x in [1, 2, 3] K) { cool by x at 1 K/s; return at 1 K/s }\nicon b { hold for 1 s }\n"
    assert names(only(family, ("ramp_x=2", "b"))) == ("ramp_x=2", "b")
    with pytest.raises(CannotEdit, match="cannot stand alone: icon b plays a"):
        only(TEXT, ("b",))
    with pytest.raises(CannotEdit, match="the text has errors"):
        only("cue 1; icon a { hold for 1 }", ("a",))


PLAIN = {"NUMBER": "2", "NAME": "a", "STRING": '"a"', "TITLE": '"a"'}


def paths(tree: dict[str, Any], before: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    if not tree:
        yield before
    for name, after in tree.items():
        yield from paths(after, (*before, name))


@pytest.mark.parametrize("context", CONTEXTS)
def test_every_path_can_be_read(context: str) -> None:
    words = {**{name: each[0] for name, each in completions()["words"].items()}, **PLAIN}
    found = list(paths(completions()["trees"][context]))
    assert len(found) > 3
    for path in found:
        parser = grammar().parse_interactive(CONTEXTS[context] + " ".join(words[name] for name in path))
        kinds = [token.type for token in parser.iter_parse()]
        assert tuple(kinds[-len(path) :]) == path


def test_units_come_with_their_kind() -> None:
    found = completions()
    hold = found["trees"]["icon"]["HOLD"]["FOR"]["NUMBER"]
    assert [found["words"][name] for name in hold] == [["s", "ms", "min"]]
    assert found["examples"]["hold"] == "hold for 4 s"

"""What an editor asks of a text: icons removed, all other text as it is; and what may follow, for completion."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from thermicon.icons.language.source import grammar
from thermicon.notebooks.editing.completions import CONTEXTS, completions

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

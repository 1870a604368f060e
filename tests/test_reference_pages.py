"""The pages of docs/reference/ list every rig key, command and column of a trace."""

import re
from pathlib import Path

import pytest
from typer.main import get_command

from thermicon.circuit.rig.rigfile import rig_keys
from thermicon.circuit.solver.trace import COLUMNS
from thermicon.notebooks.cli.main import app

REFERENCE = Path(__file__).resolve().parents[1] / "docs" / "reference"


def code_words(page: str) -> set[str]:
    """Words in the inline code of a page."""
    text = (REFERENCE / page).read_text(encoding="utf-8")
    return {word for code in re.findall(r"`([^`\n]+)`", text) for word in re.split(r"[^\w-]+", code)}


@pytest.mark.parametrize(
    ("page", "names"),
    [
        ("rig-keys.md", {key.rpartition(".")[2] for key in rig_keys()}),
        ("commands.md", set(getattr(get_command(app), "commands", {}))),
        ("files.md", set(COLUMNS)),
    ],
    ids=["rig keys", "commands", "columns of a trace"],
)
def test_a_page_lists_every_name(page: str, names: set[str]) -> None:
    assert names
    assert names - code_words(page) == set()

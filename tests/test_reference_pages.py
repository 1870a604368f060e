"""The completeness of the pages of docs/reference/."""

import json
import re
from pathlib import Path

import pytest
from typer.main import get_command

from tests.circuit.delivery.one_drive import prepare
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.rig.rigfile import rig_keys
from thermicon.circuit.solver.trace import COLUMNS
from thermicon.icons import load_library
from thermicon.notebooks.cli.main import app
from thermicon.perception import rank

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


def keys_of(document: object, names: tuple[str, ...]) -> set[str]:
    """Keys of a JSON document, of some of its objects, and of the first entry of some of its lists."""
    assert isinstance(document, dict)
    inner = [document[name][0] if isinstance(document[name], list) else document[name] for name in names]
    return set(document).union(*inner)


def test_the_page_lists_every_key_of_a_ranking_and_of_a_sidecar() -> None:
    rig, listed, form = Rig.load("thenar"), code_words("files.md"), load_format("csv")
    ranking = rank(load_library("wave-shapes"), rig, people=3, parameters=0, workers=1).to_dict()
    assert keys_of(ranking, ("icons", "pairs", "set", "task", "confusion")) - listed == set()
    assert "proportion_correct" in listed
    ready = prepare(load_library("six-icons")["double-dip"], rig, Device.load("dac-16"), form, gate=GreenVerdict)
    sidecar = json.loads(pack([ready], form)["double-dip.json"])
    assert keys_of(sidecar, ("columns", "events", "safety", "hardware_must_prevent")) - listed == set()

"""What rigs and drives refuse, by the words of `messages.toml`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.circuit import Drive, Rig, read_drive
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.drive import DriveError

MESSAGES = messages(__file__)


@pytest.mark.parametrize(("given", "words"), MESSAGES["rig"].items())
def test_an_impossible_rig_is_refused(given: str, words: str) -> None:
    name, _, changes = given.partition(" ")
    with pytest.raises(RigError, match=words):
        Rig.load(name).with_(**json.loads(changes))


@pytest.mark.parametrize(("given", "words"), MESSAGES["drive"].items())
def test_an_impossible_drive_is_refused(given: str, words: str) -> None:
    with pytest.raises(DriveError, match=words):
        Drive(*json.loads(given))


@pytest.mark.parametrize(("text", "words"), MESSAGES["drive file"].items())
def test_a_bad_drive_file_says_where(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "drive.csv"
    path.write_text(text)
    with pytest.raises(DriveError, match=words):
        read_drive(path)

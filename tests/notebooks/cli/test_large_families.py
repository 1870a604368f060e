"""A family of a million costs a command nothing but a clear word."""

from pathlib import Path
from typing import Any

import pytest

MILLION = "cue 1\nicon one(size in 0.00001..10 step 0.00001 K) { cool by size over 2 s; return over 1 s }\n"


@pytest.fixture
def million(tmp_path: Path) -> str:
    path = tmp_path / "million.cue"
    path.write_text(MILLION, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    "command", [("rank",), ("simulate",), ("sweep", "--vary", "contact.area_cm2=4:9:2", "-o", "-")]
)
def test_what_plays_every_icon_refuses(cli: Any, million: str, command: tuple[str, ...]) -> None:
    said = cli(command[0], million, *command[1:])
    assert said.exit_code == 2
    assert "1,000,000 icons" in said.stderr


def test_it_is_checked_whole_and_against_a_rig_by_some(cli: Any, million: str) -> None:
    said = cli("check", million, "--rig", "thenar")
    assert said.exit_code == 0
    assert "1,000,000 icons" in said.stdout
    assert "2,000 of its 1,000,000 icons" in said.stderr


def test_one_of_them_is_played(cli: Any, million: str) -> None:
    assert cli("simulate", million, "--icon", "one_size=2.5").exit_code == 0

"""A large family costs a command nothing but a clear word; one that is too large is refused."""

from pathlib import Path
from typing import Any

import pytest

LARGE = "cue 1\nicon one(size in 0.001..10 step 0.001 K) { cool by size over 2 s; return over 1 s }\n"


@pytest.fixture
def large(tmp_path: Path) -> str:
    path = tmp_path / "large.cue"
    path.write_text(LARGE, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    "command", [("rank",), ("simulate",), ("sweep", "--vary", "contact.area_cm2=4:9:2", "-o", "-")]
)
def test_what_plays_every_icon_refuses(cli: Any, large: str, command: tuple[str, ...]) -> None:
    said = cli(command[0], large, *command[1:])
    assert said.exit_code == 2
    assert "10,000 icons" in said.stderr


@pytest.mark.parametrize("most", [100, pytest.param(None, marks=pytest.mark.slow)])
def test_it_is_checked_whole_and_against_a_rig_by_some(
    cli: Any, large: str, monkeypatch: pytest.MonkeyPatch, most: int | None
) -> None:
    if most is not None:
        monkeypatch.setattr("thermicon.notebooks.cli.check.MOST_ICONS", most)
    said = cli("check", large, "--rig", "thenar")
    assert said.exit_code == 0
    assert "10,000 icons" in said.stdout
    assert f"{most or 2000:,} of its 10,000 icons" in said.stderr


def test_one_of_them_is_played(cli: Any, large: str) -> None:
    assert cli("simulate", large, "--icon", "one_size=2.5").exit_code == 0

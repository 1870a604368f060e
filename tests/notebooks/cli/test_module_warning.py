"""The warning on the data sheets of a module: only where the module is used."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.circuit import Rig

Cli = Callable[..., Any]
DOUBT = "that its two data sheets stand for"


@pytest.fixture
def hand(tmp_path: Path) -> Path:
    path = tmp_path / "hand.toml"
    Rig.load("fingertip").with_(module={"name": "TEC1-12706"}, driver={"current_limit_A": 2.0}).save(path)
    return path


@pytest.mark.parametrize("command", [("check",), ("list", "--cite")], ids=["check", "cite"])
def test_it_is_not_said_where_the_module_is_not_used(cli: Cli, two: Path, hand: Path, command: tuple[str, ...]) -> None:
    assert DOUBT not in cli(*command, two, "--rig", hand).stderr
    assert cli("simulate", two, "--rig", hand).stderr.count(DOUBT) == 1
    loud = cli(*command, two, "--rig", hand, "--set", "ambient.film_W_per_m2K=60")
    assert "skin at rest loses" in loud.stderr

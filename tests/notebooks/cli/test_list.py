"""``thermicon list``: what is shipped, a paragraph for the methods with its sources, and copies to start from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.circuit import Device, Rig
from thermicon.icons import read_cue
from thermicon.icons.files.shipped import load_library

Cli = Callable[..., Any]


@pytest.mark.parametrize("what", ["icons", "rigs", "devices", "formats"])
def test_each_kind_is_listed_within_80_columns(cli: Cli, what: str) -> None:
    said = cli("list", what)
    assert (said.exit_code, said.stderr) == (0, "")
    one = {"icons": "six-icons", "rigs": "thenar", "devices": "qst-tcs2", "formats": "csv"}[what]
    assert one in said.stdout
    assert said.stdout in cli("list").stdout
    assert max(len(line) for line in said.stdout.splitlines()) <= 80


@pytest.mark.parametrize(("name", "ending"), [("six-icons", ".cue"), ("forearm", ".toml"), ("dac-16", ".toml")])
def test_a_copy_reads_as_what_was_copied_and_replaces_nothing(cli: Cli, tmp_path: Path, name: str, ending: str) -> None:
    path = tmp_path / f"mine{ending}"
    said = cli("list", "--copy", name, path)
    assert (said.exit_code, said.stdout, said.stderr) == (0, "", f"wrote {path}\n")
    if ending == ".cue":
        assert read_cue(path).content_hash == load_library(name).content_hash
    else:
        kind: Any = Rig if name == "forearm" else Device
        assert kind.load(path) == kind.load(name)
    before = path.read_bytes()
    again = cli("list", "--copy", name, path)
    assert (again.exit_code, again.stderr) == (1, f"{path} already exists and was kept; give another name\n")
    assert path.read_bytes() == before

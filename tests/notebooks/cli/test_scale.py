"""``thermicon rank`` on more or fewer cores, and on a cluster that is not there."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]


def test_workers_change_no_byte(cli: Cli, two: Path, tmp_path: Path) -> None:
    outs = []
    for extra in ((), ("--workers", 1), ("--workers", 3)):
        outs.append(tmp_path / f"{len(outs)}.json")
        said = cli("rank", two, "--people", 5, "--intervals", 0, "--json", outs[-1], *extra)
        assert said.exit_code == 0, said.stderr
    assert len({out.read_bytes() for out in outs}) == 1


def test_a_cluster_that_is_not_there_is_bad_input(cli: Cli, two: Path) -> None:
    pytest.importorskip("distributed")
    said = cli("rank", two, "--people", 2, "--workers", "nowhere")
    assert said.exit_code == 1
    assert "'nowhere' is not the address of a scheduler" in said.stderr
    assert "Traceback" not in said.stderr


@pytest.mark.slow
def test_the_error_of_sampling_is_in_the_json(cli: Cli, tmp_path: Path) -> None:
    out = tmp_path / "six.json"
    said = cli("rank", "six-icons", "--people", 20, "--intervals", 0, "--json", out)
    assert said.exit_code == 0, said.stderr
    found = json.loads(out.read_text(encoding="utf-8"))["confusion"]
    assert 0 < found["standard_error"] < found["person_standard_error"] < 0.005

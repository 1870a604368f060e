"""The first run of an installation: what other processes compile is what a ranking then needs."""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from thermicon.perception.ranking import first_run

RANK = """
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import rank
rank(load_library("six-icons"), Rig.load("thenar"), people=8, parameters=2, edits="worst", workers=1)
"""


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Parts for which processes were started, of four cores and a cache that holds nothing."""
    parts: list[str] = []

    def start(command: list[str], **_: Any) -> None:
        parts.append(command[-1])

    monkeypatch.setattr(subprocess, "Popen", start)
    monkeypatch.setattr(first_run, "cores", lambda: 4)
    monkeypatch.setattr("thermicon.circuit.compiled.kept_in", lambda: tmp_path)
    return parts


def test_each_part_is_prepared_by_a_process_of_its_own(begun: list[str]) -> None:
    assert first_run.begin() == 2
    assert begun == ["people", "limits"]


def test_one_core_starts_no_other_process_and_two_start_one(begun: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(first_run, "cores", lambda: 1)
    assert first_run.begin() == 0
    monkeypatch.setattr(first_run, "cores", lambda: 2)
    assert first_run.begin() == 1
    assert begun == ["people"]


def test_what_was_prepared_is_not_prepared_again(begun: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(first_run.PARTS, "people", lambda: None)
    first_run.main("people")
    assert first_run.begin() == 1
    assert begun == ["limits"]


def test_where_nothing_can_be_kept_nothing_is_prepared(begun: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermicon.circuit.compiled.kept_in", lambda: None)
    assert first_run.begin() == 0


def test_a_process_that_cannot_be_started_is_no_fault(begun: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Any, **__: Any) -> None:
        raise OSError("no more processes")

    monkeypatch.setattr(subprocess, "Popen", refused)
    assert first_run.begin() == 0


@pytest.mark.slow
def test_a_ranking_compiles_nothing_that_was_prepared(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    within = {**os.environ, "THERMICON_CACHE": str(cache)}

    def kept() -> Counter[str]:
        names = (entry.name.rpartition("-")[0] for entry in cache.glob("compiled/*/*"))
        return Counter(name.removeprefix("_") for name in names)

    for part in first_run.PARTS:
        subprocess.run([sys.executable, "-m", first_run.__name__, part], check=True, env=within, capture_output=True)
    prepared = kept()
    assert {"report", "all_episodes", "distances", "name", "nearest", "count", "superpose"} <= set(prepared)
    assert "follow" not in prepared
    subprocess.run([sys.executable, "-c", RANK], check=True, env=within, capture_output=True)
    ranked = kept()
    assert ranked["follow"] == ranked["forward"] == 1, "one icon by itself is solved by code of its own"
    again = {name for name, count in prepared.items() if ranked[name] != count}
    assert again <= {"limited"}, "of which there is one for plates and one for receptors"

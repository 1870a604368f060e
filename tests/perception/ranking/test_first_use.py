"""A first ranking compiles beside itself where that can help, and nowhere else."""

import subprocess
import sys
from pathlib import Path

import pytest

from thermicon.perception.ranking import first_use
from thermicon.perception.ranking.first_use import compiled_beside


def test_a_process_is_started_only_on_two_cores_and_where_nothing_is_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    started = list[object]()

    class NoProcess(subprocess.Popen[bytes]):
        def __init__(self, command: list[str], **how: object) -> None:
            started.append(command)
            super().__init__([sys.executable, "-c", "raise SystemExit(3)"], stderr=subprocess.DEVNULL)

    monkeypatch.setattr(subprocess, "Popen", NoProcess)
    monkeypatch.setattr(first_use, "kept_in", lambda: tmp_path)
    compiled_beside(1)()
    assert not started
    compiled_beside(2)()  # it fails, and who waits goes on
    assert len(started) == 1
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "alignment._name-1.py311.nbi").touch()
    compiled_beside(2)()
    monkeypatch.setattr(first_use, "kept_in", lambda: None)
    compiled_beside(2)()
    assert len(started) == 1


def test_one_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(first_use, "kept_in", lambda: tmp_path)
    monkeypatch.setattr(first_use, "LONGEST_S", 0.05)
    compiled_beside(2)()


def test_what_it_uses_is_compiled_for_the_shapes_of_a_ranking() -> None:
    from thermicon.perception import rank
    from thermicon.perception.kernels import alignment, episodes, kernels

    late = alignment.distances, alignment.name, episodes.all_episodes, kernels.nearest
    first_use.compile_late()
    before = [each.signatures for each in late]
    rank("six-icons", people=2, parameters=2)
    assert [each.signatures for each in late] == before

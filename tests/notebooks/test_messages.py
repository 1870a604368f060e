"""Progress on a terminal."""

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks.study.conftest import QUICK, write_study
from thermicon.circuit.safety.playmap import UnjudgedError
from thermicon.notebooks.messages import progress_bar
from thermicon.notebooks.study import build, judging
from thermicon.notebooks.study.judging import StudyRefused


@pytest.mark.skipif(sys.platform == "win32", reason="a pseudo-terminal")
def test_a_bar_says_what_is_left_also_where_the_terminal_says_no_width(monkeypatch: pytest.MonkeyPatch) -> None:
    here, there = os.openpty()  # its size is 0 × 0
    with os.fdopen(there, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress_bar("thinking") as advance:
            assert advance is not None
            first = os.read(here, 4096).decode()
            advance(3, 10)
            time.sleep(0.2)  # a bar is drawn ten times a second
            advance(7, 10)
            later = os.read(here, 4096).decode()
    os.close(here)
    assert "thinking: " in first and "? left" in first
    assert "7/10" in later and " left" in later.rpartition("7/10")[2] and "?" not in later.rpartition("7/10")[2]


def test_several_steps_on_no_terminal_are_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bar("simulating", "judging") as advance, progress_bar("ranking") as none:
        assert advance is not None and none is None
        for step in ((1, 1), (1, 2), (2, 2)):
            advance(*step)
    assert capsys.readouterr().err == "simulating: 1 of 2\nsimulating: 2 of 2; judging …\n"


def test_a_study_whose_drives_are_not_judged_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unjudged(*_: Any, **__: Any) -> Any:
        raise UnjudgedError("not judged: too long")

    monkeypatch.setattr(judging, "export", unjudged)
    with pytest.raises(StudyRefused, match=r"^not judged: too long$"):
        build.make_plan(build.read_materials(write_study(tmp_path, QUICK)), progress_bar, str)


def test_a_study_says_its_plan_before_it_is_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []

    @contextmanager
    def bar(what: str, then: str = "") -> Iterator[Any]:
        told.append(what)
        yield lambda done, total: told.append("a step")

    def refused(*_: Any) -> Any:
        raise StudyRefused(["stop"])

    monkeypatch.setattr(build, "judge_drives", refused)
    with pytest.raises(StudyRefused):
        build.make_plan(build.read_materials(write_study(tmp_path, QUICK)), bar, told.append)
    gap, step, *_, plan, drives = told
    assert (gap, step, drives) == ("gap", "a step", "drives")
    assert "plays each" in plan and " min each, gap " in plan

"""Real exports that are ended at any moment: all of their files are there, or none."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from tests.circuit.surerig import SURE
from thermicon.icons.atomic import stopped_cleanly

posix = pytest.mark.skipif(os.name != "posix", reason="signals work differently there")


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@posix
def test_a_request_to_end_is_an_interrupt(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(KeyboardInterrupt), stopped_cleanly():
        os.kill(os.getpid(), signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@posix
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder where nobody may write")
def test_a_folder_that_takes_no_files_is_one_clear_error(process: Callable[..., Any]) -> None:
    said = process("export", "six-icons", "--icon", "double-dip", "--to", "csv", "-o", "/proc/self", *SURE)
    assert said.exit_code == 1
    assert said.stderr.splitlines()[-1].startswith("cannot write ")
    assert "Traceback" not in said.stderr


@pytest.mark.slow
@posix
def test_a_full_disk_is_one_clear_error_and_leaves_nothing(tmp_path: Path) -> None:
    resource = pytest.importorskip("resource")
    run = subprocess.run(
        [*EXPORT, "-o", "out"], cwd=tmp_path, capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
    )  # fmt: skip
    assert run.returncode == 1
    assert run.stderr.splitlines()[-1] == "cannot write into out: File too large"
    assert names(tmp_path) == []


EXPORT = [sys.executable, "-m", "thermicon.notebooks.cli.main", "export", "six-icons", "--to", "csv", *SURE]


def check_no_partial_file(folder: Path) -> None:
    """All files are there or none, every drive beside its sidecar."""
    found = [path for path in folder.iterdir() if not path.name.startswith(".")] if folder.is_dir() else []
    for path in found:
        if path.suffix == ".json":
            assert json.loads(path.read_text(encoding="utf-8"))["file"] == f"{path.stem}.csv"
        else:
            assert pd.read_csv(path)["event"].iloc[-1].endswith("end")
            assert path.with_suffix(".json").exists()
    assert len(found) in (0, 12)


@posix
@pytest.mark.slow
def test_exports_killed_at_any_moment_leave_no_partial_file(tmp_path: Path) -> None:
    chance = random.Random(3)
    for turn in range(4):
        out = tmp_path / f"out{turn}"
        with subprocess.Popen([*EXPORT, "-o", out], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
            time.sleep(chance.uniform(0.0, 2.0))
            run.kill()
        check_no_partial_file(out)

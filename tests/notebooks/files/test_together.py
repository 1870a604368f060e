"""Real exports that are ended at any moment: all of their files are there, or none.

Every single event of writing a folder is tested in `test_exportfolder.py`; here whole commands are ended.
"""

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
from thermicon.notebooks.files.outputs import stopped_cleanly

posix = pytest.mark.skipif(os.name != "posix", reason="signals work differently there")
EXPORT = [sys.executable, "-m", "thermicon.notebooks.cli.main", "export", "six-icons", "--to", "csv", *SURE]


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
    assert list(tmp_path.iterdir()) == []


@posix
@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_exports_ended_at_any_moment_leave_no_partial_file(tmp_path: Path, number: int) -> None:
    chance, found = random.Random(number), set()
    begun = time.monotonic()
    subprocess.run([*EXPORT, "-o", tmp_path / "whole"], check=True, capture_output=True)
    whole_s = time.monotonic() - begun
    for turn in range(3):
        out = tmp_path / f"out{turn}"
        with subprocess.Popen([*EXPORT, "-o", out], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
            time.sleep(chance.uniform(0.2, 1.0) * whole_s)
            run.send_signal(number)
        found.add(whole_files(out))
        if number != signal.SIGKILL:
            assert list(tmp_path.rglob(".*")) == [], "a draft is left"
    assert found <= {0, 12}


def whole_files(folder: Path) -> int:
    """How many files an export has left: every drive is whole and beside its sidecar."""
    found = list(folder.iterdir()) if folder.is_dir() else []
    for path in found:
        if path.suffix == ".json":
            assert json.loads(path.read_text(encoding="utf-8"))["file"] == f"{path.stem}.csv"
        else:
            assert pd.read_csv(path)["event"].iloc[-1].endswith("end")
            assert path.with_suffix(".json").exists()
    return len(found)

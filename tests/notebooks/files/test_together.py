"""Real exports that are ended at any moment: all of their files are there, or none."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from tests.circuit.surerig import SURE
from thermicon.icons.atomic import stopped_cleanly

KILLS, MANY_KILLS = 20, 200
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

# A real export that has done all its work but the writing: for every folder it is told, a child of it writes there
# again and again, so that signals meet it while it writes.
SERVER = """
import os, signal, sys
from pathlib import Path
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background shell has its children ignore it
from thermicon.circuit.delivery import export_folder as exportfolder
real = exportfolder.publish
def serve(files, folder, replace=False, how=""):
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            print(os.getpid(), flush=True)
            for _ in range(100_000):
                real(files, Path(line.strip()), replace=True)
        os.waitpid(child, 0)
        print("ended", flush=True)
    os._exit(0)
import thermicon.circuit.delivery.export as exporting
exporting.publish = serve
from thermicon.notebooks.cli.main import main
sys.argv = ["thermicon", "export", "six-icons", "--to", "csv", "-o", *sys.argv[1:]]
main()
"""


def check_no_partial_file(folder: Path) -> int:
    """All files are there or none, every drive beside its sidecar; returns how many there are."""
    found = [path for path in folder.iterdir() if not path.name.startswith(".")] if folder.is_dir() else []
    for path in found:
        if path.suffix == ".json":
            assert json.loads(path.read_text(encoding="utf-8"))["file"] == f"{path.stem}.csv"
        else:
            assert pd.read_csv(path)["event"].iloc[-1].endswith("end")
            assert path.with_suffix(".json").exists()
    assert len(found) in (0, 12)
    return len(found)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[subprocess.Popen[str]]:
    """An export of six icons that waits for folders to write into."""
    command = [sys.executable, "-c", SERVER, tmp_path_factory.mktemp("first") / "out", *SURE]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as run:
        yield run
        assert run.stdin is not None
        run.stdin.close()


def kill_many(run: subprocess.Popen[str], folder: Path, times: int, number: int, seed: int) -> list[int]:
    """Send a signal to real exports at random moments of their writing; how many files were found after each."""
    chance, found = random.Random(seed), []
    assert run.stdin is not None
    assert run.stdout is not None
    for turn in range(times):
        run.stdin.write(f"{folder / f'out{turn}'}\n")
        run.stdin.flush()
        child = int(run.stdout.readline())
        time.sleep(chance.uniform(0.0, 0.06))
        os.kill(child, number)
        while (line := run.stdout.readline()) != "ended\n":
            assert line, "the export ended with the child that it started"
        found.append(check_no_partial_file(folder / f"out{turn}"))
    return found


@posix
def test_exports_killed_while_writing_leave_no_partial_file(server: subprocess.Popen[str], tmp_path: Path) -> None:
    assert len(kill_many(server, tmp_path, KILLS, signal.SIGKILL, seed=1)) == KILLS


@pytest.mark.slow
@posix
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_exports_that_are_asked_to_end_leave_no_draft(
    server: subprocess.Popen[str], tmp_path: Path, number: int
) -> None:
    kill_many(server, tmp_path, KILLS // 4, number, seed=2)
    assert [path for path in tmp_path.rglob("*") if path.name.startswith(".")] == []


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


@posix
@pytest.mark.slow
def test_two_hundred_exports_killed_while_writing_leave_no_partial_file(
    server: subprocess.Popen[str], tmp_path: Path
) -> None:
    found = kill_many(server, tmp_path, MANY_KILLS, signal.SIGKILL, seed=4)
    assert set(found) == {0, 12}

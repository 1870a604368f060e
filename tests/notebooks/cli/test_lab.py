"""``thermicon lab``: written or kept notebooks, start and end of its servers."""

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from tests.builders import answers, free_port, missing
from tests.notebooks.conftest import Cli
from thermicon.notebooks.cli import lab

FIRST = "01_first_icon.ipynb"
TRAPS = ("jupyterlab", "json", "numba", "IPython", "ipykernel", "jupyter_server_config")
ALL = [*sorted(path.name for path in (Path(__file__).parents[3] / "notebooks").glob("*.ipynb"))]


def test_the_notebooks_are_put_into_a_folder_and_what_is_there_is_kept(cli: Cli, tmp_path: Path) -> None:
    said = cli("lab", tmp_path / "mine", "--files-only")
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"{tmp_path / 'mine'}: wrote {len(ALL)} notebooks\n"
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ALL
    assert FIRST in ALL and "workbench.ipynb" in ALL
    first = tmp_path / "mine" / FIRST
    first.write_text("mine", encoding="utf-8")
    again = cli("lab", tmp_path / "mine", "--files-only")
    assert f"wrote 0 notebooks, {len(ALL)} there already (--force" in again.stderr
    assert first.read_text(encoding="utf-8") == "mine"
    cli("lab", tmp_path / "mine", "--files-only", "--force")
    assert "%load_ext" in first.read_text(encoding="utf-8")


def test_without_jupyterlab_the_cure_is_told_and_nothing_written(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lab, "find_spec", lambda _: None)
    said = cli("lab", tmp_path / "mine")
    assert said.exit_code == 1
    assert missing(["lab needs jupyterlab, which is not installed:", "install", "jupyterlab"], said.stderr) == []
    assert not (tmp_path / "mine").exists()


def test_jupyterlab_does_not_ask_about_its_news(tmp_path: Path) -> None:
    ask = "from jupyterlab_server.settings_utils import _get_overrides; print(_get_overrides(''))"
    own = lab.environment(tmp_path)
    said = subprocess.run([sys.executable, "-c", ask], env=own, capture_output=True, text=True, check=True).stdout
    assert "'fetchNews': 'false'" in said


def test_a_server_that_fails_is_told(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failing = [sys.executable, "-c", "raise SystemExit(4)"]
    monkeypatch.setattr(lab, "command_of", lambda *_: failing)
    said = cli("lab", tmp_path)
    assert said.exit_code == 1
    assert "ended with an error (exit code 4)" in said.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="signals work differently there")
@pytest.mark.slow
@pytest.mark.parametrize("how", ["Ctrl-C", "asked to end"])
def test_a_server_starts_and_ends_and_imports_nothing_from_the_folder(tmp_path: Path, how: str) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    for name in TRAPS:
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / ('ran-' + name))!r}, 'w')\n")
    port = free_port()
    own = {f"JUPYTER_{name.upper()}_DIR": str(tmp_path / name) for name in ("config", "data", "runtime")}
    command = [sys.executable, "-P", "-m", "thermicon.notebooks.cli.main", "lab", ".", "--no-browser", "--allow-root"]
    program = subprocess.Popen(
        [*command, "--port", str(port)],
        cwd=folder,
        env={**os.environ, **own},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell that runs tests in the background has them ignore Ctrl-C, and children inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        assert answers(f"http://127.0.0.1:{port}/api", program.poll)
        if how == "Ctrl-C":
            os.killpg(program.pid, signal.SIGINT)
        else:
            program.terminate()
        _, said = program.communicate(timeout=25)
    finally:
        if program.poll() is None:
            os.killpg(program.pid, signal.SIGKILL)
            program.wait()
    assert program.returncode == 130, said
    assert said.splitlines()[-1] == "interrupted"
    assert "Traceback" not in said
    assert not list(tmp_path.glob("ran-*")), "a file of the folder was imported"
    with socket.socket() as again, pytest.raises(ConnectionRefusedError):
        again.connect(("127.0.0.1", port))

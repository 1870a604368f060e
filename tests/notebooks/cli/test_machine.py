"""Outside programs, cache, threads, fonts, shipped files, and what Jupyter needs."""

from __future__ import annotations

import json
import sys
from importlib.metadata import Distribution
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from thermicon.notebooks.cli import jupyter, machine, programs


def test_programs_that_are_missing_are_notes_with_their_purpose(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(sys, "platform", "linux")
    assert [(each.check, each.state) for each in programs.check_programs()] == [
        ("ngspice", "note"),
        ("C compiler", "note"),
        ("Chromium", "note"),
    ]
    first = next(programs.check_programs())
    assert first.text == "not installed; only needed for running what netlist writes"
    assert first.cure == "sudo apt install ngspice, or the package of that name of your system"


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a shell script")
@pytest.mark.parametrize(
    ("script", "version"),
    [("echo '** spice-39 : simulator'", " (spice-39 : simulator)"), ("echo none", ""), ("echo 4; exit 3", "")],
)
def test_a_program_states_its_version_or_nothing(tmp_path: Path, script: str, version: str) -> None:
    path = tmp_path / "ngspice"
    path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    path.chmod(0o755)
    assert programs.version_of(str(path)) == version


def test_the_cache_is_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "cache"))
    (fresh,) = machine.check_cache()
    assert (fresh.state, fresh.text) == ("ok", f"{tmp_path / 'cache'}, writable, 0 MB")
    older = tmp_path / "cache" / "compiled" / "numba-0.1"
    older.mkdir()
    (older / "code").write_bytes(bytes(2_000_000))
    (stale,) = machine.check_cache()
    assert stale.state == "note"
    assert stale.text.endswith("writable, 2 MB, 2 MB of it compiled by other versions")
    assert stale.cure == f"delete {older}, or leave it: unused code goes"
    monkeypatch.setattr(machine, "LARGE_MB", 1.0)
    (large,) = machine.check_cache()
    assert large.cure == f"delete {tmp_path / 'cache'}, from which nothing is lost but time"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows keeps folders private by access lists")
def test_a_cache_that_others_can_write_is_noted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "everybody"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("THERMICON_CACHE", str(folder))
    (finding,) = machine.check_cache()
    assert finding.state == "note"
    assert "every run compiles its code again" in finding.text
    assert finding.cure == "set THERMICON_CACHE to a folder that only you can write to"


@pytest.mark.parametrize(
    ("value", "state", "words"),
    [
        (None, "ok", "cores may be used"),
        ("900", "ok", "cores may be used"),
        ("1", "note", "but NUMBA_NUM_THREADS=1 allows fewer threads"),
        ("many", "fault", "NUMBA_NUM_THREADS=many is not a number of threads"),
        ("0", "fault", "NUMBA_NUM_THREADS=0 is not a number of threads"),
    ],
)
def test_limits_of_threads(value: str | None, state: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermicon.circuit.cores.available", lambda: 4)
    for name in machine.THREADS:
        monkeypatch.delenv(name, raising=False)
    if value is not None:
        monkeypatch.setenv("NUMBA_NUM_THREADS", value)
    (finding,) = machine.check_threads()
    assert finding.state == state
    assert words in finding.text


def test_the_font_of_figures_has_every_sign(monkeypatch: pytest.MonkeyPatch) -> None:
    (finding,) = machine.check_fonts()
    assert (finding.state, "DejaVu Sans" in finding.text) == ("ok", True)
    monkeypatch.setattr(machine, "WRITTEN", "A \u3042")
    (lacking,) = machine.check_fonts()
    assert lacking.state == "note"
    assert "lacks \u3042" in lacking.text


def test_a_shipped_file_that_is_missing_is_a_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "thermicon-9.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: thermicon\nVersion: 9\n", encoding="utf-8")
    names = ("thermicon/icons/data/a.toml", "thermicon/icons/b.cue")
    (info / "RECORD").write_text("".join(f"{name},,\n" for name in names), encoding="utf-8")
    monkeypatch.setattr("importlib.metadata.distribution", lambda _: Distribution.at(info))
    (tmp_path / "thermicon/icons").mkdir(parents=True)
    (tmp_path / names[1]).touch()
    (finding,) = machine.check_data()
    assert (finding.state, finding.text) == ("fault", f"1 of 2 shipped files are missing, such as {names[0]}")
    assert finding.cure is not None
    assert "--force-reinstall" in finding.cure


def extension(folder: Path, name: str, version: str) -> None:
    """Put an extension of JupyterLab into a folder."""
    (folder / name).mkdir(parents=True)
    (folder / name / "package.json").write_text(json.dumps({"name": name, "version": version}), encoding="utf-8")


def test_extensions_that_show_widgets_are_looked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    versions = {"jupyterlab_widgets": "3.0.16", "anywidget": "0.11.0"}
    monkeypatch.setattr(jupyter, "installed_version", lambda name: versions.get(name, "4.6"))
    monkeypatch.setattr("jupyter_core.paths.jupyter_path", lambda *_: [str(tmp_path / "none"), str(tmp_path)])
    manager = "@jupyter-widgets/jupyterlab-manager"
    missing, also = jupyter.check_widgets()
    assert (missing.state, missing.text) == ("fault", f"JupyterLab does not find {manager}, which shows the workbench")
    assert missing.cure is not None
    assert missing.cure.endswith("jupyterlab_widgets")
    assert "anywidget" in also.text
    extension(tmp_path, manager, "5.0.16")
    extension(tmp_path, "anywidget", "0.9.0")
    (older,) = jupyter.check_widgets()
    assert "finds anywidget 0.9.0" in older.text
    assert "anywidget 0.11.0 is installed" in older.text
    versions["anywidget"] = "0.9.18"
    (fine,) = jupyter.check_widgets()
    assert fine.text == "jupyterlab 4.6, ipywidgets 4.6, jupyterlab_widgets 3.0.16, anywidget 0.9.18"


@pytest.mark.parametrize(
    ("python", "state", "words"),
    [
        ("python", "ok", "the Python of the notebook server"),
        (sys.executable, "ok", sys.executable),
        ("/nowhere/bin/python3", "fault", "names /nowhere/bin/python3, which is not there (/specs/python3)"),
        ("/bin/sh", "fault", "notebooks do not find thermicon: python3 runs /bin/sh"),
    ],
)
def test_the_kernel_is_this_python(python: str, state: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = SimpleNamespace(argv=[python, "-m", "ipykernel_launcher"], resource_dir="/specs/python3")

    def get(_self: Any, _name: str) -> SimpleNamespace:
        return spec

    monkeypatch.setattr("jupyter_client.kernelspec.KernelSpecManager.get_kernel_spec", get)
    (finding,) = jupyter.check_kernel()
    assert finding.state == state
    assert words in finding.text
    assert finding.cure == (None if state == "ok" else f"{sys.executable} -m ipykernel install --sys-prefix")

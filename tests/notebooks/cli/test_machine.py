"""Shipped files, cache, ngspice, and the Python that runs notebooks."""

from __future__ import annotations

import sys
from importlib.metadata import Distribution
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from thermicon.notebooks.cli import machine


def test_ngspice_that_is_missing_is_a_note_with_its_purpose(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [each.state for each in machine.check_ngspice()] == ["ok"]
    monkeypatch.setenv("PATH", "")
    (finding,) = machine.check_ngspice()
    assert (finding.state, finding.text) == ("note", "not installed; only needed for running a netlist")


def test_the_cache_is_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "cache"))
    (fresh,) = machine.check_cache()
    assert (fresh.state, fresh.text.partition(";")[0]) == ("ok", f"{tmp_path / 'cache'}, writable, 0 MB")
    (tmp_path / "cache" / "compiled" / "code").write_bytes(bytes(2_000_000))
    (kept,) = machine.check_cache()
    assert "writable, 2 MB" in kept.text


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
    (finding,) = machine.check_kernel()
    assert finding.state == state
    assert words in finding.text
    assert finding.cure == (None if state == "ok" else f"{sys.executable} -m ipykernel install --sys-prefix")

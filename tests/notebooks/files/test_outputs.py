"""Where files go: looked at early, complete or absent."""

import os
import re
import sys
from pathlib import Path

import pytest

from thermicon.base.files.atomic import OutputError, check_folder, complete_or_absent
from thermicon.notebooks.files.outputs import STDOUT, TRACE_SUFFIXES, check_output


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("out.txt", r"a trace is written as \.csv or \.parquet, not \.txt$"),
        ("out", r"\.csv or \.parquet, and this name has no ending$"),
        ("absent/out.csv", r"the folder .*absent does not exist; make it first"),
        (".", "it is a folder; give the name of a file"),
        ("file/out.csv", "is a file, not a folder"),
        ("a.parquet", r"a\.parquet.* pyarrow.*pip install .*pyarrow.*\.csv"),
    ],
)
def test_a_name_that_cannot_be_is_told_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, words: str
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=words):
        check_output(tmp_path / name, TRACE_SUFFIXES, "a trace")


@pytest.mark.parametrize(
    ("mark", "command"),
    [
        ("conda-meta", "conda install -c conda-forge pyarrow,"),
        ("pipx_metadata.json", "pipx inject thermicon pyarrow,"),
        ("uv-receipt.toml", "uv tool install thermicon -w pyarrow,"),
        ("pyvenv.cfg", f"{sys.executable} -m pip install pyarrow,"),
    ],
)
def test_the_cure_adds_to_the_environment_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mark: str, command: str
) -> None:
    (tmp_path / mark).touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(OutputError, match=re.escape(command)):
        check_output(tmp_path / "a.parquet", TRACE_SUFFIXES, "a trace")


def test_a_file_is_no_folder_for_figures(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(OutputError, match="it is a file; give the name of a folder"):
        check_folder(file)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_a_read_only_folder_is_told(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="is not writable"):
            check_output(tmp_path / "out.csv", TRACE_SUFFIXES, "a trace")
    finally:
        tmp_path.chmod(0o700)


def test_stdout_and_good_names_pass(tmp_path: Path) -> None:
    check_output(STDOUT, TRACE_SUFFIXES, "a trace")
    check_output(tmp_path / "OUT.CSV", TRACE_SUFFIXES, "a trace")
    check_folder(tmp_path / "to-be-made")


@pytest.mark.parametrize("error", [RuntimeError("half way"), OSError(28, "No space left on device")])
def test_a_failure_half_way_leaves_the_old_file_alone(tmp_path: Path, error: Exception) -> None:
    goal = tmp_path / "out.csv"
    goal.write_text("old")
    told = OutputError if isinstance(error, OSError) else RuntimeError
    with pytest.raises(told, match=r"half way|No space left"), complete_or_absent(goal) as draft:
        draft.write_text("ne")
        raise error
    assert goal.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv"]


def test_success_replaces_the_old_file_and_a_link_stays_a_link(tmp_path: Path) -> None:
    goal, link = tmp_path / "goal.csv", tmp_path / "link.csv"
    goal.write_text("old")
    link.symlink_to(goal)
    with complete_or_absent(link) as draft:
        assert draft.parent == goal.parent
        assert draft.suffix == goal.suffix
        draft.write_text("new")
    assert link.is_symlink()
    assert goal.read_text() == "new"

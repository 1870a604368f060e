"""Where files go: looked at early, complete or absent."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from thermicon.icons.atomic import OutputError, check_folder, complete_or_absent
from thermicon.notebooks.files.outputs import STDOUT, TRACE_SUFFIXES, check_output


def test_another_suffix_names_the_two_that_work(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"a trace is written as \.csv or \.parquet, not \.txt$"):
        check_output(tmp_path / "out.txt", TRACE_SUFFIXES, "a trace")


def test_no_suffix_is_told_as_that(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"\.csv or \.parquet, and this name has no ending$"):
        check_output(tmp_path / "out", TRACE_SUFFIXES, "a trace")


def test_parquet_without_pyarrow_names_the_cure_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(OutputError, match=r'a\.parquet.* pyarrow.*pip install "thermicon\[parquet\]".*\.csv'):
        check_output(tmp_path / "a.parquet", TRACE_SUFFIXES, "a trace")
    check_output(tmp_path / "a.csv", TRACE_SUFFIXES, "a trace")


def test_a_missing_folder_is_told_before_anything_is_computed(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"the folder .*absent does not exist; make it first"):
        check_output(tmp_path / "absent" / "out.csv", TRACE_SUFFIXES, "a trace")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="it is a folder; give the name of a file"):
        check_output(tmp_path, TRACE_SUFFIXES, "a trace")


def test_a_file_is_no_folder_to_write_in(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(OutputError, match="is a file, not a folder"):
        check_output(file / "out.csv", TRACE_SUFFIXES, "a trace")


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


def test_a_failure_half_way_leaves_the_old_file_alone(tmp_path: Path) -> None:
    goal = tmp_path / "out.csv"
    goal.write_text("old")
    with pytest.raises(RuntimeError, match="half way"), complete_or_absent(goal) as draft:
        draft.write_text("ne")
        raise RuntimeError("half way")
    assert goal.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv"]


def test_success_replaces_the_old_file(tmp_path: Path) -> None:
    goal = tmp_path / "out.csv"
    goal.write_text("old")
    with complete_or_absent(goal) as draft:
        assert draft.parent == goal.parent
        assert draft.suffix == goal.suffix
        draft.write_text("new")
    assert goal.read_text() == "new"


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    goal, link = tmp_path / "goal.csv", tmp_path / "link.csv"
    goal.write_text("old")
    link.symlink_to(goal)
    with complete_or_absent(link) as draft:
        draft.write_text("new")
    assert link.is_symlink()
    assert goal.read_text() == "new"


def test_a_full_disk_is_told_without_a_traceback_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No space left"), complete_or_absent(tmp_path / "out.csv") as draft:
        draft.write_text("ne")
        raise OSError(28, "No space left on device")
    assert not list(tmp_path.iterdir())

"""Answers of a study that survive every fault."""

import importlib
import os
import random
import shutil
import subprocess
import sys
import time
import types
from pathlib import Path
from typing import Any

import pytest

from .conftest import rows_of, run_script

HEADER = "participant,trial,presented,responded,time_s\n"
FAULTY = Path(__file__).with_name("faulty_disk.py")
ANSWERS = "sub-A_task-quick_answers.csv"
SLOW = pytest.mark.slow


@pytest.fixture
def module(quick: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the study's folder that reads and writes tables."""
    monkeypatch.syspath_prepend(str(quick))
    monkeypatch.delitem(sys.modules, "study_answers", raising=False)
    return importlib.import_module("study_answers")


def files(module: Any, folder: Path) -> Any:
    """The tables of the small study in a folder."""
    return module.StudyFiles(folder, module.read_study())


def simulate(quick: Path, folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    return run_script(quick, folder, "--participant", "A", "--simulate", *arguments)


def failing(quick: Path, folder: Path, fault: str, count: int, *more: str) -> subprocess.CompletedProcess[str]:
    """Run participant A on a disk that fails after so many bytes; `promised` has what was on the disk."""
    script = [quick / "run_study.py", "--output", folder, "--participant", "A", "--simulate", *more]
    command = [sys.executable, FAULTY, fault, count, folder.parent / "promised", *script]
    return subprocess.run(list(map(str, command)), capture_output=True, encoding="utf-8", timeout=60, check=False)


def check_all_answers(quick: Path, folder: Path, promised: bytes = b"") -> None:
    """Resume and collect work; each trial has one answer, and the rows that were promised are as they were."""
    resumed = simulate(quick, folder, "--resume")
    assert (resumed.returncode, resumed.stderr) == (0, ""), resumed.stdout
    lines = (folder / ANSWERS).read_bytes().splitlines()
    rows = rows_of(folder / ANSWERS)
    assert [row["trial"] for row in rows] == list("12345678")
    planned = {row["trial"]: row["icon"] for row in rows_of(quick / "sub-A_task-quick_conditions.csv")}
    assert all(row["presented"] == planned[row["trial"]] and row["responded"] in ("dip", "glow") for row in rows)
    lost = [row for row in promised.splitlines() if row.startswith(b"A,") and row not in lines]
    assert not lost, "rows that were on the disk"
    collected = run_script(quick, folder, "--collect")
    assert (collected.returncode, collected.stderr) == (0, "") and "8 answers of 1 participant\n" in collected.stdout


@pytest.mark.parametrize("fault", ["full", "kill"])
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=SLOW) for seed in range(2, 10))])
def test_a_run_that_was_killed_or_had_a_full_disk_is_resumed(
    fault: str, seed: int, quick: Path, tmp_path: Path
) -> None:
    folder, promised = tmp_path / "data", tmp_path / "promised"
    promised.touch()
    ran = failing(quick, folder, fault, random.Random(f"{fault} {seed}").randrange(700))
    assert ran.returncode == (3 if fault == "full" else -9), ran.stderr
    if fault == "full":
        count = promised.read_bytes().count(b"\nA,")
        last = f"trial {count} is the last on the disk" if count else "no trial is on the disk"
        assert "No space left on device; make room there" in ran.stdout and last in ran.stdout, ran.stdout
        assert "A: SWITCHED OFF: " in ran.stdout and ran.stderr == ""
        assert not list(folder.glob("*.lock")), "a run that ends by itself leaves no lock"
    check_all_answers(quick, folder, promised.read_bytes())


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=SLOW) for seed in range(2, 10))])
def test_a_table_that_was_torn_is_resumed_and_the_torn_row_kept(seed: int, quick: Path, tmp_path: Path) -> None:
    rng = random.Random(f"torn {seed}")
    simulate(quick, tmp_path, "--press", "70:q")
    events = tmp_path / "sub-A" / "beh" / "sub-A_task-quick_run-1_events.tsv"
    whole, torn = {}, {}
    for path in (tmp_path / ANSWERS, events):
        content = path.read_bytes()
        path.write_bytes(content[: rng.randrange(len(content))])
        whole[path], _, torn[path] = path.read_bytes().rpartition(b"\n")
    resumed = simulate(quick, tmp_path, "--resume", "--press", "1:q")
    for path in whole:
        beside = path.with_name(f"{path.stem}.torn-1{path.suffix}")
        assert (beside.read_bytes() if beside.exists() else b"") == torn[path]
        told = f"{path.name}: 1 line torn or doubled, left out, kept in {beside.name}"
        assert (told in resumed.stdout) == bool(torn[path]), resumed.stdout
    assert events.read_bytes().rstrip(b"\n") in (whole[events], events.read_bytes().splitlines()[0])
    check_all_answers(quick, tmp_path, whole[tmp_path / ANSWERS])


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=SLOW) for seed in range(1, 10))])
def test_two_runs_of_a_participant_at_once_give_each_answer_once(seed: int, quick: Path, tmp_path: Path) -> None:
    command = [sys.executable, quick / "run_study.py", "--output", tmp_path, "--participant", "A", "--simulate"]
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([*map(str, command)], **pipes) as one:
        time.sleep(random.Random(f"doubled {seed}").uniform(0.0, 0.06))
        with subprocess.Popen([*map(str, command)], **pipes) as two:
            said = [(*run.communicate(timeout=60), run.returncode) for run in (one, two)]
    assert sorted(code for _, _, code in said) == [0, 1], said
    refused = next(error for _, error, code in said if code)
    assert "participant A runs already into" in refused or "has 8 trials already" in refused, refused
    check_all_answers(quick, tmp_path)


def test_a_participant_has_one_run_in_a_folder_and_a_lock_without_a_run_stops_nobody(
    module: Any, quick: Path, tmp_path: Path
) -> None:
    lock = tmp_path / "sub-A_task-quick.lock"
    with files(module, tmp_path).claimed("A"):
        assert lock.stat().st_size == 0, "what tried whether there is room is gone"
        second = simulate(quick, tmp_path)
        assert second.returncode == 1 and second.stderr.strip() == (
            f"participant A runs already into {tmp_path}: end that run, or give another --output"
        )
        assert lock.exists() and not (tmp_path / ANSWERS).exists(), "the second one touches nothing"
        other = run_script(quick, tmp_path, "--participant", "B", "--simulate")
        assert other.returncode == 0, "another participant may run into the same folder"
    assert not lock.exists()
    lock.write_bytes(b"left by a run that was killed")
    assert simulate(quick, tmp_path).returncode == 0


NO_ROOM = """
def put(file, content):
    raise OSError(28, "No space left on device")
"""
NO_RIGHT = """
def mkdir(*_, **__):
    raise OSError(30, "Read-only file system")
Path.mkdir = mkdir
"""


@pytest.mark.parametrize(
    ("fault", "words"), [(NO_ROOM, "No space left on device"), (NO_RIGHT, "Read-only file system")], ids=["full", "ro"]
)
def test_a_disk_that_takes_nothing_is_told_before_anything_is_put_out(
    fault: str, words: str, quick: Path, tmp_path: Path
) -> None:
    study = Path(shutil.copytree(quick, tmp_path / "study"))
    with (study / "study_answers.py").open("a", encoding="utf-8") as file:
        file.write(fault)
    with (study / "play_icons.py").open("a", encoding="utf-8") as file:
        file.write("\nraise RuntimeError('the display was touched')\n")
    ran = simulate(study, tmp_path / "data")
    assert (ran.returncode, ran.stdout) == (1, "")
    assert ran.stderr.strip() == (
        f"{tmp_path / 'data'}: {words}; make room there, allow writing, or give another --output"
    )
    assert not (tmp_path / "data").exists()


def test_a_folder_that_is_a_file_or_a_table_that_is_a_folder_is_told(quick: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "data" / ANSWERS).mkdir(parents=True)
    for arguments, folder, words in (
        (("--participant", "A", "--simulate"), tmp_path / "file", "file: File exists; make room"),
        (("--participant", "A", "--simulate"), tmp_path / "data", "answers.csv: Is a directory; make room"),
        (("--collect",), tmp_path / "data", "answers.csv: Is a directory; make room"),
    ):
        ran = run_script(quick, folder, *arguments)
        assert ran.returncode == 1 and words in ran.stderr and "Traceback" not in ran.stderr


def test_a_table_that_cannot_be_written_to_is_told_at_the_start(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ANSWERS).write_text(HEADER, encoding="utf-8")
    opens = Path.open

    def protected(path: Path, mode: str = "r", *more: Any, **named: Any) -> Any:
        if path.name == ANSWERS and "a" in mode:
            raise PermissionError(13, "Permission denied")
        return opens(path, mode, *more, **named)

    monkeypatch.setattr(Path, "open", protected)
    told = pytest.raises(module.NoDisk, match=r"answers\.csv: Permission denied; make room there, allow writing")
    with told, files(module, tmp_path).claimed("A"):
        pytest.fail("it ran")


def test_stimuli_that_find_no_room_are_told(quick: Path, tmp_path: Path) -> None:
    study = Path(shutil.copytree(quick, tmp_path / "study"))
    with (study / "study_answers.py").open("a", encoding="utf-8") as file:
        file.write("\n\nimport shutil\ndef copyfile(*_):\n    raise OSError(28, 'No space left on device')\n")
        file.write("shutil.copyfile = copyfile\n")
    ran = simulate(study, tmp_path / "data")
    assert (ran.returncode, ran.stdout) == (1, "") and "data: No space left on device; make room" in ran.stderr


def test_a_row_is_whole_where_the_system_takes_it_in_parts_and_a_file_is_as_it_was_where_it_takes_none(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writes = os.write
    monkeypatch.setattr(module.os, "write", lambda file, content: writes(file, content[:3]))
    module.DurableTable(tmp_path / ANSWERS, module.ANSWERS).add({"participant": "A", "trial": 1, "presented": "dip"})
    assert (tmp_path / ANSWERS).read_text(encoding="utf-8") == f"{HEADER}A,1,dip,n/a,n/a\n"

    def full(file: int, content: bytes) -> int:
        raise OSError(28, "No space left on device")

    before = (tmp_path / ANSWERS).read_bytes()
    monkeypatch.setattr(module.os, "write", full)
    with pytest.raises(module.NoDisk, match=r"answers\.csv: No space left on device"):
        module.write_whole(tmp_path / ANSWERS, b"another")
    assert (tmp_path / ANSWERS).read_bytes() == before and len(list(tmp_path.iterdir())) == 1


def test_each_torn_row_has_a_file_of_its_own(module: Any, tmp_path: Path) -> None:
    for number, torn in ((1, "A,2,dip"), (2, "A,3,gl")):
        files(module, tmp_path).given_answers("A")
        module.DurableTable(tmp_path / ANSWERS, module.ANSWERS).add({"participant": "A", "trial": number})
        with (tmp_path / ANSWERS).open("a", encoding="utf-8") as file:
            file.write(torn)
    assert list(files(module, tmp_path).given_answers("A")) == [1, 2]
    kept = [tmp_path / f"sub-A_task-quick_answers.torn-{number}.csv" for number in (1, 2)]
    assert [path.read_text(encoding="utf-8") for path in kept] == ["A,2,dip", "A,3,gl"]
    assert len(list(tmp_path.iterdir())) == 3, "no draft is left"


GLUED = "A,3,dip,dA,4,glow,glow,2.300\n"
TABLES: dict[str, tuple[str, list[str], int]] = {
    "empty": ("", [], 0),
    "torn header": (HEADER[:20], [], 1),
    "header without its end": (HEADER[:-1], [], 1),
    "header alone": (HEADER, [], 0),
    "a row without its end": (f"{HEADER}A,1,dip,dip,4.2\nA,2,dip,dip,4.213", ["1"], 1),
    "glued": (f"{HEADER}A,1,dip,dip,4.2\n{GLUED}A,5,dip,dip,4.2\n", ["1", "5"], 1),
    "glued in the first cell": (f"{HEADER}A,1,dip,dip,4.2\nAA,2,dip,dip,4.2\n", ["1"], 1),
    "doubled": (f"{HEADER}A,1,dip,dip,4.2\nA,1,dip,glow,5.1\n", ["1"], 1),
    "too few cells": (f"{HEADER}A,1,dip,dip,4.2\nA,2,dip,dip\n", ["1"], 1),
    "no number": (f"{HEADER}A,x,dip,dip,4.2\nA,0,dip,dip,4.2\nA,1x,dip,dip,4.2\n", [], 3),
    "zeros": (f"{HEADER}A,1,dip,dip,4.2\n\0\0\0\0", ["1"], 1),
    "by a spreadsheet": ("\ufeff" + f"{HEADER}A,1,dip,,\n\n".replace("\n", "\r\n"), ["1"], 0),
}


@pytest.mark.parametrize("name", TABLES)
def test_only_whole_rows_are_answers(
    name: str, module: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content, trials, damaged = TABLES[name]
    path = tmp_path / ANSWERS
    path.write_bytes(content.encode("utf-8"))
    rows, torn = files(module, tmp_path).read_answers("A")
    assert ([row["trial"] for row in rows], len(torn)) == (trials, damaged)
    assert list(files(module, tmp_path).given_answers("A")) == [int(trial) for trial in trials]
    assert (f"{damaged} line" in capsys.readouterr().out) == (damaged > 0)
    assert path.with_name("sub-A_task-quick_answers.torn-1.csv").exists() == (damaged > 0)
    module.DurableTable(path, module.ANSWERS).add(
        {"participant": "A", "trial": 8, "presented": "dip", "responded": "dip"}
    )
    assert path.read_text("utf-8-sig").splitlines()[0] == HEADER.strip(), "the header comes before the first row"
    assert [row["trial"] for row in files(module, tmp_path).read_answers("A")[0]] == [*trials, "8"]


def test_a_table_of_something_else_is_refused_and_kept(module: Any, quick: Path, tmp_path: Path) -> None:
    for text in ("participant,trial,answer\nA,1,dip\n", "A,1,dip,dip,4.2\n"):
        (tmp_path / ANSWERS).write_text(text, encoding="utf-8")
        for arguments in (("--participant", "A", "--simulate", "--resume"), ("--collect",)):
            ran = run_script(quick, tmp_path, *arguments)
            assert ran.returncode == 1 and "its first line is not participant,trial,presented" in ran.stderr
        assert (tmp_path / ANSWERS).read_text(encoding="utf-8") == text


def test_a_trial_that_is_missing_in_the_middle_is_asked_again(quick: Path, tmp_path: Path) -> None:
    simulate(quick, tmp_path)
    path = tmp_path / ANSWERS
    path.write_text(path.read_text(encoding="utf-8").replace("\nA,3,", "\nA,3,dip,dA,3,"), encoding="utf-8")
    collected = run_script(quick, tmp_path, "--collect")
    assert "1 line torn or doubled, left out\n" in collected.stdout and "7 answers of" in collected.stdout
    resumed = simulate(quick, tmp_path, "--resume")
    assert "A: done; 8 answers" in resumed.stdout
    assert [row["trial"] for row in rows_of(path)] == list("12456783")


def test_a_file_that_cannot_be_locked_is_told_and_not_taken_for_a_second_run(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_locks(*_: object) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setitem(sys.modules, "fcntl", types.SimpleNamespace(flock=no_locks, LOCK_EX=2, LOCK_NB=4))
    told = pytest.raises(module.NoDisk, match=r"No locks available; .* or give another --output")
    with told, files(module, tmp_path).claimed("A"):
        pytest.fail("it ran")


def test_on_windows_a_byte_of_the_file_is_locked(module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a stand-in for msvcrt: `locking` locks bytes from where the file stands, and fails where another has them."""
    held: set[tuple[int, int]] = set()

    def locking(file: int, mode: int, count: int) -> None:
        assert (mode, count) == (2, 1)
        place = os.fstat(file).st_ino, os.lseek(file, 0, os.SEEK_CUR)
        if place in held:
            raise PermissionError(13, "Permission denied")
        held.add(place)

    monkeypatch.setitem(sys.modules, "fcntl", None)
    monkeypatch.setitem(sys.modules, "msvcrt", types.SimpleNamespace(locking=locking, LK_NBLCK=2))
    (tmp_path / "sub-A_task-quick.lock").write_bytes(b"left by a run that was killed")
    refused = pytest.raises(SystemExit, match="participant A runs already")
    with files(module, tmp_path).claimed("A"), refused, files(module, tmp_path).claimed("A"):
        pytest.fail("it ran")


def test_a_lock_whose_file_was_removed_is_no_lock(module: Any, tmp_path: Path) -> None:
    """The run before removes its file when it ends; who had opened it by then must not believe to hold the name."""
    path = tmp_path / "sub-A_task-quick.lock"
    with path.open("ab") as file:
        path.unlink()
        assert not module.locked(file, path)
        path.touch()
        assert not module.locked(file, path)
    with path.open("ab") as file:
        assert module.locked(file, path)

"""An export folder: all files of an export or none, whenever it ends, and nobody's work is lost."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.surerig import SURE
from thermicon.notebooks.files import export_folder as exportfolder
from thermicon.notebooks.files import swapping
from thermicon.notebooks.files.export_folder import check_export_folder, publish
from thermicon.notebooks.files.locking import lock
from thermicon.notebooks.files.outputs import OutputError

DYING = Path(__file__).with_name("dying.py")
posix = pytest.mark.skipif(os.name != "posix", reason="needs fork and signals")
CASES = ("new", "empty", "added", "forced")


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def drive(name: str, content: bytes, suffix: str = ".csv", **shared: bytes) -> dict[str, bytes]:
    """A drive with its sidecar, as far as their claims go."""
    about = {
        "thermicon": "0",
        "file": f"{name}{suffix}",
        "drive_sha256": digest(content),
        "set_files": {each: digest(held) for each, held in shared.items()},
    }
    return {f"{name}.json": json.dumps(about).encode(), f"{name}{suffix}": content, **shared}


def held(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


class TestEnds:
    """Exports that end at any of their events."""

    def check(self, tmp_path: Path, case: str, way: str, how: str, first: int, step: int) -> None:
        command = [sys.executable, DYING, tmp_path, case, way, str(first), str(step), how]
        run = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        assert run.returncode == 0, run.stderr
        events = [json.loads(line) for line in run.stdout.splitlines()]
        assert len(events) >= 15 // step
        states = []
        for event in events:
            assert (event["code"] == -9) == (way == "kill"), event
            for moment in ("then", "after"):
                found = event[moment]
                if found is None:  # two renames: between them the old folder is aside, until the next export
                    assert case == "new" or (how, moment) == ("plain", "then"), event
                    states.append(False)
                    continue
                new = {name for name, content in found.items() if content.startswith("new")}
                assert new in (set(), {"c.csv"} if case == "added" else {"a.csv", "c.csv"}), event
                self.whole(found, case, new)
                states.append(bool(new))
            assert {"later.csv", "later.json"} <= set(event["after"]), event
            assert event["at_last"] == ["drives"], event
            if event["code"] in (6, 8):
                assert event["left"] == [] or set(event["left"]) == {".drives.thermicon-part"}, event
        assert set(states) == {False, True}, "no event was before, or none after, the moment that counts"

    def whole(self, found: dict[str, str], case: str, new: set[str]) -> None:
        """Every drive has the sidecar of just these bytes; what was there stays."""
        for name in new:
            assert json.loads(found[name.replace("csv", "json")])["drive_sha256"] == digest(found[name].encode())
        if case in ("added", "forced"):
            assert (found["b.csv"], found["notes.txt"]) == ("stays", "mine")
            assert "b.json" in found
            assert json.loads(found["a.json"])["drive_sha256"] == digest(found["a.csv"].encode())
        assert {name.partition(".")[0] for name in found if name != "notes.txt"} <= {"a", "b", "c", "later"}
        assert all(found.keys() >= {f"{name.partition('.')[0]}.json"} for name in found if name.endswith(".csv"))

    @posix
    @pytest.mark.parametrize("case", CASES)
    def test_killed_at_some_events(self, tmp_path: Path, case: str) -> None:
        self.check(tmp_path, case, "kill", "swap", 2, 3)

    @posix
    @pytest.mark.parametrize("way", ["interrupt", "full"])
    def test_interrupted_or_out_of_room_at_some_events(self, tmp_path: Path, way: str) -> None:
        self.check(tmp_path, "forced", way, "swap", 1, 2)

    @posix
    def test_killed_where_folders_cannot_be_exchanged(self, tmp_path: Path) -> None:
        self.check(tmp_path, "forced", "kill", "plain", 1, 2)

    @posix
    @pytest.mark.slow
    @pytest.mark.parametrize("how", ["swap", "plain"])
    @pytest.mark.parametrize("way", ["kill", "interrupt", "full"])
    @pytest.mark.parametrize("case", CASES)
    def test_ended_at_every_event(self, tmp_path: Path, case: str, way: str, how: str) -> None:
        self.check(tmp_path, case, way, how, 1, 1)


class TestFolders:
    """Which folder an export may have for its own."""

    @pytest.mark.parametrize(
        ("prepare", "words"),
        [
            (lambda at: (at / "sub").mkdir(), r"it contains a folder, sub, .*give a folder of its own, such as -o"),
            (lambda at: (at / "link").symlink_to("a"), "it contains a link, link"),
            (lambda at: os.mkfifo(at / "pipe"), "it contains a device or pipe, pipe"),
        ],
    )
    def test_what_is_no_plain_file_is_told(self, tmp_path: Path, prepare: Callable[[Path], None], words: str) -> None:
        out = tmp_path / "out"
        out.mkdir()
        prepare(out)
        before = names(out)
        with pytest.raises(OutputError, match=words):
            publish(drive("a", b"1"), out)
        assert names(out) == before
        assert names(tmp_path) == ["out"]

    def test_the_current_folder_and_home_are_kept(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(OutputError, match=r"it is the folder you are in; give a folder of its own"):
            check_export_folder(Path())
        monkeypatch.setenv("HOME", str(tmp_path / "home"))
        (tmp_path / "home").mkdir()
        with pytest.raises(OutputError, match="it is your home folder"):
            check_export_folder(tmp_path / "home")

    def test_a_disk_and_a_loop_of_links_are_told(self, tmp_path: Path) -> None:
        with pytest.raises(OutputError, match="it is the root of a disk"):
            check_export_folder(Path("/"))
        (tmp_path / "loop").symlink_to(tmp_path / "loop")
        with pytest.raises(OutputError, match=r"cannot write .*loop: "):
            check_export_folder(tmp_path / "loop")

    def test_a_link_to_a_folder_stays_one(self, tmp_path: Path) -> None:
        (tmp_path / "true").mkdir()
        (tmp_path / "link").symlink_to(tmp_path / "true")
        publish(drive("a", b"1"), tmp_path / "link")
        assert (tmp_path / "link").is_symlink()
        assert held(tmp_path / "true") == drive("a", b"1")

    def test_the_rights_of_the_folder_stay(self, tmp_path: Path) -> None:
        publish(drive("a", b"1"), tmp_path / "out")
        (tmp_path / "out").chmod(0o2750)
        publish(drive("b", b"1"), tmp_path / "out")
        assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o2750

    def test_a_stage_that_is_a_link_is_not_followed(self, tmp_path: Path) -> None:
        (tmp_path / "precious" / "new").mkdir(parents=True)
        (tmp_path / ".out.thermicon-part").symlink_to(tmp_path / "precious")
        with pytest.raises(OutputError, match="is in the way and not yours"):
            publish(drive("a", b"1"), tmp_path / "out")
        assert (tmp_path / "precious" / "new").is_dir()


class TestFiles:
    """Which files are replaced, which stay, which go."""

    def test_files_of_others_stay_and_are_the_same_files(self, tmp_path: Path) -> None:
        publish(drive("a", b"1"), tmp_path)
        before = (tmp_path / "a.csv").stat()
        publish(drive("b", b"2"), tmp_path)
        after = (tmp_path / "a.csv").stat()
        assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
        assert held(tmp_path) == {**drive("a", b"1"), **drive("b", b"2")}

    def test_a_drive_is_kept_unless_forced(self, tmp_path: Path) -> None:
        publish(drive("a", b"1"), tmp_path)
        with pytest.raises(OutputError, match=r"a\.json and 1 more already exist and were kept; --force replaces"):
            publish(drive("a", b"2"), tmp_path)
        assert held(tmp_path) == drive("a", b"1")
        publish(drive("a", b"2"), tmp_path, replace=True)
        assert held(tmp_path) == drive("a", b"2")

    @pytest.mark.parametrize("name", ["a.csv", "a.json"])
    def test_what_no_export_wrote_is_never_replaced(self, tmp_path: Path, name: str) -> None:
        (tmp_path / name).write_text("{}")
        with pytest.raises(OutputError, match=rf"{name} was not written by an export, .*move it away, or"):
            publish(drive("a", b"1"), tmp_path, replace=True)
        assert held(tmp_path) == {name: b"{}"}

    def test_an_older_drive_goes_when_its_sidecar_describes_another(self, tmp_path: Path) -> None:
        publish({**drive("a", b"1"), **drive("b", b"1")}, tmp_path)
        assert publish(drive("a", b"2", ".tdms"), tmp_path, replace=True) == ("a.csv",)
        assert held(tmp_path) == {**drive("a", b"2", ".tdms"), **drive("b", b"1")}

    def test_an_older_drive_that_was_edited_does_not_go(self, tmp_path: Path) -> None:
        publish(drive("a", b"1"), tmp_path)
        (tmp_path / "a.csv").write_bytes(b"edited")
        with pytest.raises(OutputError, match=r"a\.csv no longer matches its sidecar a\.json"):
            publish(drive("a", b"2", ".tdms"), tmp_path, replace=True)
        assert (tmp_path / "a.csv").read_bytes() == b"edited"

    def test_a_set_file_of_drives_that_stay_is_kept(self, tmp_path: Path) -> None:
        rows = {"conditions.csv": b"a,b"}
        publish({**drive("a", b"1", **rows), **drive("b", b"1", **rows)}, tmp_path)
        with pytest.raises(OutputError, match=r"conditions\.csv belongs to b\.json too.*export all icons of the set"):
            publish(drive("a", b"1", **{"conditions.csv": b"a"}), tmp_path, replace=True)
        whole = {"conditions.csv": b"b,a"}
        publish({**drive("a", b"2", **whole), **drive("b", b"2", **whole)}, tmp_path, replace=True)
        assert (tmp_path / "conditions.csv").read_bytes() == b"b,a"

    def test_what_somebody_saves_meanwhile_is_not_lost(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        publish(drive("a", b"1"), tmp_path)
        (tmp_path / "notes.txt").write_text("old")
        real = exportfolder.exchange

        def saved_before(new: Path, goal: Path, aside: Path) -> None:
            (goal / "late.txt").write_text("late")
            (goal / "draft").write_text("new notes")
            (goal / "draft").replace(goal / "notes.txt")  # as editors save
            real(new, goal, aside)

        monkeypatch.setattr(exportfolder, "exchange", saved_before)
        publish(drive("b", b"1"), tmp_path)
        assert held(tmp_path) == {
            **drive("a", b"1"), **drive("b", b"1"), "late.txt": b"late", "notes.txt": b"new notes"
        }  # fmt: skip

    def test_a_disk_without_hard_links_gets_copies(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        publish(drive("a", b"1"), tmp_path)

        def no_links(*arguments: Any, **extra: Any) -> None:
            raise PermissionError(1, "Operation not permitted")

        monkeypatch.setattr(os, "link", no_links)
        publish(drive("b", b"2"), tmp_path)
        assert held(tmp_path) == {**drive("a", b"1"), **drive("b", b"2")}

    def test_a_file_that_vanishes_meanwhile_is_one_clear_error(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        out = tmp_path / "out"
        publish(drive("a", b"1"), out)
        real = os.link

        def gone(source: Path, target: Path, **extra: Any) -> None:
            source.unlink(missing_ok=True)
            real(source, target, **extra)

        monkeypatch.setattr(os, "link", gone)
        with pytest.raises(OutputError, match=r"cannot write into .*out: No such file or directory"):
            publish(drive("b", b"2"), out)
        assert names(tmp_path) == ["out"]
        assert not (out / "b.csv").exists()

    @posix
    @pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
    def test_a_request_to_end_leaves_nothing(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
    ) -> None:
        real = os.fsync
        monkeypatch.setattr(os, "fsync", lambda file: (os.kill(os.getpid(), number), real(file)))
        before = signal.getsignal(number)
        with pytest.raises(KeyboardInterrupt):
            publish(drive("a", b"1"), tmp_path / "out")
        assert names(tmp_path) == []
        assert signal.getsignal(number) is before

    def test_two_renames_where_folders_cannot_be_exchanged(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(swapping, "swap", lambda one, other: False)
        out = tmp_path / "out"
        publish(drive("a", b"1"), out)
        publish(drive("a", b"2"), out, replace=True)
        assert held(out) == drive("a", b"2")
        assert names(tmp_path) == ["out"]


RACE = """
import json, os, sys, time
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from dying import drive
from thermicon.circuit.packing.claims import claims_of
from thermicon.notebooks.files.export_folder import publish
from thermicon.notebooks.files.outputs import OutputError
folder, mine, rounds, same = Path(sys.argv[2]), sys.argv[3], int(sys.argv[4]), sys.argv[5] == "same"
for turn in range(rounds):
    print("ready", flush=True)
    sys.stdin.readline()
    try:
        publish(drive("a" if same else mine, mine.encode()), folder / f"out{turn}")
        said = "done"
    except OutputError as error:
        said = str(error)
    print(said, flush=True)
"""


def race(folder: Path, rounds: int, what: str) -> list[tuple[str, str]]:
    """Two processes export into the same folders at the same moments; what each said in each round."""
    command = [sys.executable, "-c", RACE, str(DYING.parent), str(folder)]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    told = []
    with (
        subprocess.Popen([*command, "x", str(rounds), what], **pipes) as first,
        subprocess.Popen([*command, "y", str(rounds), what], **pipes) as second,
    ):
        for _ in range(rounds):
            for each in (first, second):
                assert each.stdout.readline() == "ready\n"  # type: ignore[union-attr]
            for each in (first, second):
                each.stdin.write("\n")  # type: ignore[union-attr]
                each.stdin.flush()  # type: ignore[union-attr]
            one, other = (each.stdout.readline().strip() for each in (first, second))  # type: ignore[union-attr]
            told.append((one, other))
    return told


class TestTwoAtOnce:
    """Two processes that export into one folder."""

    @posix
    def test_one_wins_and_the_other_is_told(self, tmp_path: Path) -> None:
        for turn, said in enumerate(race(tmp_path, 30, "same")):
            assert sorted(word == "done" for word in said) == [False, True], said
            loser = next(word for word in said if word != "done")
            assert "already exist and were kept" in loser or "another export is writing into" in loser
            winner = "xy"[said.index("done")]
            assert (tmp_path / f"out{turn}" / "a.csv").read_text() == winner
            assert json.loads((tmp_path / f"out{turn}" / "a.json").read_text())["drive_sha256"] == digest(
                winner.encode()
            )

    @posix
    def test_different_drives_are_all_there_or_told(self, tmp_path: Path) -> None:
        for turn, said in enumerate(race(tmp_path, 30, "different")):
            done = [name for name, word in zip("xy", said, strict=True) if word == "done"]
            assert done, said
            assert all("another export is writing into" in word for word in said if word != "done")
            assert {f"{name}.csv" for name in done} == {path.name for path in (tmp_path / f"out{turn}").glob("*.csv")}

    def test_a_living_owner_is_named(self, tmp_path: Path) -> None:
        (tmp_path / ".out.thermicon-part").mkdir()
        with lock(tmp_path / ".out.thermicon-part" / "owner") as owner:
            assert owner.mine
            with pytest.raises(OutputError, match=rf"another export is writing into .*out \(process {os.getpid()}\)"):
                publish(drive("a", b"1"), tmp_path / "out")
        publish(drive("a", b"1"), tmp_path / "out")
        assert names(tmp_path) == ["out"]

    @posix
    def test_what_a_dead_owner_left_is_swept_though_its_number_runs_again(self, tmp_path: Path) -> None:
        stage = tmp_path / ".out.thermicon-part"
        (stage / "new").mkdir(parents=True)
        (stage / "new" / "a.csv").write_text("half")
        (stage / "owner").write_text(f"{os.getppid()} {os.uname().nodename}\n")
        publish(drive("a", b"1"), tmp_path / "out")
        assert held(tmp_path / "out") == drive("a", b"1")
        assert names(tmp_path) == ["out"]

    @posix
    @pytest.mark.slow
    def test_two_commands(self, tmp_path: Path) -> None:
        command = [sys.executable, "-m", "thermicon.notebooks.cli.main", "export", "six-icons", "-o", "out"]
        command += ["--icon", "warming-step", *SURE]
        runs = [
            subprocess.Popen([*command, "--to", name], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
            for name in ("csv", "tdms")
        ]
        said = [run.communicate()[1] for run in runs]
        assert sorted(run.returncode for run in runs) == [0, 1]
        loser = next(text for run, text in zip(runs, said, strict=True) if run.returncode)
        assert "kept; --force replaces" in loser or "another export is writing into out" in loser
        assert len(names(tmp_path / "out")) == 2

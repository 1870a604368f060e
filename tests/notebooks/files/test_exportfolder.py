"""An export folder: all files of an export or none, without loss of other files."""

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
from tests.notebooks.files.dying import CASES, NEW, OLD, drive
from thermicon.base.files.atomic import OutputError
from thermicon.circuit.delivery.export_folder import check_export_folder, publish

DYING = Path(__file__).with_name("dying.py")
STAGE = ".drives.thermicon-part"
posix = pytest.mark.skipif(os.name != "posix", reason="needs fork and signals")


def held(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


class TestEnds:
    """Exports that end at any of their events."""

    def check(self, tmp_path: Path, case: str, way: str, first: int, step: int) -> None:
        command = [sys.executable, DYING, tmp_path, case, way, str(first), str(step)]
        run = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        assert run.returncode == 0, run.stderr
        events = [json.loads(line) for line in run.stdout.splitlines()]
        assert len(events) >= 15 // step
        old, new = ({name: content.decode() for name, content in files.items()} for files in (OLD, NEW))
        states = []
        for event in events:
            assert (event["code"] == -9) == (way == "kill"), event
            if case == "forced":
                # Killed between two renames: the folder is missing, and whole as the one before.
                aside = event["then"] is None and way == "kill"
                assert event["before" if aside else "then"] in ((old,) if aside else (old, new)), event
            else:
                assert event["then"] in ({} if case == "empty" else None, new), event
            assert event["left"] in ([], [STAGE] if way == "kill" else []), event
            assert set(event["after"]) == {"later.csv", "later.json"}, event
            assert set(event["at_last"]) == {"drives", "drives.before"}, event
            states.append(event["then"] == new)
        assert set(states) == {False, True}, "no event was before, or none after, the moment that counts"

    @posix
    @pytest.mark.parametrize("case", CASES)
    def test_killed_at_some_events(self, tmp_path: Path, case: str) -> None:
        self.check(tmp_path, case, "kill", 2, 3)

    @posix
    @pytest.mark.parametrize("way", ["interrupt", "full"])
    def test_interrupted_or_out_of_room_at_some_events(self, tmp_path: Path, way: str) -> None:
        self.check(tmp_path, "forced", way, 1, 2)

    @posix
    @pytest.mark.slow
    @pytest.mark.parametrize("way", ["kill", "interrupt", "full"])
    @pytest.mark.parametrize("case", CASES)
    def test_ended_at_every_event(self, tmp_path: Path, case: str, way: str) -> None:
        self.check(tmp_path, case, way, 1, 1)


class TestFolders:
    """Which folder an export may have for its own."""

    @pytest.mark.parametrize(
        ("prepare", "words"),
        [
            (lambda at: (at / "sub").mkdir(), r"it contains a folder, sub, .*give a folder of its own"),
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
            publish(drive("a", b"1"), out, replace=True)
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
        publish(drive("b", b"1"), tmp_path / "out", replace=True)
        assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o2750

    def test_a_stage_that_is_a_link_is_not_followed(self, tmp_path: Path) -> None:
        (tmp_path / "precious" / "new").mkdir(parents=True)
        (tmp_path / ".out.thermicon-part").symlink_to(tmp_path / "precious")
        with pytest.raises(OutputError, match="another export is writing into"):
            publish(drive("a", b"1"), tmp_path / "out")
        assert (tmp_path / "precious" / "new").is_dir()


class TestFiles:
    """Which folder is replaced, and where it stands then."""

    def test_a_folder_is_kept_unless_forced_and_stands_beside_the_new_one(self, tmp_path: Path) -> None:
        out = tmp_path / "out"
        assert publish(drive("a", b"1"), out) is None
        with pytest.raises(
            OutputError, match=r"a\.csv and 1 more already exist and were kept; replace=True replaces the folder"
        ):
            publish(drive("b", b"2"), out)
        assert held(out) == drive("a", b"1")
        for content, before in ((b"2", b"1"), (b"3", b"2")):
            assert publish(drive("a", content), out, replace=True) == tmp_path / "out.before"
            assert held(out) == drive("a", content)
            assert held(tmp_path / "out.before") == drive("a", before)
        assert names(tmp_path) == ["out", "out.before"]

    @pytest.mark.parametrize("folder", ["out", "out.before"])
    @pytest.mark.parametrize("name", ["notes.txt", "b.json"])
    def test_what_no_export_wrote_is_never_replaced(self, tmp_path: Path, folder: str, name: str) -> None:
        for each in ("out", "out.before"):
            publish(drive("a", b"1"), tmp_path / each)
        (tmp_path / folder / name).write_text("{}")
        with pytest.raises(OutputError, match=rf"{folder}/{name} was not written by thermicon, .*move it away, or"):
            publish(drive("a", b"2"), tmp_path / "out", replace=True)
        assert held(tmp_path / "out")["a.csv"] == b"1"
        assert (tmp_path / folder / name).exists()

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


class TestTwoAtOnce:
    """Two processes that export into one folder."""

    def test_a_folder_that_another_export_prepares_is_refused_with_its_place(self, tmp_path: Path) -> None:
        (tmp_path / ".out.thermicon-part").mkdir()
        with pytest.raises(OutputError, match=r"another export is writing into .*, or delete .*\.out\.thermicon-part"):
            publish(drive("a", b"1"), tmp_path / "out")
        assert names(tmp_path) == [".out.thermicon-part"]


@posix
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder where nobody may write")
def test_a_folder_that_takes_no_files_is_one_clear_error(process: Callable[..., Any]) -> None:
    said = process("export", "six-icons", "--icon", "double-dip", "--to", "csv", "-o", "/proc/self", *SURE)
    assert said.exit_code == 1
    assert said.stderr.splitlines()[-1].startswith("cannot write ")
    assert "Traceback" not in said.stderr

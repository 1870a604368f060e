"""The exported player and its serial line, compiled, behind a pseudo-terminal: a board as thermicon plays on it."""

from __future__ import annotations

import binascii
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.formats.board import CFLAGS
from tests.circuit.delivery.independent import worlds_of
from tests.circuit.live.conftest import README as README_CUE
from tests.circuit.live.conftest import made
from thermicon.circuit import Device, Export, Rig, fit
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.fitting.log import read_log
from thermicon.circuit.live.play_live import LiveResult, play_export
from thermicon.circuit.live.ready import CONTROLLER, judged
from thermicon.circuit.play.board import sealed, unsealed
from thermicon.circuit.play.watch import Refused
from thermicon.icons import parse

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
STATED = ["loop: gains of the header, 0.1 s of lag, the tests"]
CONTACT = "contact.resistance_m2K_per_W"
README = ["arrived", "turn", "low-battery"]


@dataclass
class Bench:
    """A board in a process of its own, whose time goes `speed` times as fast, at a port."""

    port: str
    process: subprocess.Popen[str]
    speed: float
    told: Path
    end: int

    def unplug(self) -> None:
        self.process.kill()
        self.process.wait(10)
        os.close(self.end)

    def clock(self) -> float:
        return self.speed * time.monotonic()

    def sleep(self, seconds: float) -> None:
        time.sleep(seconds / self.speed)

    def play(self, found: Export, *order: str, **how: object) -> LiveResult:
        timer = self.clock, self.sleep
        return play_export(found, order, stated=STATED, port=self.port, timer=timer, **how)  # type: ignore[arg-type]

    def turns(self) -> np.ndarray:
        """True time in s, °C of the display and A of each twentieth of a second."""
        rows = [line.split() for line in self.told.read_text().splitlines()]
        return np.array([row for row in rows if len(row) == 3], dtype=float)


@contextmanager
def board(
    found: Export, folder: Path, compiler: str, speed: float, wrong_of: int = 0, plate: Rig | None = None
) -> Iterator[Bench]:
    """Compile an export with its serial line, and run it on its rig, or on another, without power at first."""
    files = replace(found, form=load_format("c-array"), felt=()).files
    for name, content in files.items():
        (folder / name).write_bytes(content)
    source = Path(__file__).with_name("serial_main.c")
    flags = [*CFLAGS, "-D_POSIX_C_SOURCE=200809L", "-I."]
    subprocess.run([compiler, *flags, str(source), "-o", "board", "-lm"], cwd=folder, check=True)
    document = json.loads((plate or found.rig).document)
    follower = Follower(document, np.random.default_rng(0), worlds=[worlds_of(document)[0]])
    circuit = follower.circuit
    at_rest = follower._steady(np.zeros(1))[0]
    head = [float(circuit.alpha[0]), float(circuit.ohm[0]), float(circuit.gain[0])]
    beside = np.diagonal(circuit.matrix[0], 1)
    numbers = [*head, *circuit.capacity[0], *np.diagonal(circuit.matrix[0]), *beside, *circuit.heat[0], *at_rest]
    (folder / "plate.txt").write_text(f"{len(at_rest)} " + " ".join(map(repr, map(float, numbers))))
    with FileLock(Path(tempfile.gettempdir()) / "thermicon-board.lock"), before_others():  # no board beside another
        own, other = os.openpty()
        tty.setraw(other)
        with (folder / "told.txt").open("w") as told:
            words = ["./board", str(own), "plate.txt", str(speed), str(wrong_of)]
            process = subprocess.Popen(words, cwd=folder, pass_fds=[own], stdout=told, text=True)
        try:
            yield Bench(os.ttyname(other), process, speed, folder / "told.txt", own)
        finally:
            process.kill()
            process.wait(10)
            with suppress(OSError):  # it was unplugged
                os.close(own)
            os.close(other)


@contextmanager
def before_others() -> Iterator[None]:
    """Run this process, and what it starts, before all others where the system allows that: what plays is not late."""
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    try:
        yield
    finally:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@pytest.fixture
def compiler(tool: Callable[[str], str]) -> str:
    return tool("cc")


def test_lines_are_sealed_as_xmodem_does() -> None:
    assert binascii.crc_hqx(b"123456789", 0) == 0x31C3
    assert unsealed(sealed("P 3")) == ["P", "3"]
    assert unsealed(sealed("P 3").replace(b"3*", b"4*")) is None
    assert unsealed(b"\xff*0000\n") is None


def test_a_board_is_known_proven_and_off_again(tmp_path: Path, compiler: str) -> None:
    found = made("readme", 10.0)
    with board(found, tmp_path, compiler, 2.0) as bench:
        result = bench.play(found, checks_only=True)
        assert not result.stopped
        assert {row.label: row.how for row in result.demands}["watchdog"] == "proven"
        assert result.proofs["fell_K"] > 1.5
        other = made("six-icons", 10.0)
        with pytest.raises(Refused, match=r"compiled from another export .* compile and upload it again"):
            bench.play(other, checks_only=True)
    amperes = bench.turns()[:, 2]
    assert 0.2 < amperes.max() < 1.2
    assert amperes[-1] == 0.0


def test_no_port_and_a_port_in_use_are_told(tmp_path: Path, compiler: str) -> None:
    found = made("readme", 10.0)
    with pytest.raises(Refused, match="/dev/nowhere cannot be opened"):
        play_export(found, stated=STATED, port="/dev/nowhere")
    with board(found, tmp_path, compiler, 2.0) as bench:
        import serial

        holder = serial.Serial(bench.port, exclusive=True)
        with pytest.raises(Refused, match="another program has it"):
            bench.play(found, checks_only=True)
        holder.close()
        time.sleep(0.2)
    assert not bench.turns()[:, 2].any(), "who is refused puts nothing out"


HOST = """
import sys, time
from pathlib import Path
from tests.circuit.live.conftest import README as README_CUE
from tests.circuit.live.conftest import made
from thermicon.circuit.live.ready import CONTROLLER, judged
from thermicon.circuit.live.play_live import play_export
speed = float(sys.argv[3])
timer = lambda: speed * time.monotonic(), lambda seconds: time.sleep(seconds / speed)
told = lambda text: print(text, flush=True)
result = play_export(
    made("readme", 10.0), ["arrived"], stated=["loop: gains, the tests"], port=sys.argv[1], timer=timer,
    folder=Path(sys.argv[2]), tell=told,
)
print("stopped:", result.stopped, flush=True)
"""
QUICK = 3.0
OFF_WITHIN_S = 1.5
TRIES = 3
NOT_TRIED = "this computer was late", "a look may take", "silent"
"""On a computer that many tests share, and where a wrong byte hits the only answer to *begin*: one begins again."""


def playing(bench: Bench, folder: Path) -> tuple[subprocess.Popen[str], Path]:
    """A host of its own that has played for two seconds, and its folder; begun again where the computer was late."""
    for attempt in range(TRIES):
        words = [sys.executable, "-c", HOST, bench.port, str(folder / f"monday{attempt}"), str(QUICK)]
        host = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        assert host.stdout is not None
        heard = next((line for line in host.stdout if line.startswith(("plays", "stopped"))), "nothing")
        if heard.startswith("plays"):
            time.sleep(2.0 / QUICK)
            return host, folder / f"monday{attempt}"
        host.wait(10)
        assert any(cause in heard for cause in NOT_TRIED), heard
    raise AssertionError(f"{TRIES} times: {heard}")


@pytest.mark.slow
def test_icons_are_played_from_rest_and_their_logs_tell_the_contact(tmp_path: Path, compiler: str) -> None:
    found = made("readme", 100.0)
    truth = 0.8 * found.rig.contact.resistance_m2K_per_W
    with board(found, tmp_path, compiler, QUICK, plate=found.rig.with_(**{CONTACT: truth})) as bench:
        for attempt in range(TRIES):
            folder = tmp_path / f"monday{attempt}"
            result = bench.play(found, *README, folder=folder)
            if not any(cause in result.stopped for cause in NOT_TRIED):
                break
    assert not result.stopped, result.stopped
    assert [(play.name, play.ended) for play in result.plays] == [(name, True) for name in README]
    for play in result.plays:
        print(f"{play.name}: display {1e3 * play.rms_K:.0f} mK rms from the prediction")
        assert play.rms_K < 0.06
        gaps_s = np.diff(play.columns["time_s"])
        assert gaps_s.max() < 0.1 * QUICK
        assert play.columns["time_s"][0] < 0.0
    logs = [read_log(folder / play.files[0]) for play in result.plays]
    (contact,) = [key for key in fit(logs[:1], folder / "rig.toml").parameters if key.key == CONTACT]
    assert contact.identified
    assert contact.low < truth < contact.high
    assert contact.value == pytest.approx(truth, rel=0.2)


def killed(host: subprocess.Popen[str], bench: Bench) -> None:
    host.kill()


def halted(host: subprocess.Popen[str], bench: Bench) -> None:
    host.send_signal(signal.SIGSTOP)


def interrupted(host: subprocess.Popen[str], bench: Bench) -> None:
    host.send_signal(signal.SIGINT)


def only_asked(host: subprocess.Popen[str], bench: Bench) -> None:
    """The host hangs, and a privileged program that does not know of locks asks all the while."""
    host.send_signal(signal.SIGSTOP)
    with Path(bench.port).open("wb", buffering=0) as port:
        for _ in range(40):
            port.write(sealed("?"))
            time.sleep(0.02)


@pytest.mark.slow
@pytest.mark.parametrize("ends", [killed, halted, interrupted, only_asked])
def test_the_output_is_off_a_second_after_whatever_ends_the_host(
    ends: Callable[[subprocess.Popen[str], Bench], None], tmp_path: Path, compiler: str
) -> None:
    with board(made("readme", 10.0), tmp_path, compiler, QUICK) as bench:
        host, folder = playing(bench, tmp_path)
        try:
            ended_s = bench.clock()
            ends(host, bench)
            time.sleep(6.0 / QUICK)
        finally:
            host.kill()
            host.wait(10)
    turns = bench.turns()
    on_s = turns[np.abs(turns[:, 2]) > 0.0, 0]
    assert on_s.max() > ended_s - 0.5, "it was on when it happened"
    assert turns[-1, 0] > ended_s + 3.0
    assert on_s.max() < ended_s + OFF_WITHIN_S
    log = np.genfromtxt(folder / "arrived.log.csv", delimiter=",", skip_header=1, usecols=0)
    assert len(log) > 100, "the log is complete to its last second"


@pytest.mark.slow
@pytest.mark.parametrize("source", ["file", "folder"])
def test_one_icon_of_the_set_that_a_board_was_compiled_from_is_asked_for(
    source: str, tmp_path: Path, compiler: str
) -> None:
    file, drives = tmp_path / "alerts.cue", tmp_path / "drives"
    file.write_text(README_CUE, encoding="utf-8")
    if source == "folder":
        export = ["export", str(file), "--to", "c-array", "--device", CONTROLLER, "-o", str(drives)]
        subprocess.run([sys.executable, "-m", "thermicon", *export], check=True, capture_output=True)
    played = str(drives if source == "folder" else file)
    words = ["play", played, "--icon", "turn", "--device", "board", "--check"]
    whole = judged(tuple(parse(README_CUE)), Rig.load("thenar"), Device.load(CONTROLLER), None)
    with board(whole, tmp_path, compiler, 1.0) as bench:
        command = [sys.executable, "-m", "thermicon", *words, "--port", bench.port, "--stated", STATED[0]]
        said = subprocess.run(command, capture_output=True, text=True, check=False)
    assert said.returncode == 0, said.stderr
    assert "stated" in said.stdout


@pytest.mark.slow
@pytest.mark.parametrize("wrong_of", [1000, 100, 20])
def test_wrong_bytes_lose_rows_and_never_keep_the_output_on(wrong_of: int, tmp_path: Path, compiler: str) -> None:
    found = made("readme", 10.0)
    with board(found, tmp_path, compiler, QUICK, wrong_of) as bench:
        for _ in range(TRIES):
            try:
                result = bench.play(found, "arrived")
                why, plays = result.stopped, result.plays
            except Refused as problem:
                why, plays = str(problem), ()
            print(f"1 of {wrong_of} bytes wrong: {why or 'played'}")
            time.sleep(3.0 / QUICK)
            if wrong_of < 1000 or not any(cause in why for cause in NOT_TRIED):
                break
    assert bench.turns()[-1, 2] == 0.0
    assert why or plays[0].rms_K < 0.06
    assert not why or wrong_of < 1000


@pytest.mark.slow
def test_a_port_that_is_pulled_out_is_told(tmp_path: Path, compiler: str) -> None:
    found = made("readme", 10.0)
    with board(found, tmp_path, compiler, QUICK) as bench:
        host, _ = playing(bench, tmp_path)
        with host:
            assert host.stdout is not None
            bench.unplug()
            said = host.stdout.read()
    assert "output off\nstopped: " in said
    assert f"the port {bench.port} is lost (" in said, "whoever met it first, a reading or what feeds"

"""``thermicon play`` at the command line."""

import os
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli, posix
from thermicon.notebooks.cli import play, stop_key


def test_a_play_can_be_compared_as_it_says(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "monday"
    said = cli.good("play", two, "--icon", "warm-step", "-o", out)
    assert "take the hand off" in said.stderr
    (following,) = [line for line in said.stdout.splitlines() if line.startswith("Next: thermicon ")]
    compared = cli.good(*following.split()[2:])
    assert "probe loop" in compared.stdout
    assert cli("play", two, "-o", out).exit_code == 1
    drives = tmp_path / "drives"
    cli.good("export", two, "--device", "closed-loop-controller", "--to", "setpoint-csv", "-o", drives)
    order = tmp_path / "order.txt"
    order.write_text("warm-step\nwarm-step\n")
    again = cli.good("play", drives, "--order", order, "--pause", 5, "-o", tmp_path / "tuesday")
    assert "warm-step.2.log.csv" in again.stdout


def test_a_check_says_how_each_demand_is_met(cli: Cli, two: Path) -> None:
    lines = [line.split() for line in cli.good("play", two, "--check").stdout.splitlines()]
    for label, how in (("watchdog", "proven"), ("polarity", "proven"), ("loop", "held"), ("rest", "held")):
        assert any(line[:1] == [label] and how in line for line in lines), label


def test_a_key_stops_with_exit_code_4(cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keys = iter(["", "", "x", " "])
    monkeypatch.setattr(play, "stop_key", lambda: nullcontext(lambda: stop_key.meant(next(keys, ""))))
    answer = cli("play", two, "-o", tmp_path / "out")
    assert answer.exit_code == 4
    assert "stopped: Space was pressed; the output is off" in answer.stderr
    assert (tmp_path / "out" / "cool-step.log.json").exists()


def test_a_changed_drive_is_not_played(cli: Cli, two: Path, tmp_path: Path) -> None:
    cli.good("export", two, "--device", "closed-loop-controller", "--to", "setpoint-csv", "-o", tmp_path / "drives")
    drive = next((tmp_path / "drives").glob("*-step.csv"))
    drive.write_text(drive.read_text().replace("32.", "33.", 1))
    answer = cli("play", tmp_path / "drives", "-o", tmp_path / "out")
    assert answer.exit_code == 1
    assert "digest differs" in answer.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--icon", "warmstep", "-o", "out"], 1, "did you mean warm-step"),
        (["--rig", "tcs2", "-o", "out"], 1, "thermode"),
        (["--stated", "fuse", "-o", "out"], 1, "DEMAND: WHAT, WHO"),
        ([], 2, "'-o' / '--output'"),
        (["--check", "-o", "out"], 2, "plays nothing"),
        (["--icon", "warm-step", "--order", "order.txt", "-o", "out"], 2, "leave out --icon"),
        (["--set", "driver.current_limit_A=0.1", "-o", "out"], 3, "NOT reached"),
        (["--set", "safety.display_lowest_C=31", "--set", "safety.reason=test", "-o", "out"], 3, "refused"),
    ],
)
def test_what_is_not_played(
    words: list[str], code: int, said: str, cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answer = cli("play", two, *words)
    assert answer.exit_code == code, answer.stderr
    assert said in answer.stderr
    assert "--force" not in answer.stderr, "which this command has not"
    assert not (tmp_path / "out").exists()


@posix
@pytest.mark.slow
@pytest.mark.parametrize("key", [b" ", b"\x1b", b"\x03"])
def test_a_person_at_a_terminal_stops_in_real_time(key: bytes, two: Path, tmp_path: Path) -> None:
    """By a key of a real terminal, which is as before afterwards."""
    import pty
    import termios

    mine, theirs = pty.openpty()
    before = termios.tcgetattr(theirs)
    words = [sys.executable, "-m", "thermicon", "play", str(two), "--icon", "warm-step", "-o", str(tmp_path / "out")]
    run = subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True)
    said, until_s = "", time.monotonic() + 90.0
    while "silence" not in said and time.monotonic() < until_s:
        said += os.read(mine, 1000).decode(errors="replace")
    pressed_s = time.monotonic()
    if key == b"\x03":
        os.kill(run.pid, 2)
    else:
        os.write(mine, key)
    assert run.wait(30.0) == 4
    assert time.monotonic() - pressed_s < 3.0
    assert termios.tcgetattr(theirs) == before
    rows = (tmp_path / "out" / "warm-step.log.csv").read_text().splitlines()
    assert len(rows) > 450
    assert float(rows[-1].split(",")[7]) == 0.0
    os.close(mine)
    os.close(theirs)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of POSIX")
@pytest.mark.parametrize(("number", "said"), [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "the program was ended")])
def test_what_ends_the_program_switches_off_first_and_a_second_time_interrupts_nothing(
    number: signal.Signals, said: str
) -> None:
    before = signal.getsignal(number)
    with stop_key.stop_key() as stopped:
        assert not stopped()
        for _ in range(2):
            os.kill(os.getpid(), number)
        assert stopped() == said
    assert signal.getsignal(number) is before

"""The lines of a player on hardware that fails."""

import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.daq import Daq, DaqError, Task
from tests.circuit.play.bench import Clock
from tests.circuit.serial_line import Ports, Serial
from thermicon.circuit.play.guard import Guard
from thermicon.circuit.play.ni import NiLine
from thermicon.circuit.play.tcs2 import Tcs2Line
from thermicon.circuit.play.watch import Numbers, Stopped

NUMBERS = Numbers(20.0, 40.0, react_s=0.1, look_every_s=0.05, late_s=0.1, rest_s=3.0, pause_s=2.0)
VOLTS = [0.5, 1.0, 0.5]
BLOCK = [(0.0, (VOLTS, 1.0)), (3.0, None)]
COMMANDS = ["N320", "Om360", "Uw11111002100340100320", "Ue11111"]


class Card:
    """A guard on a channel of an NI card."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock, self.monkeypatch = Clock(), monkeypatch
        self.daq = Daq(self.clock.monotonic)
        monkeypatch.setitem(sys.modules, "nidaqmx", self.daq)
        monkeypatch.setitem(sys.modules, "nidaqmx.constants", self.daq)
        self.line = NiLine("Dev1/ao0", 0.25, 10.0)
        self.guard = Guard(lambda: NUMBERS, self.clock.monotonic, self.clock.sleep)

    def play(self, rows: Any = BLOCK) -> None:
        self.guard.play(self.line, rows, VOLTS[0])


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> Card:
    return Card(monkeypatch)


class TestNi:
    """What is put out by a task that is closed when it is done."""

    def test_plays_follow_each_other(self, card: Card) -> None:
        for _ in range(3):
            card.play()
            assert card.daq.open_tasks == 0
            card.clock.passes(2.0)
        assert card.daq.out == [VOLTS[0], VOLTS, VOLTS, VOLTS]

    def test_an_abort_in_mid_play_closes_and_a_reset_plays_again(self, card: Card) -> None:
        card.clock.at(104.0, card.guard.abort)
        with pytest.raises(Stopped):
            card.play()
        assert (card.daq.open_tasks, card.daq.out[-1], card.daq.stopped) == (0, 0.25, 1)
        card.guard.reset()
        card.play()
        card.line.off()
        assert (card.daq.open_tasks, card.daq.out[-1]) == (0, 0.25)

    @pytest.mark.parametrize("close_s", [0.05, 0.4])  # within the time that an abort waits for it, and longer
    def test_an_abort_while_a_block_is_closed_at_its_end_leaves_it_off(self, card: Card, close_s: float) -> None:
        """Closing takes a while in a driver, and the channel is reserved until then."""
        close, problems = Task.close, list[BaseException]()

        def abort() -> None:
            try:
                card.guard.abort()
            except DaqError as problem:
                problems.append(problem)

        thread = threading.Thread(target=abort)

        def slow(task: Task) -> None:
            if card.daq.out[-1] == VOLTS and thread.ident is None:
                thread.start()
                time.sleep(close_s)
            close(task)

        card.monkeypatch.setattr(Task, "close", slow)
        with pytest.raises(Stopped, match=r"abort\(\) was called"):
            card.play()
        thread.join(2.0)
        assert (card.daq.open_tasks, card.daq.out[-1]) == (0, 0.25)
        assert len(problems) == (close_s > 0.2)

    @pytest.mark.parametrize("rows", [[(0.0, ([0.5, 10.1], 1.0)), (2.0, None)], [(0.0, -10.1), (2.0, None)]])
    def test_a_voltage_that_the_driver_refuses_ends_off_and_closed(self, card: Card, rows: Any) -> None:
        with pytest.raises(DaqError, match="-200077"):
            card.play(rows)
        assert (card.daq.open_tasks, card.daq.out) == (0, [VOLTS[0], 0.25])

    def test_a_task_that_somebody_else_holds_is_an_error_and_nothing_plays(self, card: Card) -> None:
        other = NiLine("Dev1/ao0")
        other.open()
        other.send((VOLTS, 1.0))
        with pytest.raises(DaqError, match="-50103"):
            card.play()
        assert len(card.daq.out) == 1
        other.off()
        card.guard.reset()
        card.play()
        assert card.daq.open_tasks == 0

    def test_a_test_current_is_a_voltage_where_the_line_knows_it(self, card: Card) -> None:
        card.line.open()
        assert card.line.test(0.3)
        assert card.daq.out == [pytest.approx(3.0)]
        assert not NiLine("Dev1/ao0").test(0.3)


class TestTcs2:
    """A thermode takes what follows a command that was begun for its digits."""

    def test_an_abort_while_a_command_is_half_out_is_understood(self) -> None:
        for place in (1, 4, 9, 15, 21):  # within Uw: zones, count, segments
            port = Serial()
            line, clock = Tcs2Line(port), time.monotonic
            guard = Guard(lambda: NUMBERS, clock, time.sleep)
            guard.prepare(line, COMMANDS)
            port.hang_after = place
            problems: list[BaseException] = []

            def prepare(guard: Guard = guard, line: Tcs2Line = line, problems: Any = problems) -> None:
                try:
                    guard.prepare(line, COMMANDS[2:])
                except BaseException as problem:
                    problems.append(problem)

            port.device.is_playing = True  # another profile, which must end
            thread = threading.Thread(target=prepare)
            thread.start()
            assert port.hangs.wait(2.0)
            guard.abort()
            assert port.commands[4:6] == [COMMANDS[2].encode(), b"A"]
            assert (port.device.is_playing, port.device.garbled) == (False, [])
            thread.join(2.0)
            assert isinstance(problems[0], Stopped)
            # The play that ends says off too; nothing else may follow.
            assert set(port.commands[6:]) <= {b"A"}

    def test_a_write_that_takes_a_part_is_gone_on_with(self) -> None:
        port = Serial()
        whole = port.write
        port.write = lambda data: whole(data[:3])  # type: ignore[method-assign]
        line = Tcs2Line(port)
        for command in COMMANDS:
            line.send(command)
        assert port.commands == [command.encode() for command in COMMANDS]

    def test_a_thermode_has_no_test_current(self) -> None:
        port = Serial()
        assert not Tcs2Line(port).test(0.3)
        assert not port.commands


SCRIPT = """
import sys, time
sys.path.insert(0, {here!r})
from tests.circuit.daq import Daq
daq = sys.modules["nidaqmx"] = sys.modules["nidaqmx.constants"] = Daq(time.monotonic)
from thermicon.circuit.play.ni import NiLine
import atexit
atexit.register(lambda: print("open:", daq.open_tasks, "last:", daq.out[-1]))
import threading
script = {{"__name__": "play_icons"}}
exec(open({script!r}).read(), script)
script.update(REST_S=0.0, PAUSE_S=0.0, POLARITY_SEEN="A. Name, today")
threading.Thread(target=script["play"], args=({drive!r},), daemon=True).start()
while not any(isinstance(volts, list) for volts in daq.out):
    time.sleep(0.01)
"""


def test_an_interpreter_that_ends_in_mid_play_leaves_the_output_off_and_the_channel_free(tmp_path: Path) -> None:
    from tests.circuit.delivery.formats.world import exported

    files, drive, _ = exported("ni-analogue-output")
    for name in (drive, "play_icons.py"):
        (tmp_path / name).write_bytes(files[name])
    code = SCRIPT.format(
        here=str(Path(__file__).parents[3]), script=str(tmp_path / "play_icons.py"), drive=str(tmp_path / drive)
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (ran.stdout, ran.returncode) == ("open: 0 last: 0.0\n", 0), ran.stderr


def test_a_port_is_opened_for_one_program(monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.circuit.delivery.formats.world import exported

    files, _, _ = exported("qst-tcs2")
    monkeypatch.setitem(sys.modules, "serial", Ports())  # type: ignore[arg-type]
    script: dict[str, Any] = {}
    exec(compile(files["play_icons.py"], "play_icons.py", "exec"), script)
    script["connect"]()
    with pytest.raises(OSError, match="Could not exclusively lock port COM3"):
        script["connect"]()
    with pytest.raises(RuntimeError, match="nothing was prepared"):
        script["rest"](Serial())

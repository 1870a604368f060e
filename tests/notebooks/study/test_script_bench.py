"""The display of a study's script on simulated hardware."""

import importlib
import itertools
import sys
import threading
import time
import types
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.daq import Daq

from .conftest import rows_of


def bench_of(quick: Path, monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    """The module of the study's folder that plays and waits."""
    monkeypatch.syspath_prepend(str(quick))
    monkeypatch.delitem(sys.modules, "study_bench", raising=False)
    return importlib.import_module("study_bench")


@pytest.fixture
def display(quick: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    device = Daq(time.monotonic)
    monkeypatch.setitem(sys.modules, "nidaqmx", device)
    monkeypatch.setitem(sys.modules, "nidaqmx.constants", device)
    made = bench_of(quick, monkeypatch).Display("ni", channel="Dev7/ao1")
    made.player.REST_S = made.player.PAUSE_S = 0.0
    made.device = device
    yield made
    made.abort()  # else its thread would go on, on the card of the next test
    assert device.open_tasks == 0


def test_a_play_does_not_block_and_abort_switches_off(display: Any, quick: Path) -> None:
    """In real time, with threads."""
    assert display.player.CHANNEL == "Dev7/ao1"
    begun = time.monotonic()
    display.play(str(quick / "dip.csv"))
    assert time.monotonic() - begun < 0.5, "the call returned while the icon plays"
    while not any(isinstance(each, list) for each in display.device.out):
        assert time.monotonic() - begun < 2.0
        time.sleep(0.01)
    assert display.busy
    display.abort()
    assert time.monotonic() - begun < 2.0
    assert display.device.out[-1] == 0.0
    with pytest.raises(RuntimeError, match=r"abort\(\) was called"):
        _ = display.busy


def test_the_guard_stops_a_display_that_is_too_warm(display: Any, quick: Path) -> None:
    """The cut-off of the exported player acts in a study too."""
    readings = iter([32.0 + 0.001 * k for k in range(10)] + [60.0 + 0.001 * k for k in range(1000)])
    display.own = types.SimpleNamespace(measured_C=lambda: next(readings))
    display.player.TEST_POLARITY = False
    display.play(str(quick / "dip.csv"))
    begun = time.monotonic()
    with pytest.raises(RuntimeError, match=r"the display is at 60\.\d\d degrees C, outside"):
        while time.monotonic() < begun + 3.0 and display.busy:
            time.sleep(0.01)
    assert display.device.out[-1] == 0.0


def test_a_pause_that_is_too_short_is_refused_by_the_player(display: Any, quick: Path) -> None:
    display.play(str(quick / "dip.csv"))
    display._thread.join()
    display.player.PAUSE_S = 5.0
    display.play(str(quick / "dip.csv"))
    display._thread.join()
    with pytest.raises(RuntimeError, match=r"the pause of 5 s between plays is not over"):
        _ = display.busy


def test_the_rest_is_held_before_the_first_play(display: Any, quick: Path) -> None:
    first = float(rows_of(quick / "dip.csv")[0]["command_V"])
    display.player.REST_S, begun = 0.05, time.monotonic()
    display.rest(str(quick / "dip.csv"))
    display._thread.join()
    assert display.device.out == [first]
    display.play(str(quick / "dip.csv"))
    assert time.monotonic() - begun > 0.05


def test_a_sensor_that_hangs_between_plays_does_not_hold_up_the_keys(display: Any, quick: Path) -> None:
    """The loop that reads them calls keep(), which returns at once, and stops when the answer is overdue."""
    reads, hangs, answers = itertools.count(), threading.Event(), threading.Event()

    def measured_C() -> float:
        if hangs.is_set():
            answers.wait(10.0)
        return 32.0 + 0.001 * next(reads)

    display.own, display.player.TEST_POLARITY = types.SimpleNamespace(measured_C=measured_C), False
    display.rest(str(quick / "dip.csv"))
    display._thread.join()
    display.keep()
    hangs.set()
    begun = last = time.monotonic()
    with pytest.raises(RuntimeError, match="the sensor took"):
        while last < begun + 5.0:
            display.keep()
            assert time.monotonic() - last < 0.5
            last = time.monotonic()
            time.sleep(0.01)
    answers.set()
    assert display.device.out[-1] == 0.0


def test_abort_switches_off_while_a_sensor_hangs(display: Any, quick: Path) -> None:
    """The display is off at once; the thread that waits for the sensor is not waited for before."""
    reads, hangs, answers = itertools.count(), threading.Event(), threading.Event()

    def measured_C() -> float:
        if any(isinstance(row, list) for row in display.device.out):
            hangs.set()
            answers.wait(10.0)
        return 32.0 + 0.001 * next(reads)

    display.own, display.player.TEST_POLARITY = types.SimpleNamespace(measured_C=measured_C), False
    display.play(str(quick / "dip.csv"))
    assert hangs.wait(10.0), "the icon plays, and the sensor does not answer"
    escape = threading.Thread(target=display.abort)
    escape.start()
    begun = time.monotonic()
    while display.device.out[-1] != 0.0:
        assert time.monotonic() - begun < 1.0, "it waited for the thread before"
        time.sleep(0.01)
    answers.set()
    escape.join()
    with pytest.raises(RuntimeError):
        display.keep()
    assert display.device.out[-1] == 0.0


class StandInPlayer:
    """A player for a controller, as the functions of play_icons.py are; `calls` are those that were made."""

    POLARITY_SEEN = ""

    def __init__(self) -> None:
        self.calls: list[Any] = []
        self.stopped: str | None = None
        self.playing = threading.Event()

    def rest(
        self, drive_file: str, send: Any, off: Any, measured_C: Any = None, second_C: Any = None, test: Any = None,
        feed: Any = None,
    ) -> None:  # fmt: skip
        self.calls.append((drive_file, send, off, measured_C, second_C, test, feed))

    def play(self, drive_file: str, send: Any, off: Any) -> None:
        self.calls.append((drive_file, send, off))
        self.playing.wait(5.0)

    def keep(self) -> None:
        self.calls.append("keep")
        if self.stopped:
            raise RuntimeError(self.stopped)

    def abort(self) -> None:
        self.calls.append("abort")
        if self.stopped:
            raise RuntimeError(self.stopped)


@pytest.fixture
def controller(quick: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A controller with a bench that offers everything, on a stand-in for the player."""
    bench, player = bench_of(quick, monkeypatch), StandInPlayer()
    monkeypatch.setattr(bench, "load", lambda path, name: player)
    names = ("send", "measured_C", "second_C", "test", "feed")
    own = types.SimpleNamespace(
        off=lambda: player.calls.append("off"),
        polarity_seen="MK, 3 March, at -0.5 A",
        **{name: f"the bench's {name}" for name in names},
    )
    return bench.Display("send", own)


def test_the_player_gets_what_the_bench_offers_and_it_takes(controller: Any) -> None:
    player, own = controller.player, controller.own
    assert player.POLARITY_SEEN == "MK, 3 March, at -0.5 A"
    controller.rest("dip.csv")
    controller._thread.join()
    controller.play("dip.csv")
    player.playing.set()
    controller._thread.join()
    assert not controller.busy
    sensors = "the bench's measured_C", "the bench's second_C", "the bench's test", "the bench's feed"
    assert player.calls == [("dip.csv", own.send, own.off, *sensors), ("dip.csv", own.send, own.off)]
    del own.feed, own.test
    controller.rest("dip.csv")
    controller._thread.join()
    assert player.calls[-1] == ("dip.csv", own.send, own.off, *sensors[:2], None, None)


def test_between_plays_the_player_keeps_the_device_awake_and_while_one_goes_on_it_does_so_itself(
    controller: Any,
) -> None:
    player = controller.player
    controller.keep()
    assert player.calls == ["keep"]
    controller.play("dip.csv")
    controller.keep()
    assert player.calls[1:] in ([], [("dip.csv", controller.own.send, controller.own.off)])
    player.playing.set()
    controller._thread.join()
    controller.keep()
    assert player.calls[-1] == "keep"
    player.stopped = "the display is at 60 degrees C"
    with pytest.raises(RuntimeError, match="the display is at 60 degrees C"):
        controller.keep()


def test_commands_are_sent_to_a_thermode_while_the_keys_are_read(quick: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line that takes its time, or hangs, must not keep the abort key from acting."""
    bench, sends, calls = bench_of(quick, monkeypatch), threading.Event(), []

    def prepare(port: str, drive_file: str) -> None:
        sends.wait(5.0)
        calls.append(("prepare", port, drive_file))

    def rest(port: str, measured_C: object = None) -> None:
        calls.append(("rest", port, measured_C))

    player = types.SimpleNamespace(prepare=prepare, rest=rest, connect=lambda: player.PORT, keep=lambda: None)
    monkeypatch.setattr(bench, "load", lambda path, name: player)
    thermode = bench.Display("tcs2", types.SimpleNamespace(measured_C="sensor", second_C="another"), port="COM7")
    thermode.rest("dip.txt")
    assert thermode.busy and not calls
    sends.set()
    thermode._thread.join()
    sends.clear()
    thermode.prepare("glow.txt")
    assert thermode.busy
    sends.set()
    thermode._thread.join()
    assert calls == [("prepare", "COM7", "dip.txt"), ("rest", "COM7", "sensor"), ("prepare", "COM7", "glow.txt")]
    del player.keep
    with pytest.raises(SystemExit, match=r"play_icons\.py is older than this script: export the study again"):
        bench.Display("tcs2")


def test_a_trial_begins_only_after_its_commands_were_sent(
    quick: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench_of(quick, monkeypatch)
    monkeypatch.delitem(sys.modules, "study_answers", raising=False)
    monkeypatch.delitem(sys.modules, "run_study", raising=False)
    monkeypatch.delitem(sys.modules, "study_run", raising=False)
    study: Any = importlib.import_module("run_study")
    calls: list[str] = []

    class SlowLine:
        """A display whose commands take 100 ticks longer than the gap; a play ends at once."""

        left = 0

        def prepare(self, drive: str) -> None:
            self.left = 2100

        def play(self, drive: str) -> None:
            calls.append(f"play after {2100 - self.left} ticks")

        def keep(self) -> None:
            self.left -= self.left > 0

        @property
        def busy(self) -> bool:
            return self.left > 0

    class Screen:
        """Ticks of 0.01 s."""

        s = 0.0

        def now(self) -> float:
            return self.s

        def tick(self) -> list[str]:
            self.s += 0.01
            return ["1"] if self.s > 30.0 else []

        def show(self, text: str) -> None: ...
        def expect(self, presented: str, choices: dict[str, str]) -> None: ...

    files = study.StudyFiles(tmp_path, study.read_study())
    run = study.ParticipantRun(files, "A", Screen(), SlowLine(), lambda code: None, {})
    run.free_s = 20.0
    row = next(row for row in rows_of(quick / "sub-A_task-quick_conditions.csv") if row["trial"] == "1")
    assert run.trial(row) == "dip"
    assert calls == ["play after 2100 ticks"]
    assert list(run.given) == [1]


def test_abort_switches_off_although_the_player_cannot(controller: Any) -> None:
    controller.player.stopped = "the line is lost"
    with pytest.raises(RuntimeError, match="the line is lost"):
        controller.abort()
    assert controller.player.calls == ["abort", "off"]


def test_other_devices_have_their_functions(quick: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = bench_of(quick, monkeypatch)
    with pytest.raises(SystemExit, match=r"needs --bench FILE\.py with the functions send\(display_C\) and off\(\)"):
        bench.Display("send")
    done: list[object] = []
    own = types.SimpleNamespace(send=lambda _: None, off=lambda: done.append("off"))
    bench.Display("send", own).abort()
    thermode = bench.Display.__new__(bench.Display)
    line = types.SimpleNamespace(off=lambda: done.append("A"))
    thermode.player = types.SimpleNamespace(abort=lambda: done.append("abort"), _line=lambda port: line)
    thermode.plays, thermode.port, thermode._thread = "tcs2", "COM7", None
    thermode.abort()
    assert done == ["off", "abort", "A"]


def test_the_stand_in_for_an_ni_card_keeps_the_rules_of_the_driver(
    quick: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench_of(quick, monkeypatch)
    monkeypatch.delitem(sys.modules, "study_simulated", raising=False)
    simulated = importlib.import_module("study_simulated")
    clock, out = simulated.SimulatedClock([]), []
    driver = simulated.SimulatedNi(clock, out)

    def task(channel: str = "Dev1/ao0") -> Any:
        made = driver.Task()
        made.ao_channels.add_ao_voltage_chan(channel, min_val=-1.0, max_val=1.0)
        return made

    with task() as block:
        block.timing.cfg_samp_clk_timing(10.0, sample_mode="finite", samps_per_chan=3)
        block.write([0.1, 0.2, 0.3], auto_start=True)
        assert not block.is_task_done()
        clock.sleep(0.3)
        assert block.is_task_done()
        with pytest.raises(driver.DaqError, match="-50103: the specified resource is reserved"), task() as second:
            second.write(0.0, auto_start=True)
        with task("Dev1/ao1") as other:
            other.write(1.0, auto_start=True)
        block.stop()
        with task() as second:
            second.write(-1.0, auto_start=True)
            with pytest.raises(driver.DaqError, match=r"-200077: a voltage is outside -1\.0 to 1\.0 V"):
                second.write(-1.01, auto_start=True)
        with pytest.raises(AssertionError, match="before start"), task() as second:
            second.write(0.0)
    assert (out, driver.tasks) == ([3, 1.0, -1.0], [])
    task().write(0.5, auto_start=True)
    assert len(driver.tasks) == 1
    with pytest.raises(driver.DaqError, match="-50103"):
        task().write(0.0, auto_start=True)

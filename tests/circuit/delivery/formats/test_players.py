"""Players that come with PsychoPy drives, run with a clock, an NI device and a serial line that are stand-ins."""

import csv
import io
import re
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.daq import Daq
from tests.circuit.delivery.one_drive import changed, prepare
from tests.circuit.verdicts import MADE_UP, GreenVerdict
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.formats.form import MustPrevent, Played, must_prevent
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library

RIG = Rig.load("thenar").with_(**{"driver.transconductance_A_per_V": 0.1})
ICON = load_library("six-icons")["double-dip"]
MUST = must_prevent([MADE_UP])


class Clock:
    """Time that passes only in sleep."""

    def __init__(self) -> None:
        self.now = 100.0
        self.events: list[Callable[[], None]] = []

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        assert seconds > 0
        self.now += seconds
        for event in self.events:
            event()


class Bench:
    """A player of drives on a device, with its clock and its folder."""

    def __init__(self, device: Device, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        form = load_format("psychopy")
        ready = prepare(ICON, RIG, device, form, gate=GreenVerdict)
        self.files = pack([ready], form)
        self.drive = form.file_name(ready.delivery)
        (folder / self.drive).write_bytes(self.files[self.drive])
        self.path = str(folder / self.drive)
        self.clock = Clock()
        self.daq = Daq(self.clock.monotonic)
        monkeypatch.setitem(sys.modules, "nidaqmx", self.daq)
        monkeypatch.setitem(sys.modules, "nidaqmx.constants", self.daq)
        self.player: dict[str, Any] = {}
        exec(compile(self.files["play_icons.py"], "play_icons.py", "exec"), self.player)
        self.player["time"] = self.clock
        self.reading = 32.0
        self.noise = 0.001
        self.sent: list[bytes] = []
        self.port = types.SimpleNamespace(write=self.sent.append)

    def measured(self) -> float:
        """A live reading: its last digit moves."""
        self.noise = -self.noise
        return self.reading + self.noise

    def rows(self) -> list[dict[str, str]]:
        return list(csv.DictReader(io.StringIO(self.files[self.drive].decode())))

    def play(self, *arguments: object) -> None:
        self.player["play"](self.path, *arguments)

    def stops(self, words: str, *arguments: object) -> None:
        with pytest.raises(RuntimeError, match=words):
            self.play(*arguments)

    def at(self, time_s: float, strikes: Callable[[], None]) -> None:
        """What happens once, later."""

        def event() -> None:
            if self.clock.now > time_s:
                self.clock.events.clear()
                strikes()

        self.clock.events.append(event)

    def cools(self, sign: float = 1.0) -> None:
        """The display goes with the last voltage: above rest it cools."""

        def moves() -> None:
            if self.daq.out and isinstance(self.daq.out[-1], float) and self.daq.out[-1] > 1.0:
                self.reading -= sign * 0.1

        self.clock.events.append(moves)


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Device], Bench]:
    return lambda device: Bench(device, tmp_path, monkeypatch)


@pytest.fixture
def ni(bench: Callable[[Device], Bench]) -> Bench:
    return bench(Device.load("ni-analogue-output"))


@pytest.fixture
def tcs(bench: Callable[[Device], Bench]) -> Bench:
    return bench(Device.load("qst-tcs2"))


def interrupt() -> None:
    raise KeyboardInterrupt


class TestVolts:
    """The player on an NI analogue output."""

    def test_it_holds_the_rest_and_then_puts_out_every_command(self, ni: Bench) -> None:
        ni.play()
        commands = [float(row["command_V"]) for row in ni.rows()]
        assert ni.daq.out == [commands[0], commands]
        assert (ni.daq.rate, ni.daq.count) == (pytest.approx(100.0), len(commands))
        assert ni.clock.now == pytest.approx(100.0 + 30.0 + 8.02, abs=0.1)

    def test_it_refuses_a_play_before_the_pause_is_over(self, ni: Bench) -> None:
        ni.play()
        ni.clock.now += 5.0
        ni.stops(r"the pause of 20 s between plays is not over: wait 15\.0 s more")
        ni.clock.now += 15.5
        ni.play()
        assert len(ni.daq.out) == 3, "the rest is held before the first play alone"

    def test_a_display_outside_the_cut_off_ends_with_zero(self, ni: Bench) -> None:
        ni.cools()

        def runs_away() -> None:
            if ni.daq.out and isinstance(ni.daq.out[-1], list):
                ni.reading += 0.3

        ni.clock.events.append(runs_away)
        ni.stops(r"the display is at 4\d\.\d\d degrees C, outside 20 to 40", ni.measured)
        assert (ni.daq.out[-1], ni.daq.stopped) == (0.0, 1)
        ni.stops(r"stopped before: find out why, then call reset\(\)")

    def test_abort_ends_with_zero(self, ni: Bench) -> None:
        ni.at(132.0, ni.player["abort"])
        ni.stops(r"abort\(\) was called")
        assert (ni.daq.out[-1], ni.daq.stopped) == (0.0, 1)

    def test_swapped_wires_are_found_before_the_first_play_and_right_ones_pass(self, ni: Bench) -> None:
        ni.cools(sign=-1.0)
        ni.stops(r"fell by -\d\.\d\d K, not by 0\.15 K, under 2 V that must cool", ni.measured)
        assert ni.daq.out == [2.0, 0.0]  # 0.2 A through 0.1 A/V
        ni.player["reset"]()
        ni.clock.events.clear()
        ni.cools()
        ni.play(ni.measured)
        assert ni.daq.out[2] == 2.0

    @pytest.mark.parametrize("at_s", [100.2, 110.0, 132.0], ids=["test of the wires", "rest", "play"])
    def test_an_interrupt_leaves_no_current(self, ni: Bench, at_s: float) -> None:
        ni.cools()
        ni.at(at_s, interrupt)
        with pytest.raises(KeyboardInterrupt):
            ni.play(ni.measured)
        assert ni.daq.out[-1] == 0.0
        ni.stops("stopped before")

    @pytest.mark.parametrize("last", [float("nan"), None], ids=["no number", "no answer"])
    def test_a_sensor_lost_at_the_end_of_the_test_is_no_pass(self, ni: Bench, last: float | None) -> None:
        ni.cools()

        def reading() -> float:
            if ni.clock.now > 100.0 + ni.player["TEST_S"] - 1e-9:
                return last if last is not None else 1 / 0
            return ni.measured()

        ni.stops("the sensor is lost", reading)
        assert ni.daq.out == [2.0, *[0.0] * (len(ni.daq.out) - 1)]
        assert len(ni.daq.out) > 1

    @pytest.mark.parametrize(
        ("reading", "words"),
        [
            (lambda: float("nan"), r"the sensor is lost: it reads nan"),
            (lambda: 500.0, r"the sensor is lost: it reads 500\.0 degrees C"),
            (lambda: 1 / 0, r"the sensor is lost \(.*division by zero\)"),
            (lambda: 31.0, r"the sensor is frozen: it has read 31\.000 degrees C for 5 s"),
        ],
    )
    def test_a_sensor_that_fails_ends_with_zero(self, ni: Bench, reading: Callable[[], float], words: str) -> None:
        ni.player["TEST_POLARITY"] = False
        ni.stops(words, reading)
        assert ni.daq.out[-1] == 0.0


class TestThermode:
    """The player of a thermode's commands."""

    def test_it_sends_the_start_last_and_after_the_rest(self, tcs: Bench) -> None:
        with pytest.raises(RuntimeError, match="nothing was prepared"):
            tcs.player["play"](None)
        tcs.player["prepare"](tcs.port, tcs.path)
        assert b"L" not in tcs.sent
        tcs.player["play"](tcs.port)
        assert tcs.sent == tcs.files[tcs.drive].split()
        assert tcs.clock.now == pytest.approx(130.0)
        with pytest.raises(RuntimeError, match=r"wait 28\.0 s more"):  # 8 s of icon and 20 s of pause
            tcs.player["play"](tcs.port)

    @pytest.mark.parametrize("interrupted", [True, False], ids=["interrupt", "display outside the cut-off"])
    def test_what_must_not_go_on_is_aborted(self, tcs: Bench, interrupted: bool) -> None:
        def strikes() -> None:
            if b"L" in tcs.sent:
                tcs.reading = 45.0
                if interrupted:
                    raise KeyboardInterrupt

        tcs.player["prepare"](tcs.port, tcs.path)
        tcs.clock.events.append(strikes)
        with pytest.raises((KeyboardInterrupt, RuntimeError)) as ended:
            tcs.player["play"](tcs.port, tcs.measured)
        assert interrupted or re.match(r"the display is at 45\.\d\d degrees C, outside 20 to 40", str(ended.value))
        assert isinstance(ended.value, KeyboardInterrupt) == interrupted
        assert tcs.sent[-2:] == [b"L", b"A"]


class TestSetpoints:
    """The player of set-points for a controller."""

    LOOP = Device.load("closed-loop-controller")

    def test_rows_are_sent_at_their_times(self, bench: Callable[[Device], Bench]) -> None:
        loop = bench(self.LOOP)
        sent: list[tuple[float, float]] = []
        loop.play(lambda level: sent.append((loop.clock.now, level)), lambda: None)
        rows = loop.rows()
        assert [level for _, level in sent[1:]] == [float(row["display_C"]) for row in rows]
        late = [at - 130.0 - float(row["time_s"]) for (at, _), row in zip(sent[1:], rows, strict=True)]
        assert max(map(abs, late)) < 1e-6

    def test_the_output_is_off_after_a_cut_off(self, bench: Callable[[Device], Bench]) -> None:
        loop = bench(self.LOOP)
        off: list[float] = []
        loop.reading = 45.0
        loop.stops("outside 20 to 40", lambda _: None, lambda: off.append(loop.clock.now), loop.measured)
        assert off

    def test_as_a_voltage_off_is_the_rest(self, bench: Callable[[Device], Bench]) -> None:
        gain = changed(self.LOOP, "set-point gain", "V/K", value=0.1)
        volts = bench(changed(gain, "set-point offset", "V", value=-2.0))
        commands = [float(row["command_V"]) for row in volts.rows()]
        assert commands[0] == pytest.approx(0.1 * 32.0 - 2.0)
        volts.at(132.0, volts.player["abort"])
        volts.stops(r"abort\(\) was called")
        assert volts.daq.out[-1] == pytest.approx(commands[0])


class TestMustPrevent:
    """Numbers of the gate as players get them."""

    def test_the_strictest_of_a_set_counts(self) -> None:
        gentle = {
            **MADE_UP, "watchdog_s": 1.0, "pause_at_least_s": 90.0, "polarity_check": {"needed": False},
            "cut_off_display_C": {"low": 24.0, "high": 44.0, "react_within_s": 0.5},
        }  # fmt: skip
        found = must_prevent([MADE_UP, gentle])
        assert found == MustPrevent(0.4, 24.0, 40.0, 0.1, True, 0.2, 0.5, 0.15, 30.0, 90.0)

    def test_what_the_gate_does_not_find_is_assumed(self) -> None:
        unknown = {"polarity_check": None, "rest_before_first_play_s": None, "pause_at_least_s": None}
        found = must_prevent([{**MADE_UP, **unknown}])
        assert (found.test_polarity, found.rest_s, found.pause_s) == (False, 1800.0, 60.0)

    def test_a_set_has_one_player(self) -> None:
        form = load_format("c-array")
        ready = prepare(ICON, RIG, Device.load("dac-12"), form, gate=GreenVerdict)
        assert set(form.player([Played(ready.delivery, "a.h", "a.json")], MUST)) == set(form.set_files)

"""PsychoPy players on a simulated clock, NI device or serial line."""

import re
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.delivery.formats.player_bench import Bench
from tests.circuit.delivery.one_drive import changed, icon_of
from tests.circuit.verdicts import LOOP
from thermicon.circuit import Device
from thermicon.circuit.delivery.formats import load_format


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Bench]:
    return lambda device, *icon, **demands: Bench(device, tmp_path, monkeypatch, *icon, **demands)


@pytest.fixture
def ni(bench: Callable[..., Bench]) -> Bench:
    return bench(Device.load("ni-analogue-output"))


@pytest.fixture
def tcs(bench: Callable[..., Bench]) -> Bench:
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
        assert ni.clock.true_s == pytest.approx(100.0 + 30.0 + 8.02, abs=0.1)

    def test_it_refuses_a_play_before_the_pause_is_over(self, ni: Bench) -> None:
        ni.play()
        ni.clock.true_s += 5.0
        ni.stops(r"the pause of 20 s between plays is not over: wait 15\.0 s more")
        ni.clock.true_s += 15.5
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
        ni.clock.at(132.0, ni.player["abort"])
        ni.stops(r"abort\(\) was called")
        assert (ni.daq.out[-1], ni.daq.stopped) == (0.0, 1)

    def test_swapped_wires_are_found_before_the_first_play_and_right_ones_pass(self, ni: Bench) -> None:
        ni.cools(sign=-1.0)
        ni.stops(r"fell by -\d\.\d\d K at the sensor, not by 0\.15 K, under 0\.2 A that must cool", ni.measured)
        assert ni.daq.out == [0.0, 0.0, 2.0, 0.0]  # off before, then 0.2 A through 0.1 A/V
        assert ni.clock.true_s == pytest.approx(100.0 + 10.0 + 0.5, abs=0.1)
        ni.player["reset"]()
        ni.clock.events.clear()
        ni.cools()
        ni.play(ni.measured)
        assert ni.daq.out[6] == 2.0

    @pytest.mark.parametrize(
        "at_s", [105.0, 110.2, 120.0, 142.5], ids=["off before", "test of the wires", "rest", "play"]
    )
    def test_an_interrupt_leaves_no_current(self, ni: Bench, at_s: float) -> None:
        ni.cools()
        ni.clock.at(at_s, interrupt)
        with pytest.raises(KeyboardInterrupt):
            ni.play(ni.measured)
        assert ni.daq.out[-1] == 0.0
        ni.stops("stopped before")

    @pytest.mark.parametrize("last", [float("nan"), None], ids=["no number", "no answer"])
    def test_a_sensor_lost_at_the_end_of_the_test_is_no_pass(self, ni: Bench, last: float | None) -> None:
        ni.cools()

        def reading() -> float:
            if ni.clock.true_s > 110.0 + ni.player["TEST_S"] - 1e-9:
                return last if last is not None else 1 / 0
            return ni.measured()

        ni.stops("the sensor is lost", reading)
        assert ni.daq.out == [0.0, 0.0, 2.0, 0.0]

    @pytest.mark.parametrize(
        ("reading", "words"),
        [
            (lambda: float("nan"), r"the sensor is lost: it reads nan"),
            (lambda: 500.0, r"the sensor is lost: it reads 500\.0 degrees C"),
            (lambda: 1 / 0, r"the sensor is lost \(.*division by zero\)"),
            (lambda: 31.0, r"the sensor is frozen: it has read 31\.000 degrees C while \d\.\d\d K were predicted"),
        ],
    )
    def test_a_sensor_that_fails_ends_with_zero(self, ni: Bench, reading: Callable[[], float], words: str) -> None:
        ni.player["TEST_POLARITY"] = False
        ni.stops(words, reading)
        assert ni.daq.out[-1] == 0.0

    @pytest.mark.parametrize(("name", "rate"), [("ni-analogue-output", 20_000.0), ("dac-16", 48_000.0)])
    def test_above_10_000_updates_a_second_the_judged_drive_is_put_out(
        self, bench: Callable[..., Bench], name: str, rate: float
    ) -> None:
        quick = changed(Device.load(name), "update rate", "Hz", value=rate)
        shape = "rest for 50 ms; to 0.2 A over 30 ms; hold for 100 ms; to 0 A over 30 ms; hold for 50 ms"
        fast = bench(quick, icon_of(shape, "current"))
        fast.play()
        judged = fast.ready.delivery.delivered
        times = np.arange(len(fast.daq.out[1])) / fast.daq.rate
        assert fast.daq.rate == pytest.approx(rate)
        assert times[-1] == pytest.approx(judged.time_s[-1])
        assert 0.1 * np.array(fast.daq.out[1]) == pytest.approx(judged.at(times + 1e-9), abs=1e-9)
        thinned = load_format("csv").write(fast.ready.delivery)
        Path(fast.path).write_bytes(thinned)
        fast.rejudge()
        fast.clock.true_s += 100.0
        fast.stops(
            r"row \d+: at \d\.\d+ s, where rows at one rate from 0 s on have .* give a drive with a row for each"
        )

    @pytest.mark.parametrize(
        ("row", "column", "cell", "words"),
        [
            (1, 0, "0.5", "row 1: at 0.5 s"), (400, 0, "3.995", "row 400: at 3.995 s"),
            (9, 0, "nan", "numbers"), (9, 2, "inf", "numbers"), (9, 2, "", "not a drive, a cell cannot be read"),
            (802, 0, "9.02", "row 2: at 0.01 s"), (0, 2, "volts", "a cell cannot be read .*command_V"),
        ],
    )  # fmt: skip
    def test_a_drive_with_another_clock_is_refused(
        self, ni: Bench, row: int, column: int, cell: str, words: str
    ) -> None:
        lines = [line.split(",") for line in Path(ni.path).read_text().splitlines()]
        lines[row][column] = cell
        Path(ni.path).write_text("\n".join(map(",".join, lines)))
        ni.stops("is not the file that was judged, its digest differs: export it again")
        ni.rejudge()
        ni.stops(words)
        Path(ni.path).write_text("\n".join(map(",".join, lines[:2])))
        ni.rejudge()
        ni.stops("two rows or more" if row else "cannot be read")
        assert not ni.daq.out

    def test_what_may_have_played_before_is_followed_by_the_longer_of_rest_and_pause(
        self, bench: Callable[..., Bench]
    ) -> None:
        ni = bench(Device.load("ni-analogue-output"), rest_before_first_play_s=2.0, pause_at_least_s=20.5)
        ni.play()
        assert ni.daq.ends - 8.02 == pytest.approx(100.0 + 20.5, abs=0.01)
        ni.clock.true_s += 1.0
        ni.player["abort"]()
        ni.player["reset"]()
        ni.play()
        assert ni.daq.ends - 8.02 == pytest.approx(100.0 + 20.5 + 8.02 + 1.0 + 20.5, abs=0.1)

    @pytest.mark.parametrize(
        ("reads", "words"),
        [
            (lambda now: float("nan"), "clock of this computer is wrong"),
            (lambda now: now - 5.0, "clock of this computer is wrong: it reads 12"),
            (lambda now: 132.0, r"clock of this computer stands still at 132\.0 s"),
        ],
    )
    def test_a_clock_that_is_wrong_ends_with_zero(self, ni: Bench, reads: Callable[[float], float], words: str) -> None:
        true = ni.clock.monotonic
        ni.clock.monotonic = lambda: true() if true() < 132.0 else reads(true())  # type: ignore[method-assign]
        ni.stops(words)
        assert (ni.daq.out[-1], ni.daq.stopped) == (0.0, 1)
        assert true() < 132.3

    @pytest.mark.parametrize("step_K", [0.05, 0.1])
    def test_a_live_sensor_of_tenths_is_not_frozen_in_rest_and_pause(self, ni: Bench, step_K: float) -> None:
        ni.player["TEST_POLARITY"] = False
        display = ni.ready.delivery.trace

        def reading() -> float:
            since = ni.clock.true_s - (ni.daq.ends - 8.02)
            return step_K * round(float(np.interp(since, display.time_s, display.display_C)) / step_K)

        for _ in range(3):
            ni.play(reading)
            ni.clock.true_s += 20.0

    def test_the_cut_off_acts_on_either_sensor(self, ni: Bench) -> None:
        ni.player["TEST_POLARITY"] = False
        second = iter([32.0 + 0.001 * (k % 2) for k in range(700)] + [41.0])
        ni.stops(r"the display is at 41\.00 degrees C", ni.measured, lambda: next(second))
        ni.player["reset"]()
        ni.stops(r"the second sensor is lost", ni.measured, lambda: None)
        ni.player["reset"]()
        ni.stops(r"the second sensor is frozen", None, lambda: 32.0)
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
        assert tcs.clock.true_s == pytest.approx(130.0, abs=0.02)  # with 0.01 s of line
        with pytest.raises(RuntimeError, match=r"wait 28\.0 s more"):  # 8 s of icon and 20 s of pause
            tcs.player["play"](tcs.port)

    def test_after_a_reset_the_rest_is_held_again(self, tcs: Bench) -> None:
        tcs.player["prepare"](tcs.port, tcs.path)
        tcs.player["play"](tcs.port)
        tcs.clock.true_s += 3.0
        tcs.player["abort"]()
        assert tcs.sent[-1] == b"A", "nobody watches this play"
        tcs.player["reset"]()
        began = tcs.clock.true_s
        tcs.player["play"](tcs.port)
        assert tcs.clock.true_s == pytest.approx(began + 30.0, abs=1e-3)

    def test_a_profile_that_ends_early_is_not_sent(self, tcs: Bench) -> None:
        Path(tcs.path).write_bytes(tcs.files[tcs.drive][:-9])
        with pytest.raises(RuntimeError, match="is not the file that was judged"):
            tcs.player["prepare"](tcs.port, tcs.path)
        tcs.rejudge()
        with pytest.raises(ValueError, match="not the commands of a profile"):
            tcs.player["prepare"](tcs.port, tcs.path)
        assert not tcs.sent

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

    def test_rows_are_sent_at_their_times(self, bench: Callable[..., Bench]) -> None:
        loop = bench(self.LOOP)
        sent: list[tuple[float, float]] = []
        loop.play(lambda level: sent.append((loop.clock.true_s, level)), lambda: None)
        rows = loop.rows()
        assert [level for _, level in sent[1:]] == [float(row["display_C"]) for row in rows]
        late = [at - 130.0 - float(row["time_s"]) for (at, _), row in zip(sent[1:], rows, strict=True)]
        assert max(map(abs, late)) < 1e-6

    def test_the_output_is_off_after_a_cut_off(self, bench: Callable[..., Bench]) -> None:
        loop = bench(self.LOOP)
        off: list[float] = []
        loop.reading = 45.0
        loop.stops("outside 20 to 40", lambda _: None, lambda: off.append(loop.clock.true_s), loop.measured)
        assert off

    def test_a_computer_that_hangs_for_longer_than_may_be_ends_it(self, bench: Callable[..., Bench]) -> None:
        loop = bench(self.LOOP)
        sent: list[float] = []

        def hangs() -> None:
            loop.clock.true_s += 0.15

        loop.clock.at(132.0, hangs)
        loop.stops(r"late by 0\.1\d s", sent.append, lambda: sent.append(-1.0))
        assert sent[-1] == -1.0

    def test_a_controller_without_a_second_sensor_is_told_once(self, bench: Callable[..., Bench]) -> None:
        loop = bench(self.LOOP, loop=LOOP)
        with pytest.warns(UserWarning, match="needs a second sensor: give its function as second_C") as told:
            loop.play(lambda _: None, lambda: None, loop.follows)
        assert len(told) == 1
        loop.clock.true_s += 100.0
        with warnings.catch_warnings(action="error"):
            began_s = loop.clock.true_s - 130.0
            loop.play(lambda _: None, lambda: None, *[lambda: loop.follows(began_s)] * 2)

    def test_as_a_voltage_off_is_the_rest(self, bench: Callable[..., Bench]) -> None:
        gain = changed(self.LOOP, "set-point gain", "V/K", value=0.1)
        volts = bench(changed(gain, "set-point offset", "V", value=-2.0))
        commands = [float(row["command_V"]) for row in volts.rows()]
        assert commands[0] == pytest.approx(0.1 * 32.0 - 2.0)
        volts.clock.at(132.0, volts.player["abort"])
        volts.stops(r"abort\(\) was called")
        assert volts.daq.out[-1] == pytest.approx(commands[0])

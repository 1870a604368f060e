"""The guard as steps in time: what it stops, refuses and lets go on, on a bench that keeps its rules."""

import math
import re
import threading
import time
from typing import Any

import pytest

from tests.circuit.play.guarded import BLOCK, ROWS, TEST, BlockLine, World
from thermicon.circuit.play.function import FunctionLine
from thermicon.circuit.play.guard import Guard
from thermicon.circuit.play.watch import Refused, Stopped


def test_a_device_is_opened_before_a_rest_only_which_would_forget_that_it_switched_off(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[float] = []
    monkeypatch.setattr(world.line, "open", lambda: opened.append(world.clock.true_s))
    world.play()
    world.clock.passes(10.0)
    world.play()
    assert len(opened) == 1
    world.guard.abort()
    world.guard.reset()
    world.play()
    assert len(opened) == 2


class TestSupervision:
    """Looks too far apart stop, whoever made them late."""

    @pytest.mark.parametrize("rows", [ROWS, BLOCK], ids=["rows", "block"])
    def test_a_sensor_that_hangs_in_mid_play_stops_in_the_time_to_react(self, world: World, rows: Any) -> None:
        line = BlockLine(world.bench) if rows is BLOCK else world.line
        world.clock.at(105.0, lambda: setattr(world.bench, "hangs", True))
        world.stops(r"the sensor took 0\.1\d s for a reading, and a look may take 0\.1 s", line, rows)
        assert world.clock.true_s < 105.0 + 0.05 + 0.1 + 0.01

    def test_one_reading_of_a_minute_is_no_ok(self, world: World) -> None:
        world.clock.at(105.0, lambda: setattr(world.bench, "reads_s", lambda: 60.0))
        world.stops(r"the sensor took 60\.00 s for a reading", BlockLine(world.bench), BLOCK)

    @pytest.mark.parametrize("rows", [ROWS, BLOCK], ids=["rows", "block"])
    def test_a_computer_that_hangs_says_so(self, world: World, rows: Any) -> None:
        line = BlockLine(world.bench) if rows is BLOCK else world.line
        world.clock.at(105.0, lambda: world.clock.passes(0.15))
        world.stops(r"this computer was late by 0\.\d\d s", line, rows)

    def test_a_computer_that_hangs_for_less_plays_on(self, world: World) -> None:
        for at_s in (104.02, 105.02, 106.02):
            world.clock.at(at_s, lambda: world.clock.passes(0.04))
        world.play()

    def test_where_no_cut_off_is_quick_enough_a_look_may_take_a_second(self) -> None:
        world = World(react_s=0.0, late_s=1.0)
        world.bench.reads_s = lambda: 0.1  # most thermometers on USB
        world.play()
        world.clock.passes(10.0)
        slow_s = world.clock.true_s + 3.0
        world.bench.reads_s = lambda: 1.01 if world.clock.true_s > slow_s else 0.1
        world.stops(r"the sensor took 1\.01 s for a reading, and a look may take 1 s")

    @pytest.mark.parametrize(("part", "passes"), [(0.79, True), (0.81, False), (1.5, False)])
    def test_a_sensor_that_is_always_slow_is_refused_before_anything_is_put_out(
        self, world: World, part: float, passes: bool
    ) -> None:
        world.bench.reads_s = lambda: part * 0.1
        if passes:
            return world.play()
        with pytest.raises(Refused, match=r"guard must act within 0\.1 s: read them in 0\.08 s, 12\.5 times a sec"):
            world.play()
        assert not world.bench.out
        world.bench.reads_s = lambda: 0.01
        world.play()  # a quicker one needs no reset
        return None

    def test_two_sensors_are_timed_together(self, world: World) -> None:
        world.bench.reads_s = lambda: 0.041
        with pytest.raises(Refused, match=r"the sensors take 0\.08 s for a reading"):
            world.play(second=True)
        world.bench.reads_s = lambda: 0.039
        world.play(second=True)

    def test_a_sensor_that_is_slow_at_times_plays_and_nothing_is_sent_meanwhile(self, world: World) -> None:
        times = iter([0.0, 0.07, 0.02, 0.079, 0.0, 0.05] * 1000)
        world.bench.reads_s = lambda: next(times)
        world.play()
        assert [level for _, _, level in world.bench.out][1:] == [level for _, level in ROWS]

    def test_what_the_device_needs_to_hear_it_hears_five_times_a_second(self, world: World) -> None:
        world.play()
        assert world.bench.feeds >= 5 * 8.0
        feeds, began_s = world.bench.feeds, world.clock.true_s
        while world.clock.true_s < began_s + 2.0:
            world.clock.passes(0.016)
            world.guard.keep()
        assert world.bench.feeds - feeds >= 9


class TestAbort:
    """Off at once, from any thread."""

    def real(self, **numbers: Any) -> tuple[World, threading.Thread, list[BaseException]]:
        """A play in real time, in a thread."""
        world, problems = World(rest_s=0.01, pause_s=0.0, **numbers), list[BaseException]()
        world.guard = Guard(lambda: world.numbers, time.monotonic, time.sleep)

        def play() -> None:
            try:
                world.play()
            except BaseException as problem:
                problems.append(problem)

        thread = threading.Thread(target=play, daemon=True)
        thread.start()
        while len(world.bench.out) < 4:
            time.sleep(0.01)
        return world, thread, problems

    def test_it_is_off_at_once_while_a_reading_hangs(self) -> None:
        world, thread, problems = self.real(react_s=2.0)
        world.bench.hangs = True
        time.sleep(0.1)
        assert not world.bench.is_off
        world.guard.abort()
        assert world.bench.is_off
        thread.join(4.0)
        assert re.search(r"abort\(\) was called", str(problems[0]))
        world.bench.goes_on.set()

    def test_it_is_off_at_once_while_a_set_point_hangs(self) -> None:
        world, thread, problems = self.real()
        hang = threading.Event()
        world.line._send = lambda level_C: hang.wait(5.0)
        time.sleep(0.15)
        began_s = time.monotonic()
        world.guard.abort()
        assert world.bench.is_off
        assert time.monotonic() - began_s < 0.5
        hang.set()
        thread.join(2.0)
        assert isinstance(problems[0], Stopped)
        assert world.bench.is_off

    def test_a_row_that_was_on_its_way_is_followed_by_off(self, world: World) -> None:
        """abort() comes from another thread while a row is sent, and is over before it is out."""

        def send(level_C: float) -> None:
            if len(world.bench.out) == 20:
                world.guard.abort()
            world.bench.send(level_C)

        world.line._send = send
        world.stops(r"abort\(\) was called")

    def test_nothing_plays_before_a_reset_and_then_everything_is_held_again(self, world: World) -> None:
        world.play()
        world.guard.abort()
        assert world.bench.is_off
        with pytest.raises(Refused, match=r"stopped before: find out why, then call reset\(\)"):
            world.play()
        with pytest.raises(Stopped, match=r"abort\(\) was called"):
            world.guard.keep()
        world.guard.reset()
        began_s = world.clock.true_s
        world.play()
        assert world.clock.true_s == pytest.approx(began_s + 3.0 + 5.0, abs=0.1)

    def test_a_play_that_has_not_ended_is_not_reset(self, world: World) -> None:
        """Else it would go on after its abort."""

        def aborts() -> None:
            world.guard.abort()
            with pytest.raises(Refused, match="busy: what was stopped has not ended yet"):
                world.guard.reset()

        world.clock.at(105.0, aborts)
        world.stops(r"abort\(\) was called")

    def test_a_second_play_is_refused_and_the_first_goes_on(self, world: World) -> None:
        refused = []

        def again() -> None:
            for begin in (world.guard.begin_play, world.guard.begin_rest):
                with pytest.raises(Refused, match="busy: a rest or a play has not ended") as problem:
                    begin(world.line, ROWS, 32.0) if begin == world.guard.begin_play else begin(world.line, 32.0)
                refused.append(problem)

        for at_s in (101.0, 105.0):
            world.clock.at(at_s, again)
        world.play()
        assert len(refused) == 4
        assert [level for _, _, level in world.bench.out][1:] == [level for _, level in ROWS]


class TestKeep:
    """Between plays the experiment's own loop looks and feeds."""

    def kept(self, world: World, until_s: float, every_s: float = 0.016) -> None:
        while world.clock.true_s < until_s:
            world.clock.passes(every_s)
            world.guard.keep()
            time.sleep(0.0005)  # a look is in a thread of its own

    def test_before_anything_it_does_nothing(self, world: World) -> None:
        world.guard.keep()
        assert not world.bench.looks

    def test_a_display_that_runs_away_between_plays_is_switched_off(self, world: World) -> None:
        world.play()
        looks = world.bench.looks
        self.kept(world, world.clock.true_s + 1.0)
        assert world.bench.looks - looks >= 10
        world.bench.display = lambda now_s: 41.0
        began_s = world.clock.true_s
        with pytest.raises(Stopped, match="the display is at 41"):
            self.kept(world, began_s + 1.0)
        assert world.bench.is_off
        assert world.clock.true_s - began_s < 0.2

    def test_an_experiment_that_is_late_between_plays_stops_nothing(self, world: World) -> None:
        world.play()
        self.kept(world, world.clock.true_s + 5.0, every_s=0.7)
        world.play()

    def test_a_sensor_that_hangs_between_plays_does(self, world: World) -> None:
        world.play()
        world.bench.hangs = True
        with pytest.raises(Stopped, match=r"the sensor took 0\.1\d s for a reading"):
            self.kept(world, world.clock.true_s + 1.0)
        assert world.bench.is_off

    def test_it_leaves_a_play_alone(self, world: World) -> None:
        world.clock.at(105.0, world.guard.keep)
        world.play()
        assert [level for _, _, level in world.bench.out][1:] == [level for _, level in ROWS]


class TestPolarity:
    """A current that must cool, ten seconds after the last one; both sensors."""

    def world(self, fall_K: tuple[float, float], **numbers: Any) -> World:
        """A display that falls by so much in a test, by either sensor."""
        world = World(**(TEST | numbers))

        def sensor(k: int) -> Any:
            def level(now_s: float) -> float:
                tests = [at_s for at_s, name, value in world.bench.out if name == "test" and value]
                if not tests or world.bench.out[-1][1] == "send":
                    return 32.0 + 1e-4 * math.sin(1e3 * now_s)
                fell = fall_K[k] * min(1.0, (now_s - tests[0]) / 2.0)
                return 32.0 - fell + 1e-4 * math.sin(1e3 * now_s)

            return level

        world.bench.first, world.bench.second = sensor(0), sensor(1)
        return world

    def test_it_is_off_for_ten_seconds_and_then_falls(self) -> None:
        world = self.world((1.1, 1.1))
        world.play(second=True)
        (off_s, _, _), (test_s, _, current_A), (rest_s, _, _) = world.bench.out[1:4]
        assert [name for _, name, _ in world.bench.out[:4]] == ["test", "off", "test", "send"]
        assert world.bench.out[0][2] == 0.0
        assert (test_s - off_s, rest_s - test_s, current_A) == pytest.approx((10.0, 2.0, 0.3), abs=0.01)

    @pytest.mark.parametrize(
        ("fall_K", "name"), [((0.9, 1.1), "sensor"), ((1.1, 0.9), "second sensor"), ((-2.0, -2.0), "sensor")]
    )
    def test_a_sensor_that_does_not_fall_stops(self, fall_K: tuple[float, float], name: str) -> None:
        world = self.world(fall_K)
        with pytest.raises(Stopped, match=rf"K at the {name}, not by 1 K, under 0\.3 A that must cool: swapped wires"):
            world.play(second=True)
        assert world.bench.is_off
        assert [one for _, one, _ in world.bench.out] == ["test", "off", "test", "off"]

    def test_a_line_that_cannot_test_needs_a_person_who_saw_it(self) -> None:
        world = World(**TEST)
        bench = world.bench
        mute = FunctionLine(bench.send, bench.off)
        for line, sensor in ((FunctionLine(bench.send, bench.off, bench.test), None), (mute, bench.measured_C)):
            for seen in ("", "  "):
                world.numbers = world.numbers._replace(polarity_seen=seen)
                with pytest.raises(Refused, match=r"write into POLARITY_SEEN who saw the display cool"):
                    world.guard.rest(line, 32.0, (sensor, None))
                assert not bench.out
        world.guard.reset()
        looks, world.numbers = bench.looks, world.numbers._replace(polarity_seen="A. Name, 28 November")
        world.play(mute, first=False)
        assert bench.looks == looks
        world.numbers = world.numbers._replace(test_polarity=False, polarity_seen="")
        world.clock.passes(10.0)
        world.play(mute)

    def test_a_line_that_can_test_does_so_whatever_was_seen(self) -> None:
        world = self.world((-1.0, -1.0), polarity_seen="A. Name, 28 November")
        with pytest.raises(Stopped, match="swapped wires"):
            world.play()


def test_steps_of_a_time_that_is_passed_in_are_what_plays() -> None:
    """Another loop than the guard's own: it is told when to come back, and comes back then."""
    world = World()
    world.guard.begin_play(world.line, ROWS, 32.0)
    now_s, steps = 100.0, 0
    while world.guard.busy:
        world.clock.true_s = now_s
        next_s = world.guard.step(now_s)
        time.sleep(0.001)  # the look is in a thread of its own
        assert next_s > now_s - 1e-9
        now_s, steps = max(now_s + 1e-3, min(next_s, now_s + 0.01)), steps + 1
    assert [level for _, _, level in world.bench.out][1:] == [level for _, level in ROWS]
    sent_s = [at_s for at_s, _, _ in world.bench.out][1:]
    late_s = [at_s - sent_s[0] - due_s for at_s, (due_s, _) in zip(sent_s, ROWS, strict=True)]
    assert max(map(abs, late_s)) < 0.02


@pytest.mark.parametrize("react_s", [0.02, 0.1])
def test_a_coarse_clock_makes_no_computer_late(react_s: float) -> None:
    world = World(react_s=react_s, look_every_s=react_s / 2.0)
    world.clock.tick_s = 0.0156
    world.play()
    assert len(world.bench.out) == 1 + len(ROWS)

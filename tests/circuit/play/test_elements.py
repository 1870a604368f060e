"""Several elements under one guard."""

import math
import re
import threading
import warnings
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import pytest

from tests.circuit.play.elements import BEGINS_S, HIGHEST_C, NAMES, Elements
from tests.circuit.play.guarded import PLAIN, TEST
from thermicon.circuit.play.element_lines import APART_AT_MOST_S, OFF_S
from thermicon.circuit.play.watch import Refused, Stopped

Break = Callable[[Elements, str], None]
STRIKES_S = BEGINS_S + 1.03  # displays move from then on


@pytest.mark.parametrize("names", ["a", "ab", "abc", "abcd"])
def test_each_element_plays_its_own_track_on_one_clock(names: str) -> None:
    world = Elements(names)
    assert world.stopped(second=True) == (math.inf, "")
    for name, bench in world.benches.items():
        sent = [(at_s, level) for at_s, _, level in bench.out][1:]
        due = [(BEGINS_S + at_s, row if world.alone else row[name]) for at_s, row in world.rows]
        assert sent == [(pytest.approx(at_s, abs=1e-6), level) for at_s, level in due]
        assert bench.feeds >= 5 * 8.0


def reads(change: Callable[[float, str], float]) -> Break:
    """The first sensor of an element reads something else."""

    def breaks(world: Elements, name: str) -> None:
        bench = world.benches[name]
        healthy = bench.first
        bench.first = lambda now_s: change(healthy(now_s), name)

    return breaks


def takes(seconds: float) -> Break:
    return lambda world, name: setattr(world.benches[name], "reads_s", lambda: seconds)


def raises(*_: Any) -> float:
    raise OSError("unplugged")


def sends(seconds: float, then: Callable[..., float] = lambda: 0.0) -> Break:
    """A line that takes a time for a row, or raises."""

    def breaks(world: Elements, name: str) -> None:
        def send(level_C: float) -> float:
            world.benches[name].send(level_C)
            world.clock.passes(seconds)
            return then()

        world.lines[name]._send = send

    return breaks


def stands(world: Elements, name: str) -> None:
    world.benches[name].display = lambda now_s: 32.0


def fails(name_of: str) -> Break:
    return lambda world, name: setattr(world.lines[name], name_of, raises)


FAULTS: dict[str, tuple[str, Break, Break | None]] = {
    "too warm": ("outside", reads(lambda _, name: HIGHEST_C[name] + 0.01), None),
    "lost": (r"sensor( of .)? is lost", reads(lambda *_: math.nan), None),
    "raises": (r"sensor( of .)? is lost \(unplugged", reads(raises), None),
    "flat": ("frozen|its prediction", reads(lambda *_: 32.0), None),
    "lies": ("from its prediction", reads(lambda now_C, _: now_C - 1.6), reads(lambda now_C, _: now_C - 1.0)),
    "slow": (r"took 0\.11 s", takes(0.11), takes(0.09)),
    "hangs": (r"took 0\.1\d s", lambda world, name: setattr(world.benches[name], "hangs", True), None),
    "stuck": ("from its prediction|frozen", stands, None),
    "unplugged": ("unplugged", sends(0.0, raises), None),
    "not fed": ("unplugged", fails("_feed"), None),
    "late line": ("late by|had a row", sends(0.12), sends(0.04)),
    "late host": (
        r"late by 0\.[12]\d s",
        lambda world, _: world.clock.passes(0.16),
        lambda world, _: world.clock.passes(0.04),
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_what_stops_one_element_stops_all_as_quickly_and_nothing_else_does(fault: str) -> None:
    words, unhealthy, healthy = FAULTS[fault]

    def stopped(names: str, name: str, breaks: Break) -> tuple[float, str]:
        world = Elements(names)
        world.clock.at(STRIKES_S, lambda: breaks(world, name))
        ended = world.stopped()
        world.benches[name].goes_on.set()
        return ended

    for name in NAMES:
        alone_s, _ = stopped(name, name, unhealthy)
        assert alone_s < math.inf
        for names in {"".join(sorted({name, "a"})), "abcd"} - {"a"}:
            at_s, why = stopped(names, name, unhealthy)
            assert re.search(words, why), why
            assert at_s <= alone_s + PLAIN.look_every_s
            assert healthy is None or stopped(names, name, healthy) == (math.inf, "")


def test_elements_without_second_sensors_are_told_where_a_cut_off_needs_them() -> None:
    world = Elements("ab", second_sensor=True)
    with pytest.warns(UserWarning, match="needs a second sensor: give functions for a, b as second_C"):
        world.play()
    with warnings.catch_warnings(action="error"):
        Elements("ab", second_sensor=True).play(second=True)


@pytest.mark.parametrize("name", NAMES)
def test_each_element_has_cut_offs_of_its_own(name: str) -> None:
    for by_K, stops in ((-0.01, False), (0.01, True)):
        world = Elements("abcd", closed_loop=False)
        bench = world.benches[name]
        bench.display = lambda _, name=name, by_K=by_K: HIGHEST_C[name] + by_K  # type: ignore[misc]
        at_s, why = world.stopped()
        assert (at_s < math.inf) == stops == why.startswith(f"{name}: the display is at")


@pytest.mark.parametrize(("by_s", "passes"), [(-0.005, True), (0.005, False)])
def test_elements_begin_a_row_at_most_a_tenth_of_a_second_apart(by_s: float, passes: bool) -> None:
    world = Elements("abcd", late_s=1.0, react_s=1.0)
    world.clock.at(STRIKES_S, lambda: sends(APART_AT_MOST_S / 2.0)(world, "b"))
    world.clock.at(STRIKES_S, lambda: sends(APART_AT_MOST_S / 2.0 + by_s)(world, "d"))
    at_s, why = world.stopped()
    assert (at_s == math.inf) == passes
    assert passes or re.match(r"d: it had a row 0\.1\d? s after .* may be 0\.1 s apart", why)
    assert world.line.apart_s == pytest.approx(APART_AT_MOST_S + by_s)


def test_exchanged_lines_leave_their_courses() -> None:
    for second in (False, True):
        world = Elements("abcd")
        benches = world.benches
        world.lines["a"]._send, world.lines["c"]._send = benches["c"].send, benches["a"].send
        at_s, why = world.stopped(second)
        assert at_s < BEGINS_S + 4.0
        assert re.search("[ac]: the display is at .* from its prediction", why)


class TestOff:
    """An element that cannot be switched off keeps no other one on."""

    @pytest.mark.parametrize("name", NAMES)
    @pytest.mark.parametrize("how", ["raises", "hangs"])
    def test_one_that_does_not_switch_off(self, name: str, how: str) -> None:
        world, goes_on = Elements("abcd"), threading.Event()
        world.lines[name]._off = raises if how == "raises" else lambda: goes_on.wait(10.0)
        world.clock.at(STRIKES_S, lambda: reads(lambda *_: math.nan)(world, "b"))
        with pytest.raises(Stopped, match=f"b: the sensor is lost.*; {name} did not switch off .*: cut the power"):
            world.play()
        assert [each for each, bench in world.benches.items() if not bench.is_off] == [name]
        goes_on.set()

    @pytest.mark.parametrize("what", ["start", "join"])
    def test_neither_an_interpreter_that_ends_nor_an_interrupt_keeps_one_on(
        self, what: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        world, problem = Elements("abcd"), RuntimeError if what == "start" else KeyboardInterrupt
        world.line.send(world.rest)
        join = threading.Thread.join

        def fails(thread: threading.Thread, timeout: float | None = None) -> None:
            if what == "join":
                join(thread, timeout)
            if what == "start" or timeout == OFF_S:
                raise problem

        monkeypatch.setattr(threading.Thread, what, fails)
        with pytest.raises(KeyboardInterrupt) if what == "join" else nullcontext():
            world.line.off()
        assert all(bench.is_off for bench in world.benches.values())

    def test_a_row_on_its_way_goes_no_further_after_an_abort(self) -> None:
        world = Elements("abcd")
        world.clock.at(STRIKES_S, lambda: sends(0.0, lambda: world.guard.abort() or 0.0)(world, "b"))
        _, why = world.stopped()
        assert "abort() was called" in why
        for name in "cd":
            sent = [out for out in world.benches[name].out if out[0] > STRIKES_S]
            assert {what for _, what, _ in sent} == {"off"}


class TestPolarity:
    """Before a first play a current by one element cools its display, and no other one."""

    @staticmethod
    def wired(exchanged: bool = False, swapped: str = "") -> Elements:
        world = Elements("abc", **TEST)
        for name, bench in world.benches.items():

            def display(now_s: float, bench: Any = bench, name: str = name) -> float:
                at_s, what, current_A = bench.out[-1] if bench.out else (0.0, "off", 0.0)
                fell_K = 4.0 * current_A * (now_s - at_s) if what == "test" else 0.0
                return 32.0 - (-fell_K if name == swapped else fell_K)

            bench.display = display
        if exchanged:
            benches = world.benches
            world.lines["a"]._test, world.lines["b"]._test = benches["b"].test, benches["a"].test
        return world

    def test_right_wires_pass_and_wrong_ones_are_named(self) -> None:
        world = self.wired()
        world.guard.rest(world.line, world.rest, ({n: b.measured_C for n, b in world.benches.items()}, None))
        assert {sensor: round(fell_K, 1) for sensor, fell_K in world.guard.fell_K.items()} == {
            f"sensor of {name}": 2.4 for name in "abc"
        }
        both = self.wired()
        a, c = both.benches["a"], both.benches["c"]
        both.lines["c"]._test = lambda current_A: (a.test(current_A), c.test(current_A))
        for name, world in (("b", self.wired(swapped="b")), ("a", self.wired(exchanged=True)), ("c", both)):
            _, why = world.stopped()
            assert why.startswith(f"{name}: under its 0.3 A that must cool")

    def test_an_element_without_a_test_or_a_sensor_is_refused(self) -> None:
        world = self.wired()
        world.lines["b"]._test = None
        with pytest.raises(Refused, match="b: the polarity must be tested"):
            world.play()
        assert all(bench.is_off for bench in world.benches.values())
        with pytest.raises(Refused, match="give a dict with a sensor for each of a, b, c, and no other one"):
            world.guard.rest(world.line, world.rest, ({"a": world.benches["a"].measured_C}, None))

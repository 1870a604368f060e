"""The sensors by which a guard watches a display."""

import time

import pytest

from tests.circuit.play.guarded import TEST, World
from thermicon.circuit.play.function import FunctionLine
from thermicon.circuit.play.watch import Refused, Stopped


class TestSensorsStay:
    """No call takes away the sensor by which a display is watched."""

    @pytest.mark.parametrize("at_s", [101.0, 105.0], ids=["in the rest", "in the play"])
    def test_a_refused_call_without_sensor_leaves_what_plays_watched(self, world: World, at_s: float) -> None:
        def again() -> None:
            with pytest.raises(Refused, match="busy"):
                world.play(FunctionLine(world.bench.send, world.bench.off), first=False)

        world.clock.at(at_s, again)
        world.clock.at(at_s + 1.0, lambda: setattr(world.bench, "display", lambda now_s: 60.0))
        world.stops("the display is at 60")
        assert world.clock.true_s < at_s + 1.2

    @pytest.mark.parametrize("refusal", ["pause", "polarity"])
    def test_nor_does_one_between_plays(self, world: World, refusal: str) -> None:
        world.play()
        if refusal == "polarity":
            world.clock.passes(2.0)
            world.numbers = world.numbers._replace(**TEST)
        with pytest.raises(Refused, match="write into POLARITY_SEEN" if refusal == "polarity" else "is not over"):
            world.guard.rest(FunctionLine(world.bench.send, world.bench.off), 32.0)
        world.bench.display = lambda now_s: 60.0
        with pytest.raises(Stopped, match="the display is at 60"):
            for _ in range(50):
                world.clock.passes(0.016)
                world.guard.keep()
                time.sleep(0.0005)
        assert world.bench.is_off

    def test_a_next_play_without_sensor_is_watched_by_the_one_before_until_a_reset(self, world: World) -> None:
        world.play()
        world.clock.passes(3.0)
        world.bench.display = lambda now_s: 60.0
        with pytest.raises(Stopped, match="the display is at 60"):
            world.play(first=False)
        world.guard.reset()
        world.play(first=False)

    def test_a_sensor_that_answers_nothing_is_lost(self, world: World) -> None:
        world.clock.at(105.0, lambda: setattr(world.bench, "first", lambda now_s: None))
        world.stops("the sensor is lost")

    def test_a_sensor_that_ends_its_thread_is_lost_with_a_name(self, world: World) -> None:
        def interrupted(now_s: float) -> float:
            raise KeyboardInterrupt

        world.clock.at(105.0, lambda: setattr(world.bench, "first", interrupted))
        world.stops(r"the sensor is lost \(KeyboardInterrupt\)")

    def test_one_that_still_hangs_after_a_reset_is_not_read_twice_at_once(self, world: World) -> None:
        world.clock.at(105.0, lambda: setattr(world.bench, "hangs", True))
        world.stops(r"the sensor took 0\.1\d s")
        world.guard.reset()
        world.stops(r"the sensor took 0\.1\d s for a reading")
        looks, world.bench.hangs = world.bench.looks, False
        world.bench.goes_on.set()
        time.sleep(0.05)
        assert world.bench.looks == looks
        world.guard.reset()
        world.play()

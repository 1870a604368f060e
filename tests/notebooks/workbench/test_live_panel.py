"""Live play on a page, in simulated time that goes ten times as fast as real time at most."""

import asyncio
import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import opened
from thermicon.base.files.inputs import InputError
from thermicon.circuit.live.play_live import SimulatedTime
from thermicon.notebooks import LivePlay
from thermicon.notebooks.workbench.live_panel import UNHEARD_S, LivePanel

QUICK = 10.0


@pytest.fixture
def live(monkeypatch: pytest.MonkeyPatch) -> LivePlay:
    now = SimulatedTime()

    def sleep(seconds: float) -> None:
        now.sleep(seconds)
        time.sleep(seconds / QUICK)

    monkeypatch.setattr(LivePanel, "timer", (now, sleep))
    return LivePlay("six-icons", "thenar", ["double-dip"])


def said(live: LivePanel, name: str = "status") -> str:
    return re.sub(r"<[^>]*>", "", live.said[name].value)


def until_off(
    live: LivePanel, button: str = "start", told: str = "never", act: Callable[[], None] = print, is_open: bool = True
) -> int:
    """Press a button, do something once the page has told so much, and return how many figures were seen."""

    async def played() -> int:
        getattr(live, button).click()
        seen, done = set[str](), False
        while live.on:
            seen.add(live.said["figure"].value)
            await asyncio.sleep(0.05)
            if is_open:
                live.key._handle_custom_msg("here", [])
            if not done and told in said(live):
                done = True
                act()
        await asyncio.sleep(0.2)
        return len(seen)

    return asyncio.run(played())


def test_a_check_says_how_each_demand_is_met_and_the_output_is_off_again(live: LivePlay) -> None:
    told = list[bool]()
    live._playing = told.append
    until_off(live, "check")
    assert said(live).startswith("done; take the hand off")
    assert "watchdog" in said(live, "report") and "proven" in said(live, "report")
    assert told == [True, False]
    assert (live.start.disabled, live.halt.disabled) == (False, True)


def test_stop_is_heard(live: LivePlay) -> None:
    until_off(live, told="polarity test and rest", act=live.halt.click)
    assert said(live) == "stopped: the Stop button; the output is off"
    assert live.result is not None and live.result.stopped == "the Stop button"


def test_stop_where_nothing_plays_does_not_promise_to_stop(live: LivePlay) -> None:
    live.stop()
    assert said(live) == "nothing plays"
    until_off(live, "check")
    assert said(live).startswith("done")


def test_keys_stop_it(live: LivePlay) -> None:
    def press() -> None:
        assert live.key.plays
        live.key._handle_custom_msg("stop", [])

    until_off(live, told="output off", act=press)
    assert said(live) == "stopped: Space or Escape; the output is off"
    assert not live.key.plays


def test_a_notebook_that_would_not_hear_stop_ends_the_play(live: LivePlay) -> None:
    until_off(live, told="polarity test and rest", act=lambda: time.sleep(1.2 * UNHEARD_S))
    assert "stopped: for 3 s nobody could have stopped it" in said(live)


def test_a_page_that_is_closed_or_a_cell_that_is_run_anew_ends_the_play(live: LivePlay) -> None:
    until_off(live, is_open=False)
    assert "stopped: for 3 s nobody could have stopped it: the page is closed" in said(live)


def test_who_stops_while_icons_are_judged_is_heard_and_nothing_is_put_out(live: LivePlay, tmp_path: Path) -> None:
    live.fields["folder"].value = str(tmp_path / "monday")
    until_off(live, told="judging", act=live.halt.click)
    assert said(live) == "refused: the Stop button; nothing was put out"
    assert not (tmp_path / "monday").exists()


def test_what_cannot_be_played_is_said_and_puts_nothing_out(live: LivePlay, path: Path) -> None:
    with pytest.raises(InputError, match=r"no notebook that could stop it: use thermicon\.circuit\.play_live"):
        live.play()
    live.fields["folder"].value = str(path.parent)
    until_off(live)
    assert "give a new or empty folder, since a log is never overwritten" in said(live)
    live.fields["folder"].value = ""
    live.device.value = "board"
    until_off(live)
    assert "a port belongs to a board" in said(live)
    with pytest.raises(InputError, match="double is not among the icons"):
        LivePlay("six-icons", order=["double"])
    bench, _ = opened(path)
    bench.text = "cue 1\nicon a { cool by 3 }"
    until_off(bench.live)
    assert "missing unit" in said(bench.live)
    assert not bench.live.on and live.result is None


@pytest.mark.slow
def test_an_icon_is_played_drawn_and_logged(live: LivePlay, tmp_path: Path) -> None:
    live.fields["folder"].value = str(tmp_path / "monday")
    drawn = until_off(live)
    assert said(live).startswith("done")
    assert live.result is not None
    (play,) = live.result.plays
    assert play.rms_K < 0.06
    assert sorted(path.name for path in (tmp_path / "monday").iterdir()) == sorted([*play.files, "rig.toml"])
    assert drawn > 3, "the line grows"
    assert "display, measured" in live.said["figure"].value

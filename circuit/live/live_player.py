"""A guarded player of drives on a device that measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ..play.guard import Guard
from ..play.steps import NOTHING_S
from ..play.watch import Numbers, Refused, Stopped
from .logged_line import LoggedLine
from .play_log import MeasuredPlay, PlayLog
from .ready import ReadyDrive

TICK_S = 0.01
OFF_BEFORE_S = 5.0
"""Logged before anything is put out: a display without power is a steady start that a fit can model."""
SILENT_S = 1.3
"""Of silence the device must have switched off by itself within the second."""


@dataclass(slots=True)
class Proofs:
    """What was shown before the first play: silence in s, fall in K by sensor and the least one, rest in s."""

    silent_s: float = 0.0
    fell_K: Mapping[str, float] = field(default_factory=dict)
    fall_needed_K: float = 0.0
    rest_s: float = 0.0


class LivePlayer:
    """Plays drives on a line by a clock in s, and asks at each tick why it should stop, if it should.

    `tell` gets what begins. Whatever ends a play, the output is off.
    """

    def __init__(
        self,
        line: LoggedLine,
        numbers: Numbers,
        log: PlayLog,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
        why_stop: Callable[[], str] = str,
        tell: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.line, self.numbers, self.log = line, numbers, log
        self.guard = Guard(lambda: numbers, clock, sleep)
        self.proofs = Proofs(fall_needed_K=numbers.test_fall_K if numbers.test_polarity else 0.0)
        self.worst_gap_s = 0.0
        self._clock, self._sleep, self._why_stop, self._tell = clock, sleep, why_stop, tell
        self._ticked_s = clock()

    def prove(self, rest_C: float, *, rests: bool = True) -> None:
        """Show that the device switches off by itself, test the polarity, and rest at a set-point.

        Without `rests` it goes off again after the test. Raises Refused or Stopped.
        """
        self.line.open()
        self._mark("output off")
        self._wait(OFF_BEFORE_S)
        self._mark("silence")
        self.line.test(0.0)
        self._wait(SILENT_S)
        stopped = str(self.line.status().get("stopped") or "")
        if "silent" not in stopped:
            raise Refused(
                f"the device switched off by itself: {stopped}"
                if stopped
                else f"the device did not switch off by itself after {SILENT_S:g} s of silence: set its watchdog to a "
                f"second"
            )
        self.line.open()
        self.proofs.silent_s = SILENT_S
        begun_s = self._clock()
        self._mark("polarity test and rest" if self.numbers.test_polarity else "rest")
        self.guard.begin_rest(self.line, rest_C, (self.line.read, self.line.read_second))
        self._run(lambda: rests or not self._is_tested())
        self.proofs.fell_K = dict(self.guard.fell_K)
        self.proofs.rest_s = self._clock() - begun_s

    def check(self, rest_C: float) -> str:
        """Show what is shown before a first play, and go off again; return why it stopped, empty where it did not."""
        try:
            self.prove(rest_C, rests=False)
        except (Stopped, KeyboardInterrupt) as problem:
            return str(problem) or "Ctrl-C"  # what interrupts has no text
        finally:
            self.off()
        return ""

    def play(self, drive: ReadyDrive, pause_s: float = 0.0) -> None:
        """Play a drive, after a pause at least since the last one; raises Refused or Stopped."""
        until_s = self.guard.ended_s + max(pause_s, self.numbers.pause_s) + 2.0 * NOTHING_S
        self.guard.began_s = math.inf
        while until_s - self._clock() > NOTHING_S:
            self.guard.keep()
            self.guard.wait(min(until_s, self._clock() + TICK_S))
            self._tick()
        self._tell(f"plays {drive.name}")
        sensors = self.line.read, self.line.read_second
        self.guard.begin_play(self.line, drive.rows, drive.rows[0][1], drive.course_C, sensors)
        self._run(lambda: True)
        self._wait(TICK_S)

    def off(self) -> None:
        """Switch off, and log what that did."""
        if self.guard.busy:
            self.guard.abort()
        self.line.off()
        self._mark("output off")
        self._sleep(2.0 * TICK_S)
        self._tick(stops=False)

    def _mark(self, text: str) -> None:
        self.log.mark(text)
        self._tell(text)

    def _is_tested(self) -> bool:
        return bool(self.guard.fell_K) if self.numbers.test_polarity else True

    def _run(self, goes_on: Callable[[], bool]) -> None:
        """Take the guard's steps until its plan has ended, or what comes need not."""
        next_s = self.guard.step(self._clock())
        while self.guard.busy and goes_on():
            self.guard.wait(min(next_s, self._clock() + TICK_S))
            self._tick()
            next_s = self.guard.step(self._clock())

    def _wait(self, seconds: float) -> None:
        """Let time pass without a sign of life."""
        until_s = self._clock() + seconds
        while until_s - self._clock() > NOTHING_S:
            self._sleep(min(until_s - self._clock(), TICK_S))
            self._tick()

    def _tick(self, *, stops: bool = True) -> None:
        now_s = self._clock()
        self.worst_gap_s, self._ticked_s = max(self.worst_gap_s, now_s - self._ticked_s), now_s
        self.log.take(self.line.rows(), now_s)
        why = self._why_stop() if stops else ""
        if why:
            raise Stopped(why)


def play_in_order(
    player: LivePlayer, drives: Sequence[ReadyDrive], pause_s: float, settings: Callable[[], Mapping[str, object]]
) -> tuple[tuple[MeasuredPlay, ...], str]:
    """Prepare, rest and play drives; return what was measured, and why it stopped, empty where it did not.

    Refused where nothing may be played; the output is off in any case.
    """
    why, refused = "", None
    for number, drive in enumerate(drives, 1):
        follows = False
        player.log.open(drive.name)
        try:
            if number == 1:
                player.prove(drive.rows[0][1])
            player.play(drive, pause_s)
            follows = number < len(drives)
        except Refused as problem:
            refused = problem
        except (Stopped, KeyboardInterrupt) as problem:
            why = str(problem) or "Ctrl-C"
        finally:
            if not follows:
                player.off()
        player.log.end(drive, player.guard.began_s, {**settings(), "stopped": why or str(refused or "")})
        if not follows:
            break
    plays = player.log.finish()
    if refused is not None:
        raise refused
    return plays, why

"""A guarded player of drives on a device that measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ..delivery.delivered_drive import ModuleDrive
from ..delivery.formats.form import course_C
from ..play.guard import Guard
from ..play.logged_line import LoggedLine
from ..play.script import COURSE_EVERY_S
from ..play.steps import NOTHING_S
from ..play.watch import Numbers, Refused, Stopped
from .play_log import PlayLog

TICK_S = 0.01
OFF_BEFORE_S = 5.0
"""Logged before anything is put out: a display without power is a steady start that a fit can model."""
SILENT_S = 1.3
"""Of silence the device must have switched off by itself within the second."""


class LivePlayer:
    """Plays drives on a line by a clock in s, and asks at each tick why it should stop, empty where it should not.

    `tell` gets what begins; `proofs` has what was shown before the first play, by name.
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
        self.line, self.log = line, log
        self.guard = Guard(lambda: numbers, clock, self._pass)
        self.pause_s = numbers.pause_s
        self.proofs: dict[str, float] = {}
        self.worst_gap_s = 0.0
        self._clock, self._sleep, self._why_stop, self._tell = clock, sleep, why_stop, tell
        self._sensors = line.read, line.read_second
        self._ticked_s = clock()

    def prepare(self, delivery: ModuleDrive) -> None:
        """Prove that the device switches off by itself, test the polarity, and rest; raises Refused or Stopped."""
        self.line.open()
        self._mark("output off")
        self._pass(OFF_BEFORE_S)
        self._mark("silence")
        self.line.test(0.0)
        self._pass(SILENT_S)
        stopped = str(self.line.status()["stopped"])
        if "silent" not in stopped:
            what = f"switched off by itself: {stopped}" if stopped else "did not switch off; set its watchdog to 1 s"
            raise Refused(f"after {SILENT_S:g} s of silence the device {what}")
        self.proofs["silent_s"] = SILENT_S
        begun_s = self._clock()
        self._mark("polarity test and rest")
        try:
            row = self.line.rest_row(delivery.icon.name, float(delivery.played.command[0]))
            self.guard.rest(self.line, row, self._sensors)
        finally:
            if fell_K := self.guard.fell_K or self.line.fell_K:
                self.proofs["fell_K"] = min(fell_K.values())
        self.proofs["rest_s"] = self._clock() - begun_s

    def play(self, delivery: ModuleDrive, pause_s: float) -> None:
        """Play a drive, after a pause since the last one; raises Refused or Stopped."""
        while self._clock() < self.guard.ended_s + pause_s + NOTHING_S:
            self.guard.keep()
            self.guard.is_answered(TICK_S)  # else simulated time would run away from a computer that is busy
            self._pass(TICK_S)
        self._tell(f"plays {delivery.icon.name}")
        set_points = zip(delivery.played.time_s.tolist(), delivery.played.command.tolist(), strict=True)
        rows = self.line.play_rows(delivery.icon.name, list(set_points))
        rest = self.line.rest_row(delivery.icon.name, float(delivery.played.command[0]))
        course = [(k * COURSE_EVERY_S, at_C) for k, at_C in enumerate(course_C(delivery, COURSE_EVERY_S).tolist())]
        self.guard.began_s = math.inf
        try:
            self.guard.play(self.line, rows, rest, course, self._sensors)
        finally:
            self.log.began(self.line.began_s(self.guard.began_s))
        self._pass(TICK_S)

    def off(self) -> None:
        """Switch off, and log what that did."""
        self.line.off()
        self._mark("output off")
        self._sleep(2.0 * TICK_S)
        self.log.take(self.line.rows(), self._clock())

    def _mark(self, text: str) -> None:
        self.log.mark(text)
        self._tell(text)

    def _pass(self, seconds: float) -> None:
        """Let time pass, log what the device reports meanwhile, and stop where somebody wants that."""
        until_s = self._clock() + seconds
        while (left_s := until_s - self._clock()) > NOTHING_S:
            self._sleep(min(left_s, TICK_S))
            now_s = self._clock()
            self.worst_gap_s = max(self.worst_gap_s, now_s - self._ticked_s)
            self._ticked_s = now_s
            self.log.take(self.line.rows(), now_s)
            why = self._why_stop()
            if why:
                raise Stopped(why)


def play_in_order(player: LivePlayer, drives: Sequence[ModuleDrive], pause_s: float, *, plays: bool = True) -> str:
    """Prepare, and play drives unless not `plays`; return why it stopped, empty where it did not.

    Raises Refused where nothing may be played. The output is off in any case.
    """
    try:
        for number, delivery in enumerate(drives):
            player.log.open(delivery)
            if number == 0:
                player.prepare(delivery)
            if plays:
                player.play(delivery, max(pause_s, player.pause_s))
    except (Stopped, KeyboardInterrupt) as problem:
        return str(problem) or "Ctrl-C"  # what interrupts has no text
    finally:
        player.off()
    return ""

"""The trials of one participant."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .study_answers import ANSWERS, EVENTS, HERE, DurableTable, Row, StudyFiles

if TYPE_CHECKING:
    from .study_bench import Display, Screen
    from .study_simulated import SimulatedScreen

BLOCK, PRACTICE, ANSWERED, ABORTED = 240, 241, 100, 255
"""Markers; an icon has its own from 1, and its answer that plus 100."""
HAND_OFF_S = 5.0


class Stop(Exception):
    """The stop key was pressed; the run ends after the trial."""


class Abort(Exception):
    """The abort key was pressed; the display is off."""


class ParticipantRun:
    """One participant: trials from first to last, with every wait in one place."""

    def __init__(
        self,
        files: StudyFiles,
        who: str,
        screen: Screen | SimulatedScreen,
        display: Display,
        marker: Callable[[int], object],
        given: dict[int, tuple[str, str]],
    ) -> None:
        self.files, self.who, self.screen, self.display, self.marker = files, who, screen, display, marker
        self.study, self.keys = files.study, files.study["keys"]
        self.given = given  # what was presented and answered, by trial
        self.answers = DurableTable(files.answers_file(who), ANSWERS)
        self.name = files.new_run(who)
        self.events = DurableTable(Path(f"{self.name}_events.tsv"), EVENTS)
        self.begun = self.screen.now()
        self.stopping = False
        self.free_s = self.begun

    def tick(self) -> list[str]:
        """Read the keys once, and look after the display; abort and stop act here, whatever is waited for."""
        keys = self.screen.tick()
        if self.keys["abort"] in keys:
            self.display.abort()
            self.marker(ABORTED)
            raise Abort
        self.stopping = self.stopping or self.keys["stop"] in keys
        self.display.keep()  # raises what the guard stopped for
        return keys

    def until(self, condition: Callable[[], bool], text: str) -> None:
        """Show a text until something is so."""
        self.screen.show(text)
        self.tick()
        while not condition():
            self.tick()

    def stop_here(self) -> None:
        """End between two trials where the stop key was pressed."""
        if self.stopping:
            raise Stop

    def wait_for_start(self, text: str) -> None:
        """Show a text until the start key is pressed."""
        self.screen.expect(None, {})
        self.screen.show(f"{text}\n\nPress {self.keys['start']}.")
        while self.keys["start"] not in self.tick():
            self.stop_here()

    def land(self, drive: str, first: bool) -> None:
        """The hand on the display until the skin has settled; before the first play the rest is held meanwhile."""
        self.wait_for_start("Place the hand on the display and keep it there.")
        landed = self.screen.now()
        if first:
            self.display.rest(drive)
        self.until(
            lambda: not self.display.busy and self.screen.now() >= landed + self.study["landing_s"],
            "The skin adapts to the display. Please wait.",
        )

    def trial(self, row: Row) -> str | None:
        """Wait for the gap, play, ask, and write the answer."""
        drive = str(HERE / row["drive_file"]) if row["drive_file"] else None  # None: nothing is played, a catch trial
        if drive:
            self.display.prepare(drive)
        self.until(lambda: not self.display.busy and self.screen.now() >= self.free_s, "+")
        onset, duration = self.screen.now(), float(row["duration_s"])
        code = int(row["marker"])
        self.marker(code)
        if drive:
            self.display.play(drive)
        ask_after_s = float(row.get("ask_after_s", duration))
        self.until(lambda: not self.display.busy and self.screen.now() >= onset + ask_after_s, "+")
        ended = self.screen.now()
        self.free_s = ended + self.study["gap_s"]
        said, at = self.ask(row["icon"], ended)
        if said is not None:
            self.marker(min(ANSWERED + list(self.study["choices"]).index(said) + 1, BLOCK - 1))
        trial = int(row["trial"])
        response = said or self.files.none
        after_s = "" if said is None else f"{at - onset:.3f}"
        self.events.add({
            "onset": f"{onset - self.begun:.3f}", "duration": f"{duration:.3f}", "trial_type": row["icon"],
            "stim_file": row["drive_file"] or "n/a", "block": row["block"], "trial": trial, "response": response,
            "response_time": after_s or "n/a", "marker": code,
        })  # fmt: skip
        if trial:
            self.answers.add({
                "participant": self.who, "trial": trial, "presented": row["icon"], "responded": response,
                "time_s": after_s,
            })  # fmt: skip
            self.given[trial] = row["icon"], said or ""
        return said

    def ask(self, presented: str, ended: float) -> tuple[str | None, float]:
        """What was answered and when; None where no answer came in time."""
        choices = self.study["choices"]
        lines = [f"{choice['key']}   {choice['text']}" for choice in choices.values()]
        self.screen.show("\n".join([self.study["question"], "", *lines]))
        self.screen.expect(presented, {name: choice["key"] for name, choice in choices.items()})
        named = {choice["key"]: name for name, choice in choices.items()}
        while not self.study["answer_s"] or self.screen.now() < ended + self.study["answer_s"]:
            for key in self.tick():
                if key in named:
                    return named[key], self.screen.now()
        return None, math.nan

    def block(self, number: int, last: int | None, drive: str) -> None:
        """A break before every block but the first, and the landing of the hand; after practice it stays there."""
        self.display.log_into(Path(f"{self.name}_block-{number}_log.csv"))
        if last == 0:
            self.wait_for_start("Practice is over. Keep the hand on the display.")
            self.marker(BLOCK)
            return
        if last is not None:
            begun = self.screen.now()
            self.until(
                lambda: self.screen.now() >= begun + self.study["break_s"], "A break. Take the hand off the display."
            )
        self.marker(BLOCK if number else PRACTICE)
        self.land(drive, last is None)

    def go(self, rows: Sequence[Row]) -> None:
        """All trials in order."""
        last: int | None = None
        for row in rows:
            self.stop_here()
            block = int(row["block"])
            if block != last:
                self.block(block, last, str(HERE / row["drive_file"]))
                last = block
            self.trial(row)

    def finish(self) -> None:
        """The hand off first: without current the display does not stay at its baseline."""
        ended = self.screen.now()
        self.until(lambda: self.screen.now() >= ended + HAND_OFF_S, "Take the hand off the display.")
        self.display.switch_off()

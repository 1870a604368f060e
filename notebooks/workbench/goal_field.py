"""The goal of a set, as a line to type into: read by the grammar of ``--goal``, judged with each ranking."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import ipywidgets as widgets

from ..report.blocks import Text, shown
from .view_blocks import verdict_html

if TYPE_CHECKING:
    from thermicon.perception.selection.goal import Goal
    from thermicon.perception.selection.goal_result import GoalResult

PATTERNS = (
    "correct >= 90 % for 95 % of people, safety green",
    "correct >= 85 %, detected >= 95 %, time <= 60 s",
    "bits >= 2, onset <= 1.5 s",
    "count 6, energy <= 50 J",
)
"""Goals that are offered to begin with, and show what a goal is made of."""
FOR_DRAWS = "judged after refining: a share of people takes draws of the model too"
WITHOUT_DRAWS = (
    "not judged: a share of people takes draws of the model too, and this observer has none; give an observer with "
    "draws, such as the table (.csv) that pilot --keep writes"
)
HELP = (
    "parts joined by commas: correct, detected, bits, d_prime, time, energy, onset or count with a comparison and a "
    "number, such as 'time <= 10 s'; 'safety green'; 'for 95 % of people' after correct, detected or bits"
)


class GoalField:
    """A goal as it is typed: ``goal`` is the one that was read last, None for none; ``box`` holds its widgets.

    ``changed`` is called after each new goal. A text that cannot be read is kept, with what is wrong with it below,
    and nothing is judged by it.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self.goal: Goal | None = None
        self.text = widgets.Combobox(
            placeholder=PATTERNS[0],
            options=PATTERNS,
            description="goal",
            continuous_update=False,
            layout={"width": "100%", "max_width": "466px"},
        )
        self.text.style.description_width = "auto"
        self.text.tooltip = HELP
        self.said, self.verdict = widgets.HTML(), widgets.HTML()
        self.text.observe(lambda change: self._read(change["new"]), "value")
        self.box = widgets.VBox([self.text, self.said, self.verdict]).add_class("thermicon-goal")

    def show(self, reached: GoalResult | None, refined: bool = False) -> None:
        """Show how far the goal is reached by the ranking on the page; None: it was not judged.

        ``refined`` says that no ranking follows that could judge it.
        """
        if self.goal is None:
            self.verdict.value = ""
        elif reached is not None and reached.goal == self.goal:
            self.verdict.value = verdict_html(reached)
        else:
            waits = WITHOUT_DRAWS if refined else FOR_DRAWS if self.goal.single_people else "not judged yet"
            self.verdict.value = shown(Text(f"{self.goal.text}: {waits}", "soft"))

    def _read(self, typed: str) -> None:
        from thermicon.perception.selection.goal import Goal, GoalError

        try:
            self.goal = Goal.parse(typed) if typed.strip() else None
            self.said.value = ""
        except GoalError as wrong:
            self.goal = None
            self.said.value = shown(Text(str(wrong), "note th-bad"))
        self.show(None)
        self._changed()

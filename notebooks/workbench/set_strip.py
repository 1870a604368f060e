"""The strip beside the badge of the design view: identification of the set in a few numbers.

A rough ranking comes first, then one as of the set view. Nothing is computed while a corner is dragged.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

from thermicon.base.words.number_text import percent
from thermicon.perception import Goal, Ranking, rank
from thermicon.perception.ranking.rank import with_intervals
from thermicon.perception.selection.goal_result import judge_goal

from ..editing.cue_check import read_text
from .design_model import DesignModel
from .live_view import BackgroundJob, LiveView
from .set_model import QUICK, WELL, SetRequest, draws_of, why_not


class SetStrip(LiveView[SetRequest]):
    """The set of one ``DesignModel`` in a few numbers, ranked while the design view is ``shown``.

    ``send`` takes a message to the page, which is sent only where something has changed.
    """

    settles_s = 0.1

    def __init__(self, design: DesignModel, send: Callable[[dict[str, Any]], None]) -> None:
        super().__init__(design)
        self._send = send
        self.ranking: Ranking | None = None
        self._source: SetRequest | None = None
        self._pinned: tuple[SetRequest, Ranking] | None = None
        self._sent: dict[str, Any] = {}
        self._why = ""
        self._met: bool | None = None
        self._binding = ""

    def renew(self, after_s: float | None = None) -> None:
        """Rank anew if the set has changed, and say what is known until then."""
        super().renew(after_s)
        self.tell()

    def known(self, request: SetRequest) -> Ranking | None:
        """The ranking of a request with as many people as the set view has; None where there is none yet."""
        whole = self.ranking is not None and self.ranking.people == WELL[0]
        return self.ranking if whole and self._source == request else None

    def tell(self, anew: bool = False) -> None:
        """Send what the strip says; ``anew``: to a page that has just been opened too."""
        said = self._said()
        if anew or said != self._sent:
            self._sent = said
            self._send(said)

    def _said(self) -> dict[str, Any]:
        ranking, goal = self.ranking, self.design.document.goal
        whole = icon = felt = "–"
        if ranking is not None:
            whole = whole if len(ranking.icons) < 2 else percent(ranking.felt_and_named)
            for each in ranking.icons:
                if each.name == self.design.scene.icon:
                    icon = icon if len(ranking.icons) < 2 else percent(each.felt_and_named)
                    felt = percent(each.detected_probability)
        stale = self._source != self._request()
        people = 0 if ranking is None else ranking.people
        about = self._why if stale and self._why else f"predicted for {people} virtual people" if people else ""
        numbers = {"set": whole, "icon": icon, "felt": felt, "goal": goal, "met": self._met, "binding": self._binding}
        sides = []
        if (pinned := self.design.pinned) is not None:
            sides = [pinned.row("pinned", self.pinned), self.design.version.row("now", ranking, stale)]
            if pinned.document is not self.design.document:
                sides[0]["what"] += f" ({pinned.document.name})"
        return {"type": "strip", **numbers, "stale": stale, "rough": people < WELL[0], "about": about, "sides": sides}

    @property
    def pinned(self) -> Ranking | None:
        """The ranking of the pinned version's set; None where there is none yet."""
        if (pinned := self.design.pinned) is None:
            return None
        known = self._pinned is not None and self._pinned[0] == pinned.request
        if self._source == pinned.request and self.ranking is not None and (self.known(pinned.request) or not known):
            self._pinned = pinned.request, self.ranking
        return self._pinned[1] if self._pinned is not None and self._pinned[0] == pinned.request else None

    def _request(self) -> SetRequest:
        return self.design.text, self.design.rig

    def _obstacle(self, request: SetRequest) -> str | None:
        return why_not(read_text(request[0]))

    def _job(self, request: SetRequest) -> Callable[[BackgroundJob], None]:
        self._why = ""
        return lambda job: self._rank(job, request)

    def _rank(self, job: BackgroundJob, request: SetRequest) -> None:
        """The background job, on one core: the other one draws."""
        text, rig = request
        while self.design.dragging:
            job.go_on()
            time.sleep(0.03)
        icons, model, goal = read_text(text).icons, self.design.model, self.design.document.goal
        assert icons is not None
        for people, _ in (QUICK, WELL):
            made = rank(icons, rig, people=people, parameters=0, observer=model, workers=1, progress=job.go_on)
            job.on_page(partial(self._take, made, request))
        if goal and any(part.people for part in Goal.parse(goal).parts):
            job.on_page(partial(self._take, with_intervals(made, draws_of(model), job.go_on), request))
        job.on_page(partial(self._finish, request))
        if (pinned := self.design.pinned) is not None and self.pinned is None:  # it was changed before it was ranked
            before, rig = read_text(pinned.scene.text), pinned.scene.rig
            if before.icons is not None and why_not(before) is None:
                made = rank(
                    before.icons, rig, people=people, parameters=0, observer=model, workers=1, progress=job.go_on
                )
                job.on_page(partial(self._take_pinned, made, pinned.request))

    def _take_pinned(self, made: Ranking, request: SetRequest) -> None:
        self._pinned = request, made
        self.tell()

    def _take(self, made: Ranking, request: SetRequest) -> None:
        """Show a ranking, and whether it meets the goal, which is part of its text."""
        self.ranking, self._source, self._met, self._binding = made, request, None, ""
        try:
            if goal := self.design.document.goal:
                found = judge_goal(goal, made)
                self._met, self._binding = found.met, "; ".join(found.binding)
        except ValueError as wrong:  # no goal, or one that waits for the draws of the last ranking
            self._binding = str(wrong)
        self.tell()

    def _finish(self, request: SetRequest) -> None:
        self._running, self._finished, self._failed_request = None, request, None

    def _say(self, text: str, kind: str = "") -> None:
        self._why = text
        self.tell()

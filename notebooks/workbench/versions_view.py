"""The versions view: a version kept as A beside what is in the editor, B, with what differs between them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import ipywidgets as widgets

from ..report.blocks import fragment
from .background import Job
from .design_view import SideCanvas
from .downloads import link
from .live_view import LiveView
from .versions_model import RankedVersions, Version, both_frame, changed_lines, rank_versions
from .versions_tables import changes_html, results_html

if TYPE_CHECKING:
    from thermicon.perception.selection.goal import Goal

    from ..timeline.frames import CanvasFrame
    from .design_model import DesignModel

Request = tuple[Version, Version, "Goal | None"]
NOTHING = (
    "Keep the set as it is now as version A, and go on editing: the editor holds version B, and both are shown here."
)
SHARES = 10


class VersionsView(LiveView[Request]):
    """Versions of one ``DesignModel``, compared while the tab is ``shown``; ``box`` holds the widgets.

    ``take`` puts a version into the editor, with its rig; ``goal`` says which goal both are judged by; ``keeps`` gets
    every new version A, None for none, so that it outlives the kernel.
    """

    settles_s = 0.25

    def __init__(
        self,
        design: DesignModel,
        take: Callable[[Version], None],
        goal: Callable[[], Goal | None],
        keeps: Callable[[Version | None], None] = lambda version: None,
    ) -> None:
        super().__init__(design)
        self._take, self._goal, self._keeps = take, goal, keeps
        self.kept: Version | None = None
        self._known: dict[Any, Any] = {}
        self._result = False
        self._people = ""
        self._build()

    def _build(self) -> None:
        self.said = {name: widgets.HTML() for name in ("status", "about", "results", "changes", "download")}
        self.keep = self._button("Keep this as A", "what is in the editor becomes version A", self.keep_now)
        self.swap = self._button("Swap A and B", "A goes into the editor, and what is there becomes A", self.swap_both)
        self.discard = self._button("Discard A", "drop version A", self.drop)
        self.curves = SideCanvas("traces")
        said = self.said
        top = widgets.Box([self.keep, self.swap, self.discard, said["download"], said["status"]])
        side = {"flex": "3 1 430px", "min_width": "0"}
        changed = widgets.VBox([widgets.HTML(fragment("block", "changed lines", "th-head")), said["changes"]])
        drawn = widgets.VBox([self.curves, changed], layout=side)
        results = widgets.VBox([said["results"]], layout=side)
        self.body = widgets.Box([drawn, results]).add_class("thermicon-row")
        self.box = widgets.VBox([top.add_class("thermicon-row"), said["about"], self.body])
        self.box.add_class("thermicon-versions")
        self._show_kept()

    @property
    def now(self) -> Version:
        """What is in the editor."""
        design = self.design
        values, model = dict(design.values), design.model
        return Version(design.text, design.scene.icon, design.nominal, design.rig, design.observer, values, model)

    def keep_now(self) -> None:
        """Keep what is in the editor as version A."""
        self.restore(self.now)

    def restore(self, version: Version) -> None:
        """Take a version as version A."""
        self.kept = version
        self._keeps(version)
        self._show_kept()
        self.renew(0.0)

    def swap_both(self) -> None:
        """Put version A into the editor, as a step that can be undone; what is there becomes A."""
        if self.kept is None:
            raise ValueError("there is no version A yet: keep one first")
        before, self.kept = self.kept, self.now
        self._keeps(self.kept)
        self._take(before)
        self._show_kept()
        self.renew(0.0)

    def drop(self) -> None:
        """Drop version A."""
        self.kept = None
        self._keeps(None)
        self._stop()
        self._known.clear()
        self._show_kept()

    def _show_kept(self) -> None:
        kept = self.kept
        self.swap.disabled = self.discard.disabled = kept is None
        self.body.layout.display = "none" if kept is None else ""
        self._finished, self._result = None, False
        if kept is None:
            self.said["about"].value = fragment("block", NOTHING, "th-soft")
            self.said["download"].value = ""
            self._say("")
            return
        name = f"{Path(kept.icon or 'icons').stem}-version-A.cue"
        self.said["download"].value = link(name, kept.text.encode())
        about = f"A (solid): {kept.rig_words} · B (dashed): what is in the editor"
        self.said["about"].value = fragment("block", about, "th-soft")

    def _request(self) -> Request:
        now = self.now
        return (now if self.kept is None else self.kept), now, self._goal()

    def _has_result(self) -> bool:
        return self._result

    def _obstacle(self, request: Request) -> str | None:
        return "" if self.kept is None else None

    def _job(self, request: Request) -> Callable[[Job], None]:
        self._say("comparing …")
        return lambda job: self._compare(job, request)

    def _show_finished(self) -> None:
        self._say(self._people)

    def _stale_parts(self) -> tuple[widgets.Widget, ...]:
        return (self.body,)

    def _compare(self, job: Job, request: Request) -> None:
        """The background job: curves and changed lines at once, then both rankings."""
        a, b, goal = request
        frame, changes = both_frame(a, b), changed_lines(a, b)
        job.on_page(lambda: self._show_curves(frame, changes))
        reported = [-1]

        def progress(done: int, total: int) -> None:
            job.go_on()
            share = SHARES * done // max(total, 1)
            if share != reported[0]:
                reported[0] = share
                job.on_page(lambda: self._say(f"ranking … {100 * share // SHARES} %"))

        both = rank_versions(a, b, goal, self._known, progress)
        job.on_page(lambda: self._show(both, request))

    def _show_curves(self, frame: CanvasFrame, changes: list[tuple[str, str]]) -> None:
        self._finished = None  # the results on the page are those of an earlier request
        self.curves.frame(frame.meta, frame.buffers)
        self.said["changes"].value = changes_html(changes)

    def _show(self, both: RankedVersions, request: Request) -> None:
        self._running, self._finished, self._failed_request, self._result = None, request, None, True
        self._mark(False)
        self.said["results"].value = results_html(both)
        people = [each.people for each in (both.a, both.b) if each is not None]
        self._people = f"predicted for the same {people[0]} people" if people else ""
        self._say(self._people)

    def _button(self, name: str, hint: str, act: Callable[[], None]) -> widgets.Button:
        made = widgets.Button(description=name, tooltip=hint, layout={"width": "auto"})
        made.on_click(lambda _: self._safely(act))
        return made

"""Views through undo and errors: they show what was asked for last."""

from __future__ import annotations

import re
from collections.abc import Callable
from threading import Event

import ipywidgets as widgets

from thermicon.circuit import Rig
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.live_view import Job, LiveView

TEXT = (
    "cue 1\n"
    "icon near { warm by 4 °C at 2 °C/s; return at 2 °C/s }\n"
    "icon far { cool by 4 °C at 2 °C/s; return at 2 °C/s }\n"
)


class Lengths(LiveView[str]):
    """Shows how long the text is, except for texts that it fails on or refuses."""

    settles_s = 0.0

    def __init__(self, design: DesignModel) -> None:
        super().__init__(design)
        self.said = {"status": widgets.HTML()}
        self.shown_text: str | None = None
        self.shown = True
        self.go = Event()
        design.on_change(self.renew)

    def _request(self) -> str:
        return self.design.text

    def _obstacle(self, request: str) -> str | None:
        return "refused" if "# refuse" in request else None

    def _job(self, request: str) -> Callable[[Job], None]:
        self._say("working")
        return lambda job: self._count(job, request)

    def _count(self, job: Job, request: str) -> None:
        if "# fail" in request:
            raise ValueError("it failed")
        assert self.go.wait(20)
        job.on_page(lambda: self._show(request))

    def _show(self, request: str) -> None:
        self.shown_text, self._running, self._finished = request, None, request
        self._show_finished()

    def _show_finished(self) -> None:
        self._say("done")

    def _stale_parts(self) -> tuple[widgets.Widget, ...]:
        return (self.said["status"],)

    @property
    def words(self) -> str:
        return re.sub("<[^>]*>", "", self.said["status"].value)


def test_a_request_that_failed_says_so_again_and_ends_the_work_on_the_one_after_it() -> None:
    design = DesignModel(TEXT, Rig.load("thenar"))
    view = Lengths(design)
    for after, words in (("# refuse", "refused"), ("# slow", "working")):
        design.show_text(TEXT + "# fail")
        assert view.worker.wait()
        assert view.words == "it failed"
        design.show_text(TEXT + after)
        assert view.words == words
        design.receive({"type": "undo"})
        assert view.words == "it failed"
    view.go.set()
    assert view.worker.wait()
    assert (view.words, view.shown_text) == ("it failed", None)

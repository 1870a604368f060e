"""A tab whose content follows the design: computed in the background while the tab is shown."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, TypeVar

import ipywidgets as widgets

from ..report.blocks import fragment
from .background import BackgroundWorker, Job
from .design_model import DesignModel

Request = TypeVar("Request")


class LiveView(ABC, Generic[Request]):
    """One request at a time: new ones replace old ones, and results of an older request are marked as stale.

    ``shown`` says whether the tab is visible; ``box`` holds its widgets, ``said`` its pieces of HTML by name.
    """

    settles_s: float
    status_style = ""

    def __init__(self, design: DesignModel) -> None:
        self.design = design
        self.shown = False
        self.said: dict[str, widgets.HTML] = {}
        self.box: widgets.VBox
        self.worker = BackgroundWorker(self._failed)
        self._running: Request | None = None
        self._finished: Request | None = None
        self._failed_request: Request | None = None
        self._failure = ""

    def renew(self, after_s: float | None = None) -> None:
        """Compute the content anew if the tab is shown and the request has changed.

        The job waits for ``after_s`` seconds (default: ``settles_s``), in which the text may change further.
        """
        request = self._request()
        if not self.shown:
            self._stop()  # the design view needs the processor
            return
        if request == self._running:
            return
        if request == self._failed_request:
            self._stop()
            self._mark_outdated(request)
            self._show_failure()
            return
        if request == self._finished:
            self._stop()
            self._mark(False)
            self._show_finished()
            return
        self._mark_outdated(request)
        if (reason := self._obstacle(request)) is not None:
            self._stop()
            self._say(reason, "th-caution")
            return
        self._running = request
        job = self._job(request)
        self.worker.ask(job, self.settles_s if after_s is None else after_s)

    @abstractmethod
    def _request(self) -> Request:
        """What is to be computed now."""

    @abstractmethod
    def _obstacle(self, request: Request) -> str | None:
        """Why a request cannot be computed; None where it can."""

    @abstractmethod
    def _job(self, request: Request) -> Callable[[Job], None]:
        """Announce the request on the page and return the work of the background thread."""

    @abstractmethod
    def _show_finished(self) -> None:
        """Say that the result on the page is that of the request."""

    @abstractmethod
    def _stale_parts(self) -> tuple[widgets.Widget, ...]:
        """Widgets that are marked while their content is out of date."""

    def _mark_outdated(self, request: Request) -> None:
        self._mark(self._finished is not None)

    def _stop(self) -> None:
        self.worker.forget()
        self._running = None

    def _failed(self, message: str) -> None:
        """A job failed; the same request is not tried again, since it would fail in the same way."""
        self._running, self._failed_request, self._failure = None, self._request(), message
        self._show_failure()

    def _show_failure(self) -> None:
        self._say(self._failure, "th-caution")

    def _mark(self, stale: bool) -> None:
        for part in self._stale_parts():
            (part.add_class if stale else part.remove_class)("thermicon-stale")

    def _say(self, text: str, kind: str = "th-status") -> None:
        self.said["status"].value = fragment("marked", text, f"{kind} {self.status_style}".strip())

    def _safely(self, act: Callable[[], None]) -> None:
        try:
            act()
        except Exception as wrong:  # a message is better than a page that goes silent
            self._say(f"the action failed: {wrong or type(wrong).__name__}", "th-caution")

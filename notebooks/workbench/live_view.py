"""A tab that follows the design by computing in the background while it is shown.

The newest job wins, and results are shown on the kernel's event loop.
"""

from __future__ import annotations

import asyncio
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from threading import Lock, Thread
from typing import Any, Generic, TypeVar

import ipywidgets as widgets

from ..report.blocks import fragment
from .design_model import ONE_AT_A_TIME, DesignModel

Request = TypeVar("Request")
Act = Callable[[], None]


class Superseded(Exception):
    """A newer job was requested, so this one ends without a message."""


class BackgroundJob:
    """Handle of a running job: whether it is still the newest, and how it changes the page."""

    def __init__(self, owner: BackgroundWorker, number: int, loop: asyncio.AbstractEventLoop | None) -> None:
        self._owner, self._number, self._loop = owner, number, loop

    @property
    def newest(self) -> bool:
        """Whether no newer job was requested."""
        return self._owner.number == self._number

    def go_on(self, *progress: int) -> None:
        """Raise Superseded if there is a newer job; can be used as a progress callback."""
        if not self.newest:
            raise Superseded

    def on_page(self, act: Act) -> None:
        """Change the page, if this job is still the newest; raises Superseded otherwise."""
        self.go_on()
        if self._loop is None:
            safely(act, self._owner.fail)
        else:
            # Widgets belong to the kernel's thread: a handler there must never see half of a change.
            self._loop.call_soon_threadsafe(lambda: safely(act, self._owner.fail) if self.newest else None)


Work = Callable[[BackgroundJob], None]


class BackgroundWorker:
    """Runs jobs in a thread; a new job makes all earlier ones stale.

    ``fail`` is called with a message when a job, or its change of the page, raises an error.
    """

    def __init__(self, fail: Callable[[str], None] = lambda message: None) -> None:
        self.number = 0
        self.fail = fail
        self._one = Lock()
        self.threads: list[Thread] = []

    def ask(self, work: Work, after_s: float = 0.0) -> None:
        """Start a job after a delay in s, during which a newer one may replace it."""
        self.number += 1
        try:
            loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            loop = None  # plain Python: there is no event loop of a page
        job = BackgroundJob(self, self.number, loop)
        thread = Thread(target=self._run, args=(job, work, after_s), name="thermicon work", daemon=True)
        self.threads = [each for each in self.threads if each.is_alive()] + [thread]
        thread.start()

    def forget(self) -> None:
        """Make the running job stale without starting a new one."""
        self.number += 1

    def _run(self, job: BackgroundJob, work: Work, after_s: float) -> None:
        until = time.monotonic() + after_s
        while job.newest and (left := until - time.monotonic()) > 0:
            time.sleep(min(left, 0.05))
        with self._one, suppress(Superseded):
            try:
                job.go_on()
                work(job)
            except Superseded:
                return
            except Exception as wrong:
                message = str(wrong) or type(wrong).__name__
                job.on_page(lambda: self.fail(message))


class LiveView(ABC, Generic[Request]):
    """One request at a time: new ones replace old ones, and results of an older request are marked as stale.

    ``shown`` says whether the tab is visible; ``box`` holds its widgets, ``said`` its pieces of HTML by name,
    ``stale_parts`` what is marked while it is out of date.
    """

    settles_s: float
    status_style = ""

    def __init__(self, design: DesignModel) -> None:
        self.design = design
        self.shown = False
        self.said: dict[str, widgets.HTML] = {}
        self.box: widgets.VBox
        self.stale_parts: tuple[widgets.Widget, ...] = ()
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
        if self.shown and request == self._running:
            return
        self.worker.forget()  # of a tab that is not shown too: the design view needs the processor
        self._running = None
        if not self.shown:
            return
        if request == self._failed_request:
            self._mark_outdated(request)
            self._show_failure()
        elif request == self._finished:
            self._mark(False)
            self._show_finished()
        elif (reason := self._obstacle(request)) is not None:
            self._mark_outdated(request)
            self._say(reason, "th-caution")
        else:
            self._mark_outdated(request)
            self._running = request
            self.worker.ask(self._job(request), self.settles_s if after_s is None else after_s)

    @abstractmethod
    def _request(self) -> Request:
        """The next computation."""

    @abstractmethod
    def _obstacle(self, request: Request) -> str | None:
        """Why a request cannot be computed; None where it can."""

    @abstractmethod
    def _job(self, request: Request) -> Work:
        """Announce the request on the page and return the work of the background thread."""

    def _show_finished(self) -> None:
        """Say that the result on the page is that of the request."""

    def _mark_outdated(self, request: Request) -> None:
        self._mark(self._finished is not None)

    def _failed(self, message: str) -> None:
        """A job failed; the same request is not tried again, since it would fail in the same way."""
        self._running, self._failed_request, self._failure = None, self._request(), message
        self._show_failure()

    def _show_failure(self) -> None:
        self._say(self._failure, "th-caution")

    def _mark(self, stale: bool) -> None:
        for part in self.stale_parts:
            (part.add_class if stale else part.remove_class)("thermicon-stale")

    def _say(self, text: str, kind: str = "th-status") -> None:
        self.said["status"].value = fragment("marked", text, f"{kind} {self.status_style}".strip())

    def _safely(self, act: Act) -> None:
        safely(act, lambda wrong: self._say(f"the action failed: {wrong}", "th-caution"))


def safely(act: Act, say: Callable[[str], None]) -> None:
    """Do a step of the page; a message is better than a page that goes silent, since nobody reads the kernel's log."""
    with ONE_AT_A_TIME:
        try:
            act()
        except Exception as wrong:
            say(str(wrong) or type(wrong).__name__)


def button(name: str, hint: str, act: Act, **more: Any) -> widgets.Button:
    """A button as wide as its name, with a tooltip, that calls ``act``."""
    made = widgets.Button(description=name, tooltip=hint, layout={"width": "auto"}, **more)
    made.on_click(lambda _: act())
    return made

"""Slow work in the background: one job at a time, the newest wins, and results are shown on the kernel's event loop."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress
from threading import Lock, Thread

Work = Callable[["Job"], None]
Act = Callable[[], None]


class Superseded(Exception):
    """A newer job was requested, so this one ends without a message."""


class Job:
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
            self._owner.safely(act)
        else:
            # Widgets belong to the kernel's thread: a handler there must never see half of a change.
            self._loop.call_soon_threadsafe(lambda: self._owner.safely(act) if self.newest else None)


class BackgroundWorker:
    """Runs jobs in a thread; a new job makes all earlier ones stale.

    ``fail`` is called with a message when a job, or its change of the page, raises an error.

    >>> done = []
    >>> worker = BackgroundWorker()
    >>> worker.ask(lambda job: job.on_page(lambda: done.append("job")))
    >>> worker.wait()
    True
    >>> done
    ['job']
    """

    def __init__(self, fail: Callable[[str], None] | None = None) -> None:
        self.number = 0
        self._fail = fail
        self._one = Lock()
        self._threads: list[Thread] = []

    def ask(self, work: Work, after_s: float = 0.0) -> None:
        """Start a job after a delay in s, during which a newer one may replace it."""
        self.number += 1
        try:
            loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            loop = None  # plain Python: there is no event loop of a page
        job = Job(self, self.number, loop)
        thread = Thread(target=self._run, args=(job, work, after_s), name="thermicon work", daemon=True)
        self._threads = [each for each in self._threads if each.is_alive()] + [thread]
        thread.start()

    def forget(self) -> None:
        """Make the running job stale without starting a new one."""
        self.number += 1

    @property
    def busy(self) -> bool:
        """Whether a job is running or waiting."""
        return any(thread.is_alive() for thread in self._threads)

    def wait(self, timeout_s: float = 60.0) -> bool:
        """Wait until all jobs have ended; False after the timeout in s. Not for handlers of the page."""
        until = time.monotonic() + timeout_s
        for thread in tuple(self._threads):
            thread.join(max(0.0, until - time.monotonic()))
        return not self.busy

    def _run(self, job: Job, work: Work, after_s: float) -> None:
        until = time.monotonic() + after_s
        while job.newest and (left := until - time.monotonic()) > 0:
            time.sleep(min(left, 0.05))
        with self._one:
            try:
                job.go_on()
                work(job)
            except Superseded:
                return
            except Exception as wrong:
                with suppress(Superseded):
                    message = str(wrong) or type(wrong).__name__
                    job.on_page(lambda: self._failed(message))

    def safely(self, act: Act) -> None:
        """Change the page and show errors there, since nobody reads the kernel's log."""
        try:
            act()
        except Exception as wrong:
            self._failed(str(wrong) or type(wrong).__name__)

    def _failed(self, message: str) -> None:
        if self._fail is not None:
            self._fail(message)

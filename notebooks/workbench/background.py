"""Slow work beside the page: one job at a time, the newest wins, and what it finds is shown on the kernel's loop."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress
from threading import Lock, Thread

Work = Callable[["Turn"], None]
Act = Callable[[], None]


class Superseded(Exception):
    """A newer job was asked for, so this one ends; nobody is told."""


class Turn:
    """What a job holds in its hands: whether it is still the newest, and the way back to the page."""

    def __init__(self, owner: Newest, number: int, loop: asyncio.AbstractEventLoop | None) -> None:
        self._owner, self._number, self._loop = owner, number, loop

    @property
    def newest(self) -> bool:
        """Whether no newer job was asked for."""
        return self._owner.number == self._number

    def go_on(self, *progress: int) -> None:
        """Raise Superseded where there is a newer job; takes what progress functions are called with."""
        if not self.newest:
            raise Superseded

    def tell(self, act: Act) -> None:
        """Do something on the page, if this job is the newest still; raises Superseded where it is not."""
        self.go_on()
        if self._loop is None:
            self._owner.safely(act)
        else:
            # Widgets belong to the kernel's thread: a handler there must never see half of a change.
            self._loop.call_soon_threadsafe(lambda: self._owner.safely(act) if self.newest else None)


class Newest:
    """Does jobs in a thread of their own; a job that is asked for makes all before it stale.

    ``fail`` is told in words what went wrong in a job, or in what it did on the page.

    >>> done = []
    >>> worker = Newest()
    >>> worker.ask(lambda turn: turn.tell(lambda: done.append("job")))
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
        """Start a job, after a time (s) in which a newer one may take its place."""
        self.number += 1
        try:
            loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            loop = None  # plain Python: there is no page that could be disturbed
        turn = Turn(self, self.number, loop)
        thread = Thread(target=self._run, args=(turn, work, after_s), name="thermicon work", daemon=True)
        self._threads = [each for each in self._threads if each.is_alive()] + [thread]
        thread.start()

    def forget(self) -> None:
        """Make the job that is running stale, without a new one."""
        self.number += 1

    @property
    def busy(self) -> bool:
        """Whether a job is being done or waits."""
        return any(thread.is_alive() for thread in self._threads)

    def wait(self, timeout_s: float = 60.0) -> bool:
        """Wait until all jobs have ended; False when the time (s) is over before. Not for handlers of the page."""
        until = time.monotonic() + timeout_s
        for thread in tuple(self._threads):
            thread.join(max(0.0, until - time.monotonic()))
        return not self.busy

    def _run(self, turn: Turn, work: Work, after_s: float) -> None:
        until = time.monotonic() + after_s
        while turn.newest and (left := until - time.monotonic()) > 0:
            time.sleep(min(left, 0.05))
        with self._one:
            try:
                turn.go_on()
                work(turn)
            except Superseded:
                return
            except Exception as wrong:
                with suppress(Superseded):
                    said = str(wrong) or type(wrong).__name__
                    turn.tell(lambda: self._failed(said))

    def safely(self, act: Act) -> None:
        """Do something on the page; what goes wrong is told there, since nobody reads a kernel's log."""
        try:
            act()
        except Exception as wrong:
            self._failed(str(wrong) or type(wrong).__name__)

    def _failed(self, said: str) -> None:
        if self._fail is not None:
            self._fail(said)

"""Unsaved text, kept beside the file it belongs to while somebody types, and offered when the file is opened again.

A version A that the text is compared with is kept with it.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Lock, Timer

from thermicon.icons.files.input_files import NotRegular, TooLarge, read_limited

from .cue_document import MOST_BYTES
from .kept_draft import KeptVersion, draft_text, read_draft
from .outputs import OutputError, complete_or_absent

SUFFIX = "unsaved"
EVERY_S = 0.5
"""Shortest time between two writings, in s; what is typed last is lost by a killed process for this long."""
KEPT_S = 30 * 86_400.0
"""Time after which an unsaved text of a process that is gone is removed, in s."""

MOST_DRAFT_BYTES = 4 * MOST_BYTES
"""Two texts, escaped as JSON."""

_COUNT = itertools.count()


@dataclass(frozen=True, slots=True)
class Unsaved:
    """What was not saved: where it is kept, since when (s since 1970), and whether its process still runs.

    ``text`` is None where only a version A was kept, ``version`` is None without one.
    """

    path: Path
    text: str | None
    since_s: float
    alive: bool
    version: KeptVersion | None = None

    @property
    def age(self) -> str:
        """How long ago it was kept, in words."""
        minutes = max(0.0, time.time() - self.since_s) / 60
        if minutes < 1.5:
            return "a moment ago"
        if minutes < 90:
            return f"{minutes:.0f} minutes ago"
        return time.strftime("on %d %B at %H:%M", time.localtime(self.since_s))


class Autosave:
    """Keeps the newest text of one editor beside a file, under a hidden name of this process.

    ``failed`` says why the newest text could not be kept, None while it is.
    """

    def __init__(self, place: Path) -> None:
        self.place = place
        self.path = place.with_name(f".{place.name}.{os.getpid()}-{next(_COUNT)}.{SUFFIX}")
        self.failed: str | None = None
        self._text: str | None = None
        self._last_s = -EVERY_S
        self._timer: Timer | None = None
        self._lock = Lock()

    def keep(self, text: str, version: KeptVersion | None = None) -> None:
        """Keep a text, and a version A beside it, at once or within half a second."""
        with self._lock:
            self._text = draft_text(text, version)
            if self._timer is not None:
                return
            wait_s = self._last_s + EVERY_S - time.monotonic()
            if wait_s <= 0:
                self._write()
                return
            self._timer = Timer(wait_s, self._late)
            self._timer.daemon = True
            self._timer.start()

    def forget(self) -> None:
        """Remove what is kept: it was saved, or is as it was."""
        with self._lock:
            self._text = None
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            with contextlib.suppress(OSError):
                self.path.unlink()
            self.failed = None

    def _late(self) -> None:
        with self._lock:
            self._timer = None
            self._write()

    def _write(self) -> None:
        if self._text is None:
            return
        try:
            with complete_or_absent(self.path) as draft:
                draft.write_text(self._text, encoding="utf-8", newline="")
            self.failed = None
        except (OutputError, OSError) as wrong:
            self.failed = str(wrong)
        self._last_s = time.monotonic()


def unsaved_texts(place: Path, text: str, own: Path | None = None) -> list[Unsaved]:
    """What other editors never saved to a file: texts that differ from its ``text``, and versions A; the newest first.

    What equals the text, or is older than 30 days, is removed where its process is gone.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     place = Path(folder) / "a.cue"
    ...     Autosave(place).keep("cue 1 # typed")
    ...     [each.text for each in unsaved_texts(place, "cue 1")]
    ['cue 1 # typed']
    """
    found = []
    for path, process in _kept(place):
        if path == own:
            continue
        with contextlib.suppress(OSError, NotRegular, TooLarge, UnicodeDecodeError):
            since_s, alive = path.lstat().st_mtime, process != os.getpid() and is_alive(process)
            kept = read_draft(read_limited(path, MOST_DRAFT_BYTES).decode("utf-8"))
            differs = kept.text != text
            if (differs or kept.version_a is not None) and (alive or time.time() - since_s < KEPT_S):
                found.append(Unsaved(path, kept.text if differs else None, since_s, alive, kept.version_a))
            elif not alive:
                path.unlink()
    return sorted(found, key=lambda each: -each.since_s)


def _kept(place: Path) -> Iterator[tuple[Path, int]]:
    pattern = re.compile(rf"\.{re.escape(place.name)}\.(\d+)-\d+\.{SUFFIX}")
    with contextlib.suppress(OSError), os.scandir(place.parent) as entries:
        for entry in entries:
            if (named := pattern.fullmatch(entry.name)) is not None and entry.is_file(follow_symlinks=False):
                yield Path(entry.path), int(named[1])


def is_alive(process: int) -> bool:
    """Whether a process of this number runs on this machine; one that cannot be asked counts as running."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True

"""Unsaved text of all editors of a cue file in one hidden file beside it."""

import os
import secrets
import time
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from threading import RLock, Timer
from typing import Annotated

from pydantic import Field, TypeAdapter, ValidationError

from thermicon.base.files.atomic import OutputError, check_folder, complete_or_absent
from thermicon.base.files.read_limited import NotRegular, TooLarge, read_limited

EVERY_S = 0.5
"""Shortest time between two writings of unsaved text, in s; a killed process loses what was typed for this long."""
MOST, MOST_LETTERS = 50, 4_000_000
"""Unsaved texts of one file, and letters of all of them; the oldest are dropped."""
MOST_BYTES, LATEST_S = 64_000_000, 1e10
"""Of a file that is believed: its size, and a time that a calendar can show."""


@dataclass(frozen=True, slots=True)
class UnsavedText:
    """A text, when it was written (s since 1970), the icon that was shown, and the ``editor`` that has not saved it.

    ``editor`` is empty for a version that an earlier release kept by hand.
    """

    text: str
    at_s: Annotated[float, Field(ge=0, le=LATEST_S)]
    icon: str | None = None
    editor: str = ""

    @property
    def age(self) -> str:
        """The time since it was written, in words."""
        minutes = max(0.0, time.time() - self.at_s) / 60
        if minutes < 1.5:
            return "a moment ago"
        if minutes < 90:
            return f"{minutes:.0f} minutes ago"
        return time.strftime("on %d %B at %H:%M", time.localtime(self.at_s))


_FILE = TypeAdapter(tuple[UnsavedText, ...])


class RecoveryFile:
    """The unsaved texts of one cue file, as an editor of it sees them; what other editors of it write is seen too.

    ``path`` is the file that holds them, None where they are only held in memory; ``failed`` says why the newest could
    not be written, None while they are.
    """

    def __init__(self, place: Path | None) -> None:
        self.path = None if place is None else place.with_name(f".{place.name}.unsaved")
        self.failed: str | None = None
        self._editor = secrets.token_hex(4)
        self._own: UnsavedText | None = None
        self._held: tuple[UnsavedText, ...] = ()
        self._seen: tuple[int, ...] | None = None
        self._timer: Timer | None = None
        self._last_s = -EVERY_S
        self._lock = RLock()

    @property
    def others(self) -> tuple[UnsavedText, ...]:
        """The texts of all other editors, the oldest first."""
        with self._lock:
            return tuple(each for each in self._read() if each.editor != self._editor)

    def typed(self, text: str | None, icon: str | None) -> None:
        """Keep the text of this editor, at once or within half a second; None: there is nothing unsaved."""
        with self._lock:
            before = self._own
            self._own = None if text is None else UnsavedText(text, time.time(), icon, self._editor)
            if text is None and before is not None:
                self._write()
            elif text is not None and self.path is not None and self._timer is None:
                wait_s = self._last_s + EVERY_S - time.monotonic()
                if wait_s <= 0:
                    self._write()
                    return
                self._timer = Timer(wait_s, self._write)
                self._timer.daemon = True
                self._timer.start()

    def keep(self, *texts: UnsavedText) -> None:
        """Add texts, and write what is unsaved now."""
        self._write(add=texts)

    def drop(self, *texts: UnsavedText) -> None:
        """Remove texts."""
        self._write(drop=texts)

    def write_versions(self) -> Path | None:
        """Write the versions that an earlier release kept by hand into a folder of cue files, which is returned.

        None where there are none; raises OutputError, and leaves them where they are.
        """
        versions = [text for text in self.others if not text.editor]
        if self.path is None or not versions:
            return None
        folder = self.path.with_name(f"{self.path.name.removeprefix('.').removesuffix('.cue.unsaved')}-versions")
        check_folder(folder)
        folder.mkdir(exist_ok=True)
        for number, version in enumerate(versions, 1):
            written = time.strftime("%Y-%m-%d-%H%M%S", time.localtime(version.at_s))
            path = folder / f"{number:02}-{written}.cue"
            if not path.exists():
                with complete_or_absent(path) as draft:
                    draft.write_bytes(version.text.encode("utf-8"))
        self.drop(*versions)
        return folder

    def _write(self, add: tuple[UnsavedText, ...] = (), drop: tuple[UnsavedText, ...] = ()) -> None:
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            own = () if self._own is None else (self._own,)
            newest = sorted({*self.others, *add, *own} - {*drop}, key=lambda each: -each.at_s)[:MOST]
            letters = accumulate(len(each.text) for each in newest)
            fits = sum(1 for total in letters if total <= MOST_LETTERS)
            self._held = tuple(reversed(newest[: max(fits, 1)]))
            if self.path is None:
                return
            try:
                if self._held:
                    with complete_or_absent(self.path) as draft:
                        draft.write_bytes(_FILE.dump_json(self._held))
                else:
                    self.path.unlink(missing_ok=True)
                self.failed = None
            except (OutputError, OSError, ValueError) as wrong:
                self.failed = str(wrong)
            self._seen, self._last_s = self._status(), time.monotonic()

    def _read(self) -> tuple[UnsavedText, ...]:
        """The content of the file, read again only when it has changed."""
        if self.path is not None and (seen := self._status()) != self._seen:
            self._seen, self._held = seen, _texts_in(self.path)
        return self._held

    def _status(self) -> tuple[int, ...] | None:
        try:
            found = os.lstat(self.path or "")
        except OSError:
            return None
        return found.st_ino, found.st_size, found.st_mtime_ns


def _texts_in(path: Path) -> tuple[UnsavedText, ...]:
    try:
        data = read_limited(path, MOST_BYTES)
        return _FILE.validate_json(data)
    except ValidationError:  # a file of another form is offered as it is: it may hold somebody's text
        return (UnsavedText(data.decode("utf-8", "replace"), path.stat().st_mtime, None, "unknown"),)
    except (OSError, NotRegular, TooLarge):
        return ()

"""A cue text under edit with its history."""

from __future__ import annotations

import hashlib
import re
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.files.inputs import read_bytes
from thermicon.base.files.read_limited import NotRegular, TooLarge, read_limited

from .outputs import check_output
from .recovery import RecoveryFile, UnsavedText

MOST_BYTES = 4_000_000
"""Bytes of a file that is opened for editing; the editor takes a million letters."""
MOST_STEPS = 200
MERGED_S = 0.8
"""Typing goes on as one step while the pauses are shorter than this."""
Kind = Literal["typing", "drag", "other"]
GOAL = re.compile(r"^# goal:[ \t]*(.*?)[ \t]*(?:\n|\Z)", re.MULTILINE)
"""The line of a text that holds its goal: a comment, so that the file keeps it."""


@dataclass(frozen=True, slots=True)
class HistoryStep:
    """The content of a step of history."""

    text: str
    icon: str | None = None


@dataclass(frozen=True, slots=True)
class History:
    """The state that is shown, those before it (the oldest first) and those undone (the next to be redone last).

    Verbs return new histories. At most 200 steps are kept; the oldest are forgotten.
    """

    now: HistoryStep
    past: tuple[HistoryStep, ...] = ()
    future: tuple[HistoryStep, ...] = ()
    last_s: float | None = field(default=None)
    kind: Kind = field(default="other")

    def typed(self, text: str, now_s: float) -> History:
        """The text as typed at a time (s, of any clock that goes on); a pause of 0.8 s begins a new step."""
        goes_on = self.kind == "typing" and self.last_s is not None and 0 <= now_s - self.last_s < MERGED_S
        return self._with(replace(self.now, text=text), "typing", now_s, goes_on)

    def dragged(self, text: str, end: bool) -> History:
        """The text in the course of a drag; all of it up to ``end`` is one step."""
        going = self._with(replace(self.now, text=text), "drag", None, self.kind == "drag")
        return replace(going, kind="other") if end else going

    def changed(self, text: str) -> History:
        """The text after a change that is a step of its own, such as a suggestion taken."""
        return self._with(replace(self.now, text=text), "other", None, False)

    def chosen(self, icon: str | None) -> History:
        """Another icon shown: it comes with the next step and is none itself."""
        return replace(self, now=replace(self.now, icon=icon), kind="other")

    def undo(self) -> History:
        """One step back; the history as it is where there is none."""
        return History(self.past[-1], self.past[:-1], (*self.future, self.now)) if self.past else self

    def redo(self) -> History:
        """One step forward again; the history as it is where there is none."""
        return History(self.future[-1], (*self.past, self.now), self.future[:-1]) if self.future else self

    def _with(self, new: HistoryStep, kind: Kind, now_s: float | None, goes_on: bool) -> History:
        if new == self.now:
            return replace(self, last_s=now_s, kind=kind)
        past = self.past if goes_on and self.past else (*self.past, self.now)[-MOST_STEPS:]
        return History(new, past, (), now_s, kind)


class Document:
    """A text and all that is known of it; verbs raise OutputError with a sentence.

    ``path`` is its file, None where it has none yet; ``saved`` is the text there; ``history`` holds the text as it is
    now with the steps before and after it; ``recovery`` holds unsaved text, which ``keeps`` writes beside the file:
    where a kernel serves a page.
    """

    def __init__(self, text: str, name: str = "icons", keeps: bool = False, path: Path | None = None) -> None:
        self.path = path
        self.name = name if path is None else path.name
        self.saved = text
        self.history = History(HistoryStep(text))
        self.keeps = keeps
        self._overwrites = self._crlf = False
        self._stamp: str | None = None
        self._seen: tuple[object, bool] | None = None
        self.recovery = self._recovery()

    @classmethod
    def open(cls, path: Path, keeps: bool = False) -> Document:
        """Read a cue file; raises OutputError for what is not a text file of an editor's size."""
        data = read_bytes(path, "cue file", MOST_BYTES / 1e6, OutputError)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise OutputError(f"cannot open {path}: it is not UTF-8 text; convert it first") from None
        made = cls(text.replace("\r\n", "\n"), keeps=keeps, path=path)
        made._stamp, made._crlf = _stamp(data), "\r\n" in text
        return made

    @property
    def text(self) -> str:
        """The text as it is now."""
        return self.history.now.text

    @property
    def goal(self) -> str:
        """The goal of the set in its text, as a comment ``# goal: …``; empty where there is none."""
        found = GOAL.search(self.text)
        return "" if found is None else found[1]

    def aim(self, goal: str) -> None:
        """Write another goal into the text, as a step that can be undone; an empty one takes the line away.

        Raises GoalError for a text that is not a goal.
        """
        from thermicon.perception import Goal

        rest, said = GOAL.sub("", self.text), " ".join(goal.split())
        if said:
            Goal.parse(said)
        self.history = self.history.changed(f"# goal: {said}\n{rest}" if said else rest)

    @property
    def dirty(self) -> bool:
        """Whether the text differs from what was opened or saved last."""
        return self.text != self.saved

    @property
    def folder(self) -> Path:
        """The folder where files are looked for and new ones are written."""
        return Path() if self.path is None else self.path.parent

    def place(self, name: str) -> Path:
        """The path of a name in the folder of the text, or of a path."""
        return self.folder / Path(name).expanduser()

    @property
    def title(self) -> str:
        """The name of the file or the shipped set, and what is to be known of it."""
        unsaved = ", unsaved changes" if self.path is not None else " (not saved to a file)"
        return f"{self.name}{unsaved if self.dirty else ''}"

    def warning(self) -> str:
        """The risk of losing text, in one sentence; empty where there is none."""
        if self._changed_on_disk():
            gone = self.path is not None and not self.path.exists()
            happened = "was removed" if gone else "has changed"
            cure = "open it again to see it, or save your text under another name"
            cure = "Save as writes your text to a file again" if gone else cure
            return f"{self.name} {happened} on disk since it was opened here: {cure}"
        return "" if self.recovery.failed is None else f"unsaved text is not kept: {self.recovery.failed}"

    def changed(self) -> None:
        """Keep the text as it is now until it is saved; called after each change of it."""
        self._overwrites = False
        self.recovery.typed(self.text if self.dirty else None, self.history.now.icon)

    def leave(self) -> None:
        """Write what is unsaved, before another document takes its place; OutputError where it would be lost."""
        if self.dirty:
            self.recovery.keep()
            if self.recovery.path is None or self.recovery.failed is not None:
                raise OutputError(f"{self.title}: save it first, or undo the changes; nothing was opened")

    def left(self, text: str) -> None:
        """Take what an editor that is gone left elsewhere as unsaved text, unless it is known."""
        if text not in (self.text, *(each.text for each in self.recovery.others)):
            self.recovery.keep(UnsavedText(text, time.time(), None, "page"))

    @property
    def offer(self) -> UnsavedText | None:
        """The newest text that another editor of the file left unsaved; None for none."""
        return next((text for text in reversed(self.recovery.others) if text.editor and text.text != self.text), None)

    def save(self) -> Path:
        """Save to the file it came from; pressed twice, over a file that has changed in between too."""
        if self.path is None:
            raise OutputError("this set has no file yet: save it under a name")
        if not self._overwrites and self._changed_on_disk():
            self._overwrites = True
            gone = "has changed on disk" if self.path.exists() else "was removed"
            raise OutputError(
                f"{self.name} {gone} since it was opened here: save your text under another name, or press Save again "
                "to write it over the file"
            )
        return self._write(self.path, self._crlf)

    def save_as(self, path: Path, overwrite: bool = False) -> Path:
        """Save to another file, which is that of the text from now on."""
        check_output(path, (".cue",), "cue text")
        if path.exists() and not overwrite:
            raise OutputError(f"{path} already exists and was kept: give another name, or tick overwrite")
        before = self.recovery
        self._write(path, crlf=False)
        if before is not self.recovery:
            before.typed(None, None)
        return path

    def _write(self, path: Path, crlf: bool) -> Path:
        check_output(path, (), "cue text")
        text = self.text
        data = (text.replace("\n", "\r\n") if crlf else text).encode("utf-8")
        with complete_or_absent(path) as draft:
            draft.write_bytes(data)
        moved = path != self.path
        self.path, self.name, self.saved, self._stamp, self._crlf = path, path.name, text, _stamp(data), crlf
        if moved:
            self.recovery = self._recovery()
        self.changed()
        return path

    def _recovery(self) -> RecoveryFile:
        return RecoveryFile((self.path or self.folder / f"{Path(self.name).stem}.cue") if self.keeps else None)

    def _changed_on_disk(self) -> bool:
        """Whether the file is another now: read again only when its time, size or place differ, as every frame asks."""
        if self.path is None:
            return False
        try:
            status = self.path.stat()
            seen = (self._stamp, status.st_ino, status.st_size, status.st_mtime_ns)
            if self._seen is None or self._seen[0] != seen:
                self._seen = (seen, _stamp(read_limited(self.path, MOST_BYTES)) != self._stamp)
        except (OSError, NotRegular, TooLarge):
            return True
        return self._seen[1]


def _stamp(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()

"""Undo and redo of what is edited: the text and the icon that is shown."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

MOST_STEPS = 200
MERGED_S = 0.8
"""Typing goes on as one step while the pauses are shorter than this."""
Kind = Literal["typing", "drag", "other"]


@dataclass(frozen=True, slots=True)
class Edited:
    """What a step of history holds."""

    text: str
    icon: str | None = None


@dataclass(frozen=True, slots=True)
class History:
    """The state that is shown, those before it (the oldest first) and those undone (the next to be redone last).

    Verbs return new histories. At most 200 steps are kept; the oldest are forgotten.

    >>> history = History(Edited("a")).typed("ab", 0.0).typed("abc", 0.5).typed("abcd", 3.0)
    >>> history.undo().now.text, history.undo().undo().now.text, history.undo().redo().now.text
    ('abc', 'a', 'abcd')
    """

    now: Edited
    past: tuple[Edited, ...] = ()
    future: tuple[Edited, ...] = ()
    last_s: float | None = field(default=None)
    kind: Kind = field(default="other")

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self.past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to take again."""
        return bool(self.future)

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
        if not self.past:
            return self
        return History(self.past[-1], self.past[:-1], (*self.future, self.now))

    def redo(self) -> History:
        """One step forward again; the history as it is where there is none."""
        if not self.future:
            return self
        return History(self.future[-1], (*self.past, self.now), self.future[:-1])

    def _with(self, new: Edited, kind: Kind, now_s: float | None, goes_on: bool) -> History:
        if new == self.now:
            return replace(self, last_s=now_s, kind=kind)
        past = self.past if goes_on and self.past else (*self.past, self.now)[-MOST_STEPS:]
        return History(new, past, (), now_s, kind)

"""One error of a cue file with its place and the exception that carries such errors."""

import tomllib
import unicodedata
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from thermicon.base.checks.arguments import InputError
from thermicon.base.words.clean_text import clean
from thermicon.base.words.number_text import count_of

# Characters of a line that an error shows.
WIDEST = 110
# Errors shown, and errors behind which reading stops: nobody corrects a thousand at once.
MOST_ERRORS, MOST_READ = 100, 1000


@cache
def codes() -> dict[str, dict[str, Any]]:
    """The catalogue of errors by code: title, meaning, a wrong text and a right one, or a cure."""
    text = resources.files("thermicon.icons").joinpath("data/mistakes.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


@dataclass(frozen=True, slots=True)
class CueError:
    """One thing that is wrong, where it is, and what would be right.

    ``line`` and ``column`` count from 1, in characters; both are 0 when the error concerns the file as a whole.
    ``length`` is how many characters the carets cover, ``source`` the line as written, ``what`` the words beside the
    carets, ``help`` what would fit, and ``suggestion`` one corrected line that was tried out, or None.

    >>> print(CueError("E102", "a.cue", 1, 7, 1, "hold 4", "this number has no unit", "such as: 4 s").render())
    a.cue:1:7  E102 missing unit
      1 | hold 4
        |       ^ this number has no unit
      such as: 4 s
    """

    code: str
    file: str
    line: int
    column: int
    length: int
    source: str
    what: str
    help: str
    suggestion: str | None = None

    @property
    def title(self) -> str:
        """The short name that belongs to the code."""
        return str(codes()[self.code]["title"])

    def render(self, brief: bool = False) -> str:
        """Return the error as people read it, with place, line and cure; `brief`: one of several, in three lines."""
        if self.line == 0:
            rows = [f"{self.file}  {self.code} {self.title}", f"  {self.what}"]
        else:
            before, shown, after = _window(self.source, self.column - 1, self.length)
            gutter = " " * len(str(self.line))
            text = (char if char == "\t" or char.isprintable() else "�" for char in before + shown + after)
            pad = "".join("\t" if char == "\t" else " " * _width(char) for char in before)
            carets = "^" * max(1, sum(_width(char) for char in shown))
            rows = [
                f"{self.file}:{self.line}:{self.column}  {self.code} {self.title}{f': {self.what}' * brief}",
                f"  {self.line} | {''.join(text)}",
                *[f"  {gutter} | {pad}{carets} {self.what}"] * (not brief),
            ]
        if self.help and not (brief and self.suggestion):
            rows.append(f"  {self.help}")
        if self.suggestion is not None:
            rows.append(f"  did you mean:  {self.suggestion}")
        return clean("\n".join(rows))


class CueErrors(InputError):
    """Every error of a file, in the order of the file; the only exception of reading one.

    Parameters
    ----------
    errors
        At most 100 errors, each with code, position and cure.
    more
        Number of errors beyond those.

    Notes
    -----
    ``str()`` renders one error at length, several in up to three lines each.

    Examples
    --------
    >>> from thermicon.icons import parse
    >>> try:
    ...     parse("cue 1; icon dip { cool by 6 at 3 °C/s }")
    ... except CueErrors as problem:
    ...     [(error.code, error.line, error.column) for error in problem.errors]
    [('E102', 1, 27)]
    """

    def __init__(self, errors: tuple[CueError, ...], more: int = 0) -> None:
        super().__init__(errors, more)
        self.errors = errors
        self.more = more

    @property
    def text(self) -> str:
        """Every error, one below the other."""
        parts = [error.render(brief=len(self.errors) > 1) for error in self.errors]
        if self.more:
            least = "at least " if self.more + len(self.errors) >= MOST_READ else ""
            parts.append(f"... and {least}{count_of(self.more, 'more error')}")
        return "\n".join(parts)

    def _render_traceback_(self) -> list[str]:
        return str(self).split("\n")


def whole_file(code: str, file: str, what: str, help: str = "") -> CueErrors:
    """Return the exception for a file that could not even be read line by line."""
    return CueErrors((CueError(code, file, 0, 0, 0, "", what, help),))


def _window(source: str, start: int, length: int) -> tuple[str, str, str]:
    # A file may be one endless line: show the neighbourhood of the carets only.
    stop = min(max(start + length, start), len(source))
    left = 0 if stop <= WIDEST else max(0, start - WIDEST // 2)
    right = min(len(source), max(left + WIDEST, start + 1))
    stop = min(stop, right)
    before = ("…" if left else "") + source[left:start]
    after = source[stop:right] + ("…" if right < len(source) else "")
    return before, source[start:stop], after


def _width(char: str) -> int:
    if unicodedata.combining(char):
        return 0
    return 2 if unicodedata.east_asian_width(char) in "WF" else 1

"""What can be wrong with a cue file: the table of codes, one error with its place, the exception that carries them."""

import unicodedata
from dataclasses import dataclass

from ..number_text import count_of
from .context import clean

TITLES: dict[str, str] = {
    # the file as a whole
    "E001": "no such file",
    "E002": "a folder, not a file",
    "E003": "unreadable file",
    "E004": "file too large",
    "E005": "empty file",
    "E006": "binary file",
    "E007": "not UTF-8",
    "E008": "no icons",
    "E009": "missing version line",
    "E010": "unknown version",
    "E013": "not a recording",
    "E014": "not a reading",
    "E015": "times out of order",
    "E016": "begins away from baseline",
    # words, numbers and units
    "E101": "not understood",
    "E102": "missing unit",
    "E103": "unknown unit",
    "E104": "wrong kind of unit",
    "E105": "unexpected character",
    "E106": "number expected",
    "E107": "missing rate or time",
    "E108": "more than one statement",
    "E109": "block never closed",
    "E110": "nothing to close",
    "E111": "text never closed",
    "E112": "unknown escape",
    "E113": "not a name",
    "E114": "missing block",
    "E115": "nested too deeply",
    "E116": "missing word",
    "E117": "missing text",
    "E118": "parameter not understood",
    "E120": "not in this version",
    # meaning
    "E201": "target on the wrong side",
    "E202": "amount not positive",
    "E203": "impossible duration",
    "E204": "rate not positive",
    "E205": "rest away from baseline",
    "E206": "already at baseline",
    "E207": "not a count",
    "E208": "temperature under control current",
    "E209": "to without warm or cool",
    "E210": "unit does not fit the control",
    "E211": "duplicate icon",
    "E212": "duplicate set",
    "E213": "given twice",
    "E214": "out of order",
    "E215": "unknown control",
    "E216": "unknown setting",
    "E217": "icon without statements",
    "E218": "impossible number",
    "E219": "level out of range",
    "E220": "too many corners",
    "E221": "too long",
    "E222": "total not kept",
    "E223": "icon without duration",
    "E224": "play away from baseline",
    "E225": "not whole periods",
    "E226": "unknown parameter",
    "E227": "parameter never used",
    "E228": "impossible range",
    "E229": "total inside a repeat",
    "E230": "unknown icon to play",
    "E231": "too many members",
    "E232": "icons that play each other",
}
# Characters of a line that an error shows.
WIDEST = 110
# Errors shown, and errors behind which reading stops: nobody corrects a thousand at once.
MOST_ERRORS, MOST_READ = 100, 1000


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
        return TITLES[self.code]

    def render(self) -> str:
        """Return the error as people read it: place and code, the line with carets, help, and the corrected line."""
        if self.line == 0:
            rows = [f"{self.file}  {self.code} {self.title}", f"  {self.what}"]
        else:
            before, shown, after = _window(self.source, self.column - 1, self.length)
            gutter = " " * len(str(self.line))
            pad = "".join("\t" if char == "\t" else " " * _width(char) for char in before)
            carets = "^" * max(1, sum(_width(char) for char in shown))
            rows = [
                f"{self.file}:{self.line}:{self.column}  {self.code} {self.title}",
                f"  {self.line} | {_visible(before + shown + after)}",
                f"  {gutter} | {pad}{carets} {self.what}",
            ]
        if self.help:
            rows.append(f"  {self.help}")
        if self.suggestion is not None:
            rows.append(f"  did you mean:  {self.suggestion}")
        return clean("\n".join(rows))


class CueErrors(ValueError):
    """Every error of a file, in the order of the file; the only exception of reading one.

    Parameters
    ----------
    errors
        At most 100 errors, each with code, position and cure.
    more
        Number of errors beyond those.

    Notes
    -----
    ``str()`` renders every error, separated by empty lines.

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

    def __str__(self) -> str:
        parts = [error.render() for error in self.errors]
        if self.more:
            least = "at least " if self.more + len(self.errors) >= MOST_READ else ""
            parts.append(f"... and {least}{count_of(self.more, 'more error')}")
        return "\n\n".join(parts)

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython shows in place of a traceback."""
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


def _visible(text: str) -> str:
    return "".join(char if char == "\t" or char.isprintable() else "�" for char in text)

"""The parser: cue text to an icon set or to all its errors."""

from thermicon.base.checks.arguments import checked

from ..model.errors import MOST_ERRORS, CueErrors, whole_file
from ..model.iconset import IconSet
from .assemble import analyse
from .recover import other_format
from .source import Finding, Source, decode

# Suggestions cost a parse each; beyond this many characters read again, errors come without one.
_TRIES = 150_000
# An error takes as long to describe as some forty characters to read.
_AN_ERROR = 40
_LONGEST_LINE = 200
_MOST_CURES = 4


@checked
def parse(text: str | bytes, file: str = "<text>") -> IconSet:
    """Return the icons of a cue text.

    Parameters
    ----------
    text
        The cue text; bytes are decoded as UTF-8.
    file
        Name that errors show.

    Returns
    -------
    IconSet
        The icons and families of the text, with their common context.

    Raises
    ------
    CueErrors
        With every error of the text, in its order; nothing else is raised.

    Examples
    --------
    >>> parse("cue 1; icon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }")["dip"].corners().time_s
    (0.0, 2.0, 6.0, 8.0)
    >>> try:
    ...     parse("cue 1; icon dip { cool by 6 at 3 °C/s }", "dip.cue")
    ... except CueErrors as errors:
    ...     print(errors)
    dip.cue:1:27  E102 missing unit
      1 | cue 1; icon dip { cool by 6 at 3 °C/s }
        |                           ^ this number has no unit
      a difference such as "6 °C" or "6 K"
      did you mean:  cue 1; icon dip { cool by 6 °C at 3 °C/s }
    """
    source = Source(file, decode(text, file))
    if other := other_format(source):
        raise whole_file("E101", file, *other)
    analysis = analyse(source)
    if analysis.icons is not None:
        return analysis.icons
    findings = analysis.findings[:MOST_ERRORS]
    more = analysis.more + len(analysis.findings) - len(findings)
    cured = _Suggester(len(findings) + more).cured
    raise CueErrors(tuple(source.error(finding, cured(source, finding, 0)) for finding in findings), more)


class _Suggester:
    """Tries cures out until their budget of characters is spent."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.budget = _TRIES

    def cured(self, source: Source, finding: Finding, depth: int) -> str | None:
        """Return the corrected line, or None: no cure leaves the line without an error and the file no worse."""
        line = 1 if finding.code == "E009" else source.place(finding.start)[0]
        if len(source.lines[line - 1]) > _LONGEST_LINE:
            return None
        for cure in finding.cures:
            if self.budget < len(source.text):
                return None
            elsewhere = source.place(cure.start)[0] != line or "\n" in source.text[cure.start : cure.end]
            if elsewhere or (depth and "\n" in cure.text):
                continue
            self.budget -= len(source.text)
            text = source.text[: cure.start] + cure.text + source.text[cure.end :]
            tried = Source(source.file, text)
            analysis = analyse(tried)
            self.budget -= _AN_ERROR * (len(analysis.findings) + analysis.more)
            left = [found for found in analysis.findings if tried.place(found.start)[0] == line]
            if not left and len(analysis.findings) + analysis.more <= self.count:
                return tried.lines[line - 1].strip() or None
            # A name that a cure made up is not respelt: what was written behind it would be lost.
            done = not left or depth >= _MOST_CURES or (finding.code, left[0].code) == ("E113", "E230")
            if not done and (deeper := self.cured(tried, left[0], depth + 1)) is not None:
                return deeper
        return None

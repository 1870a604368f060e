"""An icon: checked statements under a name."""

import hashlib
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from typing import Self

from thermicon.base.checks.arguments import checked
from thermicon.base.results.drawn import Drawn
from thermicon.base.words.clean_text import name_fault

from .check import ASSUMED_BASELINE_C, Problem, survey
from .context import Context, Metadata
from .corners import Corners, Quantity, corners
from .errors import CueError, CueErrors
from .format import icon_text, statement_text
from .motion import TOLERANCE
from .statements import LEAVES, Play, Repeat, Statement, all_played
from .units import Control, exact, fault


@dataclass(frozen=True, slots=True, repr=False)
class Icon(Drawn):
    """A thermal icon: statements that start from a baseline, with their context and metadata.

    Parameters
    ----------
    name
        A word of letters, digits and hyphens.
    statements
        Ramps, holds, waves and other statements, in the order of play.
    context
        What the icon prescribes, the baseline in °C and the body site. Without a baseline, 32 °C is used for checks.
    metadata
        Intent, author, DOI, licence and tags.

    Raises
    ------
    ValueError
        For a bad name, or no statements.
    CueErrors
        Where the statements cannot be played, for example a rest away from baseline.

    Examples
    --------
    >>> from thermicon.icons import Icon
    >>> from thermicon.icons.model.statements import Ramp, Hold, Return
    >>> Icon("dip", (Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
    <Icon dip: 8 s, 26 to 32 °C, at most 3 °C/s, control skin, baseline 32 °C assumed>
    """

    name: str
    statements: tuple[Statement, ...]
    context: Context = field(default_factory=Context)
    metadata: Metadata = field(default_factory=Metadata)

    @classmethod
    @checked
    def of(
        cls,
        name: str,
        *statements: Statement,
        control: Control = "skin",
        baseline_C: float | None = None,
        site: str | None = None,
        means: str | None = None,
    ) -> Self:
        """Return an icon of statements, with the control, the baseline in °C and the site that a cue file states.

        >>> from thermicon.icons import back, cool
        >>> Icon.of("dip", cool(by=4, at=2), back(at=2), control="display", baseline_C=33)
        <Icon dip: 4 s, 29 to 33 °C, at most 2 °C/s, control display>
        """
        return cls(name, statements, Context(control, baseline_C, site), Metadata(means))

    def __post_init__(self) -> None:
        object.__setattr__(self, "statements", tuple(self.statements))
        if wrong := name_fault(self.name):
            raise ValueError(f"icon: {wrong}")
        if not self.statements or not all(map(_sound, self.statements)):
            raise ValueError(f"icon {self.name} needs at least one statement, and nothing but statements")
        known = {self.name: self}
        for played in all_played(self.statements):
            if played.context != self.context:
                raise ValueError(f"icon {self.name} plays {played.name}, whose context differs: {played.context}")
            if known.setdefault(played.name, played) != played:
                raise ValueError(f"icon {self.name} plays two different icons that are both called {played.name}")
        self._prove(rest_level(self.context))

    def corners(self, start: float | None = None, tolerance: float = TOLERANCE) -> Corners:
        """Return the corner points, in °C, or in A under control current: exact, but for sines.

        ``start`` (°C) is the baseline when the context gives none; 32 °C is taken when neither does. Under control
        current it is the holding current in A, 0 by default. A sine lies within ``tolerance`` (K or A) of its straight
        pieces. Raises CueErrors when a target then lies on the wrong side, and ValueError when ``start`` or
        ``tolerance`` is out of range.

        >>> from thermicon.icons import read_cue
        >>> read_cue("six-icons")["cooling-step"].corners().value
        (32.0, 26.0, 26.0, 32.0)
        """
        if not 0 < tolerance < 10:
            raise ValueError(f"tolerance = {tolerance!r} must lie above 0 and below 10")
        level = rest_level(self.context, start)
        if level != rest_level(self.context):
            self._prove(level)
        quantity: Quantity = "current_A" if self.context.control == "current" else "temperature_C"
        return _kept_corners(self.statements, level, quantity, tolerance)

    @property
    def content_hash(self) -> str:
        """SHA-256 of the canonical text, as 64 hexadecimal digits: equal icons have equal hashes, everywhere."""
        return content_hash(str(self))

    def __str__(self) -> str:
        return icon_text(self)

    def __repr__(self) -> str:
        corners = self.corners()
        unit = "A" if self.context.control == "current" else "°C"
        assumed = ", baseline 32 °C assumed" if unit == "°C" and self.context.baseline_C is None else ""
        return (
            f"<Icon {self.name}: {corners.duration_s:.6g} s, {corners.lowest:.6g} to {corners.highest:.6g} {unit}, "
            f"at most {corners.steepest_per_s:.6g} {unit}/s, control {self.context.control}{assumed}>"
        )

    def _prove(self, level: Fraction) -> None:
        if found := survey(self.statements, self.context.control, level).problems:
            raise CueErrors(tuple(problem_error(problem, self.name, self.context) for problem in found))


_kept_corners = lru_cache(maxsize=512)(corners)
"""Corners that were asked for lately: exact fractions take their time, and every person of a crowd asks again."""


def rest_level(context: Context, start: float | None = None) -> Fraction:
    """Return the exact level at which icons begin: in the context, ``start`` or 32 °C (0 A); ValueError beyond."""
    if context.control == "current":
        level, wrong = start or 0.0, fault(start or 0.0, "current")
    else:
        assumed = ASSUMED_BASELINE_C if start is None else start
        level = assumed if context.baseline_C is None else context.baseline_C
        wrong = fault(level, "absolute")
    if wrong:
        raise ValueError(f"start: {wrong[1]}")
    return exact(float(level), "current" if context.control == "current" else "absolute")


def problem_error(problem: Problem, name: str, context: Context) -> CueError:
    """Return a problem as an error; without the file at hand, the canonical text of the statement is its line."""
    part = problem.statement
    line, column = (part.span if part else None) or (1, 1)
    text = statement_text(part, context.control).split("\n")[0] if part else f"icon {name} {{"
    source = " " * (column - 1) + text
    return CueError(problem.code, f"<icon {name}>", line, column, len(text), source, problem.what, problem.help)


def content_hash(text: str) -> str:
    """Return the SHA-256 of a canonical text as 64 hexadecimal digits."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def _sound(part: object) -> bool:
    return all(map(_sound, part.body)) if isinstance(part, Repeat) else isinstance(part, (Play, *LEAVES))

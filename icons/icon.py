"""The nouns of the package: Icon and IconSet, that prove themselves on construction."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from thermicon.icons.check import ASSUMED_BASELINE_C, Problem, problems
from thermicon.icons.corners import Corners, lower
from thermicon.icons.errors import CueError, CueErrors
from thermicon.icons.format import icon_text, set_text, statement_text
from thermicon.icons.frame import Frame, Metadata, name_fault, text_fault
from thermicon.icons.statements import LEAVES, Repeat, Statement, fault
from thermicon.icons.units import exact, quantity
from thermicon.icons.words import nearest

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True, repr=False)
class Icon:
    """A thermal icon: a name, statements that run from baseline, the frame they are meant in, and metadata.

    Raises ValueError for a bad name or no statements, and CueErrors when the statements cannot be run, for example
    a rest away from baseline. A frame without baseline is tried with 32 °C.

    >>> from thermicon.icons import Change, Hold, Icon, Return
    >>> Icon("dip", (Change("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
    <Icon dip: 8 s, 26 to 32 °C, at most 3 °C/s, control skin, baseline 32 °C assumed>
    """

    name: str
    statements: tuple[Statement, ...]
    frame: Frame = field(default_factory=Frame)
    metadata: Metadata = field(default_factory=Metadata)

    def __post_init__(self) -> None:
        object.__setattr__(self, "statements", tuple(self.statements))
        if wrong := name_fault(self.name):
            raise ValueError(f"icon: {wrong}")
        if not self.statements or not all(map(_sound, self.statements)):
            raise ValueError(f"icon {self.name} needs at least one statement, and nothing but statements")
        self._prove(self._level(None))

    def lower(self, start: float | None = None) -> Corners:
        """Return the exact corner points, in °C, or in A under control current.

        ``start`` (°C) is the baseline when the frame gives none; 32 °C is taken when neither does. Under control
        current it is the holding current in A, 0 by default. Raises CueErrors when a target then lies on the wrong
        side, and ValueError when ``start`` is out of range.

        >>> from thermicon.icons import read_cue
        >>> read_cue("six-icons")["cooling-step"].lower().value
        (32.0, 26.0, 26.0, 32.0)
        """
        level = self._level(start)
        if level != self._level(None):
            self._prove(level)
        return lower(self.statements, level, "current_A" if self.frame.control == "current" else "temperature_C")

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the icon against time, on ``ax`` or on a new figure, and return the Axes."""
        from thermicon.icons.draw import plot_icon

        return plot_icon(self, ax)

    def __str__(self) -> str:
        return icon_text(self)

    def __repr__(self) -> str:
        corners = self.lower()
        unit = "A" if self.frame.control == "current" else "°C"
        assumed = ", baseline 32 °C assumed" if unit == "°C" and self.frame.baseline_C is None else ""
        return (
            f"<Icon {self.name}: {corners.duration_s:.6g} s, {corners.lowest:.6g} to {corners.highest:.6g} {unit}, "
            f"at most {corners.steepest_per_s:.6g} {unit}/s, control {self.frame.control}{assumed}>"
        )

    def _repr_html_(self) -> str:
        from thermicon.icons.draw import svg

        return svg([self])

    def _level(self, start: float | None) -> Fraction:
        if self.frame.control == "current":
            level, wrong = start or 0.0, fault(start or 0.0, "current")
        else:
            assumed = ASSUMED_BASELINE_C if start is None else start
            level = assumed if self.frame.baseline_C is None else self.frame.baseline_C
            wrong = fault(level, "absolute")
        if wrong:
            raise ValueError(f"start: {wrong[1]}")
        return exact(float(level), "current" if self.frame.control == "current" else "absolute")

    def _prove(self, level: Fraction) -> None:
        found = problems(self.statements, self.frame.control, level)
        if found:
            raise CueErrors(tuple(self._error(problem) for problem in found))

    def _error(self, problem: Problem) -> CueError:
        # Without the file at hand, the canonical text of the statement stands for its line.
        part = problem.statement
        line, column = (part.span if part else None) or (1, 1)
        text = statement_text(part, self.frame.control).split("\n")[0] if part else f"icon {self.name} {{"
        source = " " * (column - 1) + text
        return CueError(
            problem.code, f"<icon {self.name}>", line, column, len(text), source, problem.what, problem.help
        )


class UnknownIcon(KeyError):
    """A set has no icon of this name; the message lists those that it has, nearest first."""

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True, slots=True, repr=False)
class IconSet:
    """The icons of one file, in its order, with the frame they share; ``set["name"]`` is one of them.

    Raises ValueError without icons, for two of one name, or when an icon's frame is not the set's.

    >>> from thermicon.icons import read_cue
    >>> read_cue("cooling-step-skin")
    <IconSet cooling-step-skin: 1 icon, 8 s, control skin, baseline 32 °C>
    """

    name: str
    title: str
    frame: Frame
    metadata: Metadata
    icons: tuple[Icon, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "icons", tuple(self.icons))
        if self.name and (wrong := name_fault(self.name)):
            raise ValueError(f"set: {wrong}")
        if self.title and (wrong := text_fault(self.title)):
            raise ValueError(f"title: {wrong}")
        if not self.icons:
            raise ValueError("a set needs at least one icon")
        names = [icon.name for icon in self.icons]
        if len(set(names)) < len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise ValueError(f"two icons are called {twice}")
        if any(icon.frame != self.frame for icon in self.icons):
            other = next(icon for icon in self.icons if icon.frame != self.frame)
            raise ValueError(f"the frame of icon {other.name} is not that of the set: {other.frame} and {self.frame}")

    def __len__(self) -> int:
        return len(self.icons)

    def __iter__(self) -> Iterator[Icon]:
        return iter(self.icons)

    def __contains__(self, item: object) -> bool:
        return item in self.icons or any(icon.name == item for icon in self.icons)

    def __getitem__(self, name: str) -> Icon:
        names = [icon.name for icon in self.icons]
        if name in names:
            return self.icons[names.index(name)]
        close = nearest(str(name), names)
        hint = f"did you mean {close}? " if close else ""
        raise UnknownIcon(f"no icon is called {name!r}; {hint}the set has: {', '.join(names)}")

    def __str__(self) -> str:
        return set_text(self)

    def __repr__(self) -> str:
        lengths = [icon.lower().duration_s for icon in self.icons]
        count = f"{len(self)} icon" + ("s" if len(self) > 1 else "")
        length = f"{min(lengths):.6g} to {max(lengths):.6g}" if min(lengths) < max(lengths) else f"{lengths[0]:.6g}"
        baseline = self.frame.baseline_C
        rest = f", baseline {quantity(baseline, 'absolute')}" if baseline is not None else ""
        return f"<IconSet {self.name or '(unnamed)'}: {count}, {length} s, control {self.frame.control}{rest}>"

    def _repr_html_(self) -> str:
        from thermicon.icons.draw import svg

        return svg(self.icons)


def _sound(part: object) -> bool:
    return all(map(_sound, part.body)) if isinstance(part, Repeat) else isinstance(part, LEAVES)

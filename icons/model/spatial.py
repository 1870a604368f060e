"""A spatial icon: one ordinary icon on one clock for each display element that plays."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from types import MappingProxyType

from thermicon.base.results.drawn import Drawn
from thermicon.base.words.clean_text import name_fault

from .check import survey
from .context import Context, Metadata
from .errors import CueErrors
from .format import icon_text
from .icon import Icon, content_hash, problem_error, rest_level
from .statements import Rest, Statement
from .units import LONGEST_S, SHORTEST_S, decimal_text, exact, prove_given


@dataclass(frozen=True, slots=True)
class On:
    """``on``: elements play a body at one time while the others rest; ValueError without names or statements."""

    names: tuple[str, ...]
    body: tuple[Statement, ...]

    def __post_init__(self) -> None:
        _prove(self)


@dataclass(frozen=True, slots=True)
class Along:
    """``along``: elements play a body one after the other, each ``every_s`` (s) after the one before."""

    names: tuple[str, ...]
    every_s: float
    body: tuple[Statement, ...]

    def __post_init__(self) -> None:
        prove_given(self, every_s="time")
        _prove(self)
        if len(self.names) < 2:
            raise ValueError("Along needs at least two elements")


@dataclass(frozen=True, slots=True)
class Together:
    """``together``: parts that begin at one time, on different elements; it lasts as long as its longest."""

    parts: tuple[On | Along, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        names = [name for part in self.parts for name in part.names]
        if not names or len(set(names)) < len(names):
            raise ValueError("Together needs parts, each on elements of its own")


Part = On | Along | Together
TimedBody = tuple[Fraction, Fraction, tuple[Statement, ...]]
"""When (s) a body begins and ends on an element, and the body."""


@dataclass(frozen=True, slots=True, repr=False)
class SpatialIcon(Drawn):
    """A thermal icon on several display elements.

    Parameters
    ----------
    name
        A word of letters, digits and hyphens.
    parts
        What plays where (``On``, ``Along``, ``Together``), one after the other; each body begins and ends at baseline.
    context
        What the icon prescribes, the baseline in °C, the body site, and the ``elements``.
    metadata
        Intent, author, DOI, licence and tags.

    Raises
    ------
    ValueError
        For a bad name, no parts, an element that the context does not name, and a body that ends away from baseline.
    CueErrors
        Where an element cannot play its statements.

    Examples
    --------
    >>> from thermicon.icons import parse
    >>> text = "on left { cool by 4 K at 2 K/s; return at 2 K/s }; on all { warm by 3 K at 3 K/s; return at 3 K/s }"
    >>> (icon,) = parse(f"cue 1; set {{ elements left, right }}; icon both {{ {text} }}").spatial
    >>> icon
    <SpatialIcon both: 6 s on left, right, 28 to 35 °C, control skin>
    >>> icon.tracks["right"].corners().time_s
    (0.0, 4.0, 5.0, 6.0)
    """

    name: str
    parts: tuple[Part, ...]
    context: Context
    metadata: Metadata = field(default_factory=Metadata)
    duration_s: float = field(init=False, compare=False)
    _tracks: tuple[tuple[str, Icon], ...] = field(init=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        if wrong := name_fault(self.name):
            raise ValueError(f"icon: {wrong}")
        if not self.parts or not all(isinstance(part, Part) for part in self.parts):
            raise ValueError(f"icon {self.name} needs parts on elements, and nothing but such parts")
        used = {name for part in bodies_of(self.parts) for name in part.names}
        if unknown := used - set(self.context.elements):
            raise ValueError(f"icon {self.name} plays on {min(unknown)}, which is not an element of its context")
        starts, end = _starts(self)
        if end > LONGEST_S:
            raise ValueError(f"icon {self.name} lasts {float(end):.6g} s; an icon lasts at most one hour (3600 s)")
        # Elements that play alike share one icon.
        known: dict[tuple[TimedBody, ...], Icon] = {}
        for plays in starts.values():
            if plays not in known:
                alone = replace(self.context, elements=())
                known[plays] = Icon(self.name, tuple(_with_rests(plays)), alone, self.metadata)
        object.__setattr__(self, "duration_s", float(end))
        object.__setattr__(self, "_tracks", tuple((name, known[plays]) for name, plays in starts.items()))

    @property
    def tracks(self) -> Mapping[str, Icon]:
        """The icon of each element that plays; all begin at one time, and who has ended rests."""
        return MappingProxyType(dict(self._tracks))

    @property
    def content_hash(self) -> str:
        """SHA-256 of the canonical text, as 64 hexadecimal digits: equal icons have equal hashes, everywhere."""
        return content_hash(str(self))

    def __str__(self) -> str:
        return icon_text(self)

    def __repr__(self) -> str:
        corners = [icon.corners() for icon in self.tracks.values()]
        low, high = min(each.lowest for each in corners), max(each.highest for each in corners)
        levels = f"{low:.6g} to {high:.6g} °C, control {self.context.control}"
        return f"<SpatialIcon {self.name}: {decimal_text(self.duration_s)} s on {', '.join(self.tracks)}, {levels}>"


def bodies_of(parts: Iterable[Part]) -> Iterator[On | Along]:
    """Yield the parts that have a body, those that begin together among them."""
    for part in parts:
        yield from part.parts if isinstance(part, Together) else (part,)


def _starts(icon: SpatialIcon) -> tuple[dict[str, tuple[TimedBody, ...]], Fraction]:
    """What each element that plays does, in the order of the context, and the end of all (s)."""
    level, clock = rest_level(icon.context), Fraction(0)
    starts: dict[str, list[TimedBody]] = {name: [] for name in icon.context.elements}
    for part in icon.parts:
        ends = []
        for each in bodies_of([part]):
            course = survey(each.body, icon.context.control, level)
            if course.problems:
                raise CueErrors(tuple(problem_error(one, icon.name, icon.context) for one in course.problems))
            if course.level != level:
                raise ValueError(f"icon {icon.name}: a body on {each.names[0]} ends away from baseline")
            step = exact(each.every_s, "time") if isinstance(each, Along) else Fraction(0)
            for place, name in enumerate(each.names):
                ends.append(clock + step * place + course.duration)
                starts[name].append((clock + step * place, ends[-1], each.body))
        clock = max(ends)
    return {name: tuple(plays) for name, plays in starts.items() if plays}, clock


def _with_rests(plays: Iterable[TimedBody]) -> Iterator[Statement]:
    """The statements of an element, which rests until each of its bodies begins."""
    clock = Fraction(0)
    for begin, end, body in plays:
        if (gap := float(begin - clock)) >= SHORTEST_S:  # bodies of one length may differ by rounding
            yield Rest(gap)
        yield from body
        clock = end


def _prove(part: On | Along) -> None:
    object.__setattr__(part, "names", tuple(part.names))
    object.__setattr__(part, "body", tuple(part.body))
    if not part.names or len(set(part.names)) < len(part.names) or not part.body:
        raise ValueError(f"{type(part).__name__} needs a body, and elements of which none is named twice")

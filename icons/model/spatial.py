"""A spatial icon: one ordinary icon for each display element that plays, on one clock."""

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

    @property
    def step_s(self) -> Fraction:
        """Time in s from the beginning of one element to that of the next."""
        return Fraction(0)


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

    @property
    def step_s(self) -> Fraction:
        """Time in s from the beginning of one element to that of the next."""
        return exact(self.every_s, "time")


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
        starts, end = self._starts()
        if end > LONGEST_S:
            raise ValueError(f"icon {self.name} lasts {float(end):.6g} s; an icon lasts at most one hour (3600 s)")
        object.__setattr__(self, "duration_s", float(end))
        object.__setattr__(self, "_tracks", tuple(self._made(starts)))

    @property
    def tracks(self) -> Mapping[str, Icon]:
        """The icon of each element that plays; all begin at one time, and who has ended rests."""
        return MappingProxyType(dict(self._tracks))

    @property
    def content_hash(self) -> str:
        """SHA-256 of the canonical text, as 64 hexadecimal digits: equal icons have equal hashes, everywhere."""
        return content_hash(str(self))

    def _starts(self) -> tuple[dict[str, list[tuple[Fraction, Fraction, tuple[Statement, ...]]]], Fraction]:
        """When (s, exact) each element begins and ends which body, and the end of all."""
        level, clock = rest_level(self.context), Fraction(0)
        starts: dict[str, list[tuple[Fraction, Fraction, tuple[Statement, ...]]]] = {}
        for part in self.parts:
            ends = []
            for each in part.parts if isinstance(part, Together) else (part,):
                course = survey(each.body, self.context.control, level)
                if course.problems:
                    raise CueErrors(tuple(problem_error(one, self.name, self.context) for one in course.problems))
                if course.level != level:
                    raise ValueError(f"icon {self.name}: a body on {each.names[0]} ends away from baseline")
                for place, name in enumerate(each.names):
                    begin = clock + each.step_s * place
                    ends.append(begin + course.duration)
                    starts.setdefault(name, []).append((begin, ends[-1], each.body))
            clock = max(ends)
        return starts, clock

    def _made(
        self, starts: Mapping[str, list[tuple[Fraction, Fraction, tuple[Statement, ...]]]]
    ) -> Iterator[tuple[str, Icon]]:
        """Each element with its icon, in the order of the context; equal ones are one object."""
        known: dict[tuple[tuple[Fraction, int], ...], Icon] = {}
        alone = replace(self.context, elements=())
        for name in self.context.elements:
            key = tuple((begin, id(body)) for begin, _, body in starts.get(name, ()))
            if key and key not in known:
                statements: list[Statement] = []
                clock = Fraction(0)
                for begin, end, body in starts[name]:
                    gap = float(begin - clock)
                    statements += [Rest(gap)] if gap >= SHORTEST_S else []  # bodies whose lengths differ by rounding
                    statements += body
                    clock = end
                known[key] = Icon(self.name, tuple(statements), alone, self.metadata)
            if key:
                yield name, known[key]

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


def _prove(part: On | Along) -> None:
    object.__setattr__(part, "names", tuple(part.names))
    object.__setattr__(part, "body", tuple(part.body))
    if not part.names or len(set(part.names)) < len(part.names) or not part.body:
        raise ValueError(f"{type(part).__name__} needs a body, and elements of which none is named twice")

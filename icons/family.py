"""A family: one icon text with parameters, that stands for as many icons as they have values, made when asked for."""

import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from math import prod
from typing import TYPE_CHECKING, Any

from thermicon.icons.errors import CueErrors
from thermicon.icons.expand import Expander, trusted
from thermicon.icons.faults import fault
from thermicon.icons.frame import Frame, Metadata, name_fault
from thermicon.icons.icon import Icon, problem_error
from thermicon.icons.parameter import Parameter
from thermicon.icons.statements import Repeat, Statement
from thermicon.icons.units import KIND_WORDS, UNITS, Kind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Path = tuple[int, ...]
MOST_MEMBERS = 10_000_000


@dataclass(frozen=True, slots=True)
class Summary:
    """Over all members: durations (s), levels (°C or A) and the steepest rate (K/s or A/s) that is no step."""

    shortest_s: float
    longest_s: float
    lowest: float
    highest: float
    steepest_per_s: float


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a parameter stands: the path of the statement (places, through repeats), its field, the name."""

    path: Path
    field: str
    kind: Kind
    parameter: str


@dataclass(frozen=True, slots=True, repr=False)
class Family:
    """Icons that differ in the values of their parameters; ``template`` is the first of them, ``slots`` what varies.

    A family is a sequence: ``len``, ``family[3]``, iteration and ``in`` work without expanding it. Members are named
    after their values, as in ``ramp_amount=-6_rate=1``. Raises ValueError for a bad name, parameter or slot, and
    CueErrors when a member cannot be run.

    >>> from thermicon.icons import parse
    >>> text = "cue 1; icon dip(size in [3, 6] K) means \\"{size} down\\" { cool by size at 3 K/s; return at 3 K/s }"
    >>> family = parse(text).families[0]
    >>> family
    <Family dip: 2 icons over size in [3, 6] K, control skin>
    >>> [(icon.name, icon.metadata.means) for icon in family]
    [('dip_size=3', '3 K down'), ('dip_size=6', '6 K down')]
    """

    name: str
    parameters: tuple[Parameter, ...]
    template: tuple[Statement, ...]
    slots: tuple[Slot, ...]
    frame: Frame = field(default_factory=Frame)
    metadata: Metadata = field(default_factory=Metadata)
    _expander: Expander = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("parameters", "template", "slots"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        wrong = name_fault(self.name) or ("a member's name is no family's name" if "_" in self.name else None)
        if wrong:
            raise ValueError(f"family: {wrong}")
        if wrong := self._fault():
            raise ValueError(f"family {self.name}: {wrong}")
        object.__setattr__(self, "_expander", Expander(self.parameters, self.template, self.slots, self.metadata))
        from thermicon.icons.sweep import sweep

        found = sweep(self)
        if found.problem is not None:
            raise CueErrors((problem_error(found.problem, self.name, self.frame),))

    @classmethod
    def unproven(cls, values: dict[str, Any]) -> "Family":
        """Return a family of these fields without its proof, which the caller runs."""
        made = Expander(values["parameters"], values["template"], values["slots"], values["metadata"])
        return trusted(cls, {**values, "_expander": made})

    def _fault(self) -> str | None:
        names = [parameter.name for parameter in self.parameters]
        if not names or len(set(names)) < len(names):
            return "parameters are needed, each with a name of its own"
        if len(self) > MOST_MEMBERS:
            return f"{len(self):,} members; a family has at most {MOST_MEMBERS:,}"
        for parameter in self.parameters:
            slots = [slot for slot in self.slots if slot.parameter == parameter.name]
            if not slots:
                return f"parameter {parameter.name} is never used"
            for slot in slots:
                if found := value_fault(parameter, slot.kind):
                    return f"parameter {parameter.name}: {found[1]}"
        return None

    def __len__(self) -> int:
        return prod(len(parameter) for parameter in self.parameters)

    def __getitem__(self, index: int) -> Icon:
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"family {self.name} has {count} members, so there is none at {index}")
        return self._at(self._expander.places(index % count))

    def __iter__(self) -> Iterator[Icon]:
        frame, made, name = self.frame, self._expander, self.name
        for index in range(len(self)):
            places = made.places(index)
            yield trusted(
                Icon,
                {
                    "name": name + made.suffix(places),
                    "statements": made.statements(places),
                    "frame": frame,
                    "metadata": made.metadata(places),
                },
            )

    def __contains__(self, item: object) -> bool:
        name = item.name if isinstance(item, Icon) else item
        found = self.find(name) if isinstance(name, str) else None
        return found is not None and (not isinstance(item, Icon) or item == found)

    def find(self, name: str) -> Icon | None:
        """Return the member of this name, or None."""
        head, *rest = name.split("_")
        pairs = [part.partition("=")[::2] for part in rest]
        if head != self.name or [pair[0] for pair in pairs] != [parameter.name for parameter in self.parameters]:
            return None
        places = [own.place(text) for own, (_, text) in zip(self.parameters, pairs, strict=True)]
        known = [place for place in places if place is not None]
        if len(known) < len(places):
            return None
        icon = self._at(known)
        return icon if icon.name == name else None

    def member(self, values: Mapping[str, float]) -> Icon:
        """Return the member with these values, each in its parameter's unit; ValueError when there is none."""
        places = []
        for own in self.parameters:
            place = own.place(repr(float(values[own.name]))) if own.name in values else None
            if place is None:
                raise ValueError(f"family {self.name}: {own.name} = {values.get(own.name)} is not in {own}")
            places.append(place)
        return self._at(places)

    def sample(self, count: int, seed: int = 0) -> tuple[Icon, ...]:
        """Return ``count`` different members drawn at random, in the family's order; all where it has no more."""
        size = len(self)
        drawn = sorted(random.Random(seed).sample(range(size), min(count, size)))
        return tuple(self[index] for index in drawn)

    def summary(self, start: float | None = None) -> Summary:
        """Return durations, extremes and steepest rate over all members; ``start`` as in ``Icon.lower``."""
        from thermicon.icons.sweep import sweep

        return sweep(self, start).summary

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw up to 24 members, evenly chosen, over one another; returns the Axes."""
        from thermicon.icons.draw import plot_family

        return plot_family(self, ax)

    def __str__(self) -> str:
        from thermicon.icons.format import icon_text

        return icon_text(self)

    def __repr__(self) -> str:
        over = ", ".join(map(str, self.parameters))
        return f"<Family {self.name}: {len(self):,} icons over {over}, control {self.frame.control}>"

    def _repr_html_(self) -> str:
        from thermicon.icons.draw import svg

        return svg([self])

    def _at(self, places: list[int]) -> Icon:
        made = self._expander
        values = {"name": self.name + made.suffix(places), "statements": made.statements(places)}
        return trusted(Icon, {**values, "frame": self.frame, "metadata": made.metadata(places)})

    def __reduce__(self) -> tuple[object, ...]:
        return Family, (self.name, self.parameters, self.template, self.slots, self.frame, self.metadata)


def value_fault(parameter: Parameter, kind: Kind) -> tuple[str, str] | None:
    """Return error code and words for the first value of a parameter that this kind of quantity may not have."""
    if parameter.unit not in UNITS[kind]:
        unit = f"{parameter.name} is in {parameter.unit}" if parameter.unit else f"{parameter.name} has no unit"
        return "E104", f"{unit}; {KIND_WORDS[kind]} is needed here"
    places: Sequence[int] = range(len(parameter))
    if parameter.span is not None:  # values rise evenly: the ends, and those about 0, stand for all
        zero = round(-parameter.span[0] / parameter.span[2])
        places = [place for place in (0, zero - 1, zero, zero + 1, len(parameter) - 1) if 0 <= place < len(parameter)]
    return next((found for place in places if (found := fault(parameter.si(place, kind), kind))), None)


def statement_at(template: tuple[Statement, ...], path: Path) -> Statement:
    """Return the statement at a path of places through repeats; IndexError where there is none."""
    part = template[path[0]]
    for place in path[1:]:
        if not isinstance(part, Repeat):
            raise IndexError(f"no statement at {path}")
        part = part.body[place]  # type: ignore[assignment]
    return part


def path_of(template: tuple[Statement, ...], wanted: Statement) -> Path:
    """Return the path of a statement, by identity; LookupError when it is not there."""
    for place, part in enumerate(template):
        if part is wanted:
            return (place,)
        if isinstance(part, Repeat):
            with suppress(LookupError):
                return (place, *path_of(part.body, wanted))  # type: ignore[arg-type]
    raise LookupError("the statement is not in this template")

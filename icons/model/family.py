"""A family: a parametrised icon that yields one icon for each combination of parameter values."""

import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import prod

from thermicon.base.results.drawn import Drawn
from thermicon.base.words.clean_text import name_fault

from .context import Context, Metadata
from .icon import Icon, rest_level
from .members import HOLE, Expander, Extremes, check_family
from .parameter import Parameter, Slot, slot_fault
from .statements import Statement

MOST_MEMBERS = 100_000
"""Members of a family, and of all families of a file: each is checked exactly."""
FEWER = "take larger steps or fewer parameters, or split the family over several files"


@dataclass(frozen=True, slots=True, repr=False)
class Family(Drawn):
    r"""Icons that differ only in the values of their parameters.

    A family is a sequence: ``len``, ``family[3]``, iteration and ``in`` work without creating all members. Members are
    named after their values, as in ``ramp_amount=-6_rate=1``.

    Parameters
    ----------
    name
        Name of the family, the first part of the members' names.
    parameters
        Names and values of what varies, each in its unit.
    template
        Statements of the first member.
    slots
        Where in the template the parameters are used.
    context
        What the icons prescribe, the baseline in °C and the body site.
    metadata
        Intent, author, DOI, licence and tags.

    Raises
    ------
    ValueError
        For a bad name, parameter or slot.
    CueErrors
        Where a member cannot be played.

    Examples
    --------
    >>> from thermicon.icons import parse
    >>> text = "cue 1; icon dip(size in [3, 6] K) means \"{size} down\" { cool by size at 3 K/s; return at 3 K/s }"
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
    context: Context = field(default_factory=Context)
    metadata: Metadata = field(default_factory=Metadata)
    _expander: Expander = field(init=False, compare=False, repr=False)
    _checked: tuple[Fraction, Extremes] = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("parameters", "template"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "slots", tuple(sorted(self.slots, key=lambda slot: (slot.path, slot.field))))
        wrong = name_fault(self.name) or ("a family cannot have a member's name" if "_" in self.name else None)
        if wrong:
            raise ValueError(f"family: {wrong}")
        if wrong := self._fault():
            raise ValueError(f"family {self.name}: {wrong}")
        members = Expander(self.name, self.parameters, self.template, self.slots, self.metadata)
        object.__setattr__(self, "_expander", members)
        object.__setattr__(self, "_checked", (rest_level(self.context), check_family(members, self.context)))

    def _fault(self) -> str | None:
        names = [parameter.name for parameter in self.parameters]
        if not names or len(set(names)) < len(names):
            return "parameters are needed, each with a different name"
        if len(self) > MOST_MEMBERS:
            return f"{len(self):,} members; a family has at most {MOST_MEMBERS:,}: {FEWER}"
        for parameter in self.parameters:
            slots = [slot for slot in self.slots if slot.parameter == parameter.name]
            if not slots:
                return f"parameter {parameter.name} is never used"
            for slot in slots:
                if wrong := slot_fault(self.template, slot, parameter, self.context.control):
                    return f"parameter {parameter.name}: {wrong}"
        if unknown := next((slot.parameter for slot in self.slots if slot.parameter not in names), None):
            return f"no parameter is called {unknown}, which a slot names"
        if len({(slot.path, slot.field) for slot in self.slots}) < len(self.slots):
            return "two parameters stand in one place"
        if hole := next((hole for hole in HOLE.findall(self.metadata.means or "") if hole not in names), None):
            return f"{{{hole}}} in the intent names no parameter"
        return None

    def __len__(self) -> int:
        return prod(len(parameter) for parameter in self.parameters)

    def __getitem__(self, index: int) -> Icon:
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"family {self.name} has {count} members, so there is none at {index}")
        return self._at(self._expander.places(index % count))

    def __iter__(self) -> Iterator[Icon]:
        return (self[index] for index in range(len(self)))

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

    def variant(self, values: Mapping[str, float]) -> Icon:
        """Return the icon with these values, each in its parameter's unit, which need not be values of the family.

        Raises CueErrors or ValueError when it cannot be played.
        """
        parameters = tuple(Parameter(own.name, own.unit, listed=(values[own.name],)) for own in self.parameters)
        one = Expander(self.name, parameters, self.template, self.slots, self.metadata)
        places = one.places(0)
        return Icon(one.name(places), one.statements(places), self.context, one.metadata(places))

    def sample(self, count: int, seed: int = 0) -> tuple[Icon, ...]:
        """Return ``count`` different members drawn at random, in the family's order; all where it has no more."""
        size = len(self)
        drawn = sorted(random.Random(seed).sample(range(size), min(count, size)))
        return tuple(self[index] for index in drawn)

    def summary(self, start: float | None = None) -> Extremes:
        """Return durations, extremes and steepest rate over all members; ``start``, errors: see ``Icon.corners``."""
        rest, found = self._checked
        return found if rest_level(self.context, start) == rest else check_family(self._expander, self.context, start)

    def __str__(self) -> str:
        from .format import icon_text

        return icon_text(self)

    def __repr__(self) -> str:
        over = ", ".join(map(str, self.parameters))
        return f"<Family {self.name}: {len(self):,} icons over {over}, control {self.context.control}>"

    def _at(self, places: list[int]) -> Icon:
        members = self._expander
        return Icon(members.name(places), members.statements(places), self.context, members.metadata(places))

    def __reduce__(self) -> tuple[object, ...]:
        return Family, (self.name, self.parameters, self.template, self.slots, self.context, self.metadata)

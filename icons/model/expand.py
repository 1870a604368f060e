"""Members of a family made one by one; statements that several members have in common are made once."""

import re
from collections.abc import Callable, Sequence
from dataclasses import fields
from math import prod
from typing import TYPE_CHECKING, Any, TypeVar

from .context import Metadata
from .parameter import Parameter
from .statements import Repeat, Statement

if TYPE_CHECKING:
    from .parameter import Slot

HOLE = re.compile(r"\{([^{}\s]*)\}")
Places = Sequence[int]
Made = TypeVar("Made")
# Statements and texts that few members differ in are kept; beyond this many, each is made anew.
_MOST_KEPT = 65_536


class Expander:
    """Makes the statements, name and metadata of a member from the places of its values in the parameters."""

    def __init__(
        self,
        family: str,
        parameters: tuple[Parameter, ...],
        template: tuple[Statement, ...],
        slots: "tuple[Slot, ...]",
        metadata: Metadata,
    ) -> None:
        self.family = family
        self.parameters = parameters
        self.order = {parameter.name: place for place, parameter in enumerate(parameters)}
        self.slots: dict[tuple[int, ...], list[Slot]] = {}
        for slot in slots:
            self.slots.setdefault(slot.path, []).append(slot)
        self.makers = [self.kept(*self.maker(part, (place,))) for place, part in enumerate(template)]
        self.metadata = self.intent(metadata)
        self.labels = [self.kept(self.label(place), (place,)) for place in range(len(parameters))]

    def __len__(self) -> int:
        return prod(len(parameter) for parameter in self.parameters)

    def places(self, index: int) -> list[int]:
        """Return the place of each parameter's value in the member at an index; the last parameter runs fastest."""
        found = []
        for parameter in reversed(self.parameters):
            index, place = divmod(index, len(parameter))
            found.append(place)
        return found[::-1]

    def statements(self, places: Places) -> tuple[Statement, ...]:
        """Return the statements of a member."""
        return tuple([make(places) for make in self.makers])

    def name(self, places: Places) -> str:
        """Return the name of a member, for example ``ramp_amount=-6_rate=1``."""
        return "".join([self.family, *(label(places) for label in self.labels)])

    def label(self, place: int) -> Callable[[Places], str]:
        """Return a maker of one parameter's part of a name."""
        own = self.parameters[place]
        return lambda places: f"_{own.name}={own.text(places[place])}"

    def intent(self, metadata: Metadata) -> Callable[[Places], Metadata]:
        """Return a maker of metadata in whose intent ``{name}`` stands for a parameter's value with its unit."""
        pieces: list[str | int] = []
        for n, part in enumerate(HOLE.split(metadata.means or "")):
            pieces.append(self.order[part] if n % 2 and part in self.order else part if n % 2 == 0 else f"{{{part}}}")
        used = tuple(sorted({piece for piece in pieces if isinstance(piece, int)}))
        values = {item.name: getattr(metadata, item.name) for item in fields(metadata)}

        def make(places: Places) -> Metadata:
            words = [piece if isinstance(piece, str) else self.quantity(piece, places[piece]) for piece in pieces]
            return Metadata(**{**values, "means": "".join(words) or None})

        return self.kept(make, used)

    def quantity(self, parameter: int, place: int) -> str:
        """Return a value with its unit, as written."""
        own = self.parameters[parameter]
        return f"{own.text(place)} {own.unit}".strip()

    def maker(self, part: Statement, path: tuple[int, ...]) -> tuple[Callable[[Places], Any], tuple[int, ...]]:
        """Return what makes one statement, and which parameters it depends on."""
        mine = self.slots.get(path, [])
        values = {item.name: getattr(part, item.name) for item in fields(part)}
        varied = [(slot.field, slot.kind, self.order[slot.parameter]) for slot in mine]
        used = {place for _, _, place in varied}
        inner: list[Callable[[Places], Any]] = []
        if isinstance(part, Repeat):
            for place, inside in enumerate(part.body):
                make, needs = self.maker(inside, (*path, place))  # type: ignore[arg-type]
                inner.append(self.kept(make, needs))
                used |= set(needs)
        if not used:
            return lambda _: part, ()
        cls, parameters = type(part), self.parameters

        def make_one(places: Places) -> Any:
            own = dict(values)
            for name, kind, place in varied:
                value = parameters[place].si(places[place], kind)
                own[name] = int(value) if kind == "count" else value
            if inner:
                own["body"] = tuple([make(places) for make in inner])
            return cls(**own)

        return make_one, tuple(sorted(used))

    def kept(self, make: Callable[[Places], Made], used: tuple[int, ...]) -> Callable[[Places], Made]:
        """Return a maker that remembers what it made, where the parameters it depends on have few values."""
        if not used:
            only = make([0] * len(self.parameters))
            return lambda _: only
        size = 1
        for place in used:
            size *= len(self.parameters[place])
        if size > _MOST_KEPT:
            return make
        known: dict[Any, Made] = {}

        def kept(places: Places) -> Made:
            key = tuple([places[place] for place in used])
            if key not in known:
                known[key] = make(places)
            return known[key]

        return kept

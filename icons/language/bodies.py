"""Assembly of the statements of one icon or family."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, cast

from ..model.context import Metadata
from ..model.icon import Icon
from ..model.members import HOLE
from ..model.parameter import Path, Slot, value_fault
from ..model.spatial import Part
from ..model.statements import (
    Bound,
    Broken,
    Current,
    Heading,
    Hold,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Shape,
    Start,
    Statement,
    Step,
    Total,
    Wave,
)
from ..model.units import MOST_REPEATS, UNITS, Kind
from ..model.words import nearest
from .build import Builder, FamilyParameters, Place, parameters_of, rule_of, span
from .failed_statement import short
from .source import Patch
from .spatial_bodies import BLOCKS, spatial_parts

_USES: dict[str, tuple[Kind, ...]] = {
    "by_use": ("change", "current"),
    "to_use": ("absolute", "current"),
    "at_use": ("rate", "current_rate"),
    "over_use": ("time",),
    "for_use": ("time",),
    "every_use": ("time",),
    "count_use": ("count",),
}
# Which rate a ramp takes; that of a return depends on what the set controls.
_RATES: dict[str, tuple[Kind, ...]] = {"change": ("rate",), "shift": ("rate",), "drive": ("current_rate",)}
# Which rule gives which value of a statement; what a parameter may stand for is among them.
_VALUES = {
    **dict.fromkeys(("difference", "signed"), "by_K"),
    **{"absolute": "to_C", "current": "to_A", "current_change": "by_A"},
    **{"rate": "rate", "current_rate": "rate", "at_use": "rate", "period": "period", "every_use": "period"},
    **dict.fromkeys(("time", "over_use", "for_use"), "time"),
}
Resolve = Callable[[str, Place], Icon | None]


@dataclass(frozen=True, slots=True)
class IconDraft:
    """An icon or family as written; ``over`` are the parameters of a family, ``slots`` where they stand in it.

    In a set with elements it has ``parts`` in place of a body; ``unread``: some of them could not be read.
    """

    name: str | None
    place: Place
    metadata: Metadata
    body: tuple[Statement | Broken, ...]
    over: FamilyParameters | None = None
    slots: tuple[Slot, ...] = ()
    parts: tuple[Part, ...] = ()
    unread: bool = False


def icon_draft(builder: Builder, tree: Any, resolve: Resolve, elements: tuple[str, ...] | None = ()) -> IconDraft:
    """Return an icon or family from its tree; ``resolve`` finds the icon that a ``play`` names, or adds a finding.

    ``elements`` are those of the set, None when they could not be read.
    """
    head, *parts = tree.children
    name = str(head) if head.type == "NAME" else None
    keys = [part for part in parts if rule_of(part) == "metadata"]
    listed = [part for part in parts if rule_of(part) == "parameters"]
    place = span(head) if name else span(tree)
    over = parameters_of(builder, listed[0]) if listed else None
    scope = Scope(builder, resolve, over, known=name is not None, elements=elements)
    rows = [part for part in parts if rule_of(part) not in ("metadata", "parameters")]
    spatial = spatial_parts(scope, rows, elements) if elements else ()
    body = () if elements else scope.body(rows, ())
    if not rows:
        what = "there is nothing between the braces"
        builder.add("E217", place, what, 'an icon needs a statement, such as "cool by 6 °C at 3 °C/s"')
    metadata = builder.metadata(keys)
    if over is not None:
        scope.finish(over, keys, metadata)
    return IconDraft(name, place, metadata, body, over, tuple(scope.slots), spatial, scope.broken)


@dataclass(slots=True)
class Scope:
    """Reads the bodies of one icon."""

    builder: Builder
    resolve: Resolve
    over: FamilyParameters | None
    known: bool
    slots: list[Slot] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    broken: bool = False
    elements: tuple[str, ...] | None = ()
    told: bool = False

    def body(self, parts: Iterable[Any], path: Path) -> tuple[Statement | Broken, ...]:
        """Return statements in order, with Broken for each that could not be read."""
        return tuple(self.statement(part, (*path, place)) for place, part in enumerate(parts))

    def statement(self, tree: Any, path: Path) -> Statement | Broken:
        """Return one statement, and remember the places of its parts."""
        builder, place = self.builder, span(tree)
        built: Statement | Broken | None = None
        if rule_of(tree) == "repeat":
            built = self.repeat(tree, path)
        elif rule_of(tree) in BLOCKS:
            self.block(rule_of(tree), (place[0], place[0] + len(rule_of(tree))))
        elif self.elements and rule_of(tree) in ("play", "total"):
            self.not_on_elements(rule_of(tree), place)
        elif rule_of(tree) == "play":
            icon = self.resolve(str(tree.children[0]), span(tree.children[0]))
            built = Play(icon, builder.at(place)) if icon else None
        elif rule_of(tree):
            built = self.leaf(tree, path)
        self.broken |= built is None
        built = Broken(builder.at(place)) if built is None else built
        builder.kept.append(built)
        builder.places[id(built)] = builder.parts(tree, place)
        return built

    def block(self, word: str, place: Place) -> None:
        """Report a block for elements where there are none, or inside of another block."""
        if self.elements:
            help = f'put "{word}" directly between the braces of the icon'
            self.builder.add("E237", place, f'"{word}" stands inside another block', help)
        elif self.elements is not None and not self.told:
            help = "name them in the set: set { elements left, right }; for one element, write its statements alone"
            self.builder.add("E234", place, f'"{word}" needs elements, and this set names none', help)
            self.told = True

    def not_on_elements(self, word: str, place: Place) -> None:
        """Report a statement that elements cannot take."""
        if word == "total":
            help = "an icon lasts as long as its parts: remove the total"
            self.builder.add("E229", place, "a total has no place in a set with elements", help)
        else:
            what = '"play" in a set with elements is not in this version'
            self.builder.add("E120", place, what, "write the statements of that icon here")

    def leaf(self, tree: Any, path: Path) -> Statement | None:
        """Return the statement for a tree, or None, and findings, when its numbers are not all in order."""
        builder, rule = self.builder, rule_of(tree)
        words = {child.type: str(child) for child in tree.children if not rule_of(child)}
        values: dict[str, float] = {}
        for part in tree.children:
            if rule_of(part):
                name, value = self.value(part, tree, path, words)
                if value != value:
                    values["broken"] = value
                values[name] = value
        if "broken" in values:
            return None
        by, to, amperes = values.get("by_K"), values.get("to_C"), values.get("to_A")
        rate, time, by_A = values.get("rate"), values.get("time"), values.get("by_A")
        at = builder.at(span(tree))
        direction = cast(Heading, words.get("DIRECTION", "change"))
        match rule:
            case "change" | "shift":
                return Ramp(direction, by, to, rate, time, at)
            case "drive":
                return Current(cast(float, amperes), rate, time, at)
            case "return":
                return Return(rate, time, at)
            case "hold":
                return Hold(values["time"], at)
            case "rest":
                return Rest(values["time"], at)
            case "step":
                return Step(direction, by, to, by_A, amperes, at)
            case "pulse":
                return Pulse(direction, by, by_A, values["time"], at)
            case "total":
                bound = "at most" if "MOST" in words else "at least" if "LEAST" in words else "exactly"
                return Total(values["time"], cast(Bound, bound), at)
        return self.wave(tree, words, values)

    def wave(self, tree: Any, words: dict[str, str], values: dict[str, float]) -> Wave | None:
        """Return a wave; None, and a finding, for an amplitude or a start that does not fit."""
        by_K, by_A, start = values.get("by_K"), values.get("by_A"), words.get("START")
        if by_A is not None and by_A <= 0:
            self.builder.add("E202", span(tree.children[1]), "an amplitude is positive", 'add "starting down"')
            return None
        up, down = ("warm", "cool") if by_A is None else ("up", "down")
        if start not in (None, up, down):
            token = next(child for child in tree.children if getattr(child, "type", "") == "START")
            other = {"warm": "up", "cool": "down", "up": "warm", "down": "cool"}[str(token)]
            what = f'"{token}" is not a way to start a wave in {"A" if by_A is not None else "°C"}'
            self.builder.add("E210", span(token), what, f'"{up}" or "{down}"', Patch(*span(token), other))
            return None
        at = self.builder.at(span(tree))
        shape = cast(Shape, words["SHAPE"])
        return Wave(shape, by_K, by_A, values["period"], values["time"], cast(Start | None, start), "CUT" in words, at)

    def value(self, part: Any, tree: Any, path: Path, words: dict[str, str]) -> tuple[str, float]:
        """Return which value of a statement a part is, and the value; NaN, with a finding, when it is not valid."""
        rule = rule_of(part)
        if rule not in _USES:
            return _VALUES[rule], self.builder.quantity(part, wave=rule_of(tree) == "wave")
        signed = rule_of(tree) in ("shift", "step", "pulse") and "DIRECTION" not in words
        kind, value = self.use(part, tree, signed)
        if kind is None:
            return "broken", value
        if rule in ("by_use", "to_use"):
            name = slot = rule[:3] + ("A" if kind == "current" else "C" if kind == "absolute" else "K")
        else:
            name = _VALUES[rule]
            slot = {"period": "period_s", "time": "duration_s"}.get(name, "rate_per_s")
            if name == "rate" and rule_of(tree) != "return":
                slot = "rate_A_per_s" if kind == "current_rate" else "rate_K_per_s"
        self.slots.append(Slot(path, slot, kind, str(part.children[0])))
        return name, value

    def use(self, part: Any, tree: Any, signed: bool) -> tuple[Kind | None, float]:
        """Return kind and first value of a parameter where it is used; None and NaN, with a finding, when it fails."""
        token = part.children[0]
        own = self.over.named.get(str(token)) if self.over else None
        self.used.add(str(token))
        if own is None:
            self.broken = True
            return None, float("nan")
        kinds = _RATES.get(rule_of(tree), _USES[rule_of(part)]) if rule_of(part) == "at_use" else _USES[rule_of(part)]
        kind = next((kind for kind in kinds if own.unit in UNITS[kind]), kinds[0])
        kind = "difference" if kind == "change" and not signed else kind
        found = value_fault(own, kind)
        if kind == "current" and rule_of(part) == "by_use" and not found:
            negative = min(own.si(0, kind), own.si(len(own) - 1, kind), *own.listed) < 0 and rule_of(tree) == "wave"
            if negative or own.place("0") is not None:
                found = "E202", "an amplitude is positive" if negative else "a change must not be zero"
        if found:
            what, help = f"{own.name}: {found[1]}", f"its values: {str(own)[:80]}"
            if found[0] == "E104":
                what = found[1]
                help = f"the unit comes once, after the values: {own.name} in [...] {next(iter(UNITS[kind]))}".strip()
            elif found[0] == "E202" and rule_of(tree) == "wave":
                what = f"{own.name}: an amplitude is positive"
            self.builder.add(found[0], span(token), what, help)
            return None, float("nan")
        return kind, own.si(0, kind)

    def repeat(self, tree: Any, path: Path) -> Repeat | None:
        """Return a repeat; an impossible count counts as one, so that its body is checked."""
        head, *parts = tree.children
        body = self.body(parts, path)
        count = 1
        self.broken |= getattr(head, "type", "") == "BROKEN"
        if rule_of(head):
            kind, value = self.use(head, tree, signed=False)
            if kind is not None:
                self.slots.append(Slot(path, "count", kind, str(head.children[0])))
                count = int(value)
        elif head.type == "NUMBER":
            digits = str(head).removeprefix("+")
            most_digits = len(str(MOST_REPEATS))
            count = int(digits) if digits.isascii() and digits.isdigit() and len(digits) <= most_digits else 0
            if not 1 <= count <= MOST_REPEATS:
                large = digits.isascii() and digits.isdigit() and digits.strip("0") != ""
                wrong = f"too large: at most {MOST_REPEATS:,}" if large else "not a positive whole number"
                what = f'"{short(head)}" is {wrong}'
                self.builder.add("E207", span(head), what, "a repeat has a count from 1, such as: repeat 3 { ... }")
                count = 1
        for part, inside in zip(parts, body, strict=True):
            if isinstance(inside, Total):
                help = "put it directly between the braces of the icon"
                self.builder.add("E229", span(part), "a total concerns the whole icon, not a repeat", help)
        body = tuple(Broken() if isinstance(part, Total) else part for part in body)
        if not body:
            if getattr(head, "type", "") != "BROKEN":
                what = "there is nothing between the braces of this repeat"
                self.builder.add("E217", span(tree), what, "put the statements that repeat between them")
            return None
        return Repeat(count, body, self.builder.at(span(tree)))

    def finish(self, over: FamilyParameters, keys: list[Any], metadata: Metadata) -> None:
        """Report parameters that are never used, and names in the intent that are not parameters."""
        for name, place in over.places.items():
            if name in over.named and name not in self.used and not self.broken:
                what = f"{name} is never used, so that members would be equal"
                self.builder.add("E227", place, what, "use it in the body, or remove it")
        for hole in HOLE.findall(metadata.means or ""):
            if hole not in over.named and not over.unread:
                token = next(tree.children[1] for tree in keys if str(tree.children[0]) == "means")
                help = f"in the intent of a family, {{...}} names one of: {', '.join(over.named)}"
                start = span(token)[0] + str(token).find(f"{{{hole}}}")
                close = nearest(hole, list(over.named)) or (next(iter(over.named)) if len(over.named) == 1 else None)
                place = (start, start + len(hole) + 2)
                cures = (Patch(*place, f"{{{close}}}"),) if close else ()
                self.builder.add("E226", place, f'"{short(hole)}" is not a parameter', help, *cures)

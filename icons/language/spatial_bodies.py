"""Assembly of what an icon plays on which display elements."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from ..model.spatial import Along, On, Part, Together
from ..model.statements import Statement
from ..model.words import nearest
from .build import Place, rule_of, span
from .failed_statement import short
from .source import Patch

if TYPE_CHECKING:
    from .bodies import Scope

BLOCKS = ("on", "along", "together")
_EVERY = ("all", "both", "each", "every", "everything", "everywhere")
_WRAPPED = "elements play statements: on all { ... }, or a name in place of all"


def spatial_parts(scope: "Scope", trees: Sequence[Any], elements: tuple[str, ...]) -> tuple[Part, ...]:
    """Return the parts of an icon in a set with elements, with findings for what is not on elements.

    The scope is broken where one of them could not be read; bodies may then hold Broken.
    """
    return _Spatial(scope, elements).parts(trees)


@dataclass(slots=True)
class _Spatial:
    scope: "Scope"
    elements: tuple[str, ...]

    def parts(self, trees: Sequence[Any]) -> tuple[Part, ...]:
        found: list[Part | None] = []
        loose: list[Any] = []
        for tree in trees:
            rule = rule_of(tree)
            if rule not in BLOCKS and not _unread(tree):
                loose.append(tree)
                continue
            self.outside(loose)
            loose = []
            self.scope.broken |= not rule
            if rule == "together":
                found.append(self.together(tree))
            elif rule in BLOCKS:
                found.append(self.body(tree))
        self.outside(loose)
        return tuple(part for part in found if part is not None)

    def outside(self, trees: Sequence[Any]) -> None:
        """Report statements in a row that stand outside of a block."""
        if not trees:
            return
        builder = self.scope.builder
        self.scope.broken = True
        (start, _), (_, end) = span(trees[0]), span(trees[-1])
        text = builder.source.text[start:end]
        if inner := next(filter(None, map(_block_in, trees)), None):
            what = f'"{rule_of(inner)}" stands inside "repeat"'
            help = 'put "repeat" inside of it: on left { repeat 3 { ... } }'
            builder.add("E237", _word(inner), what, help)
            return
        if (rule := rule_of(trees[0])) in ("play", "total"):
            self.scope.not_on_elements(rule, span(trees[0]))
            self.outside(trees[1:])
            return
        what = f'"{short(text.split(maxsplit=1)[0])}" stands outside of "on", in a set with elements'
        builder.add("E233", span(trees[0]), what, _WRAPPED, Patch(start, end, f"on all {{ {text} }}"))

    def together(self, tree: Any) -> Together | None:
        """Return parts that begin at one time, each on elements of its own; None, with findings, for others."""
        builder, bodies, sound = self.scope.builder, list[On | Along](), True
        parts = [part for part in tree.children if rule_of(part)]
        self.scope.broken |= len(parts) < len(tree.children)
        if not tree.children:
            what = 'there is nothing between the braces of "together"'
            builder.add("E217", span(tree), what, "put two or more of: on left { ... }")
        stray = next((part for part in parts if rule_of(part) not in BLOCKS), None)
        if stray is not None:
            what = 'only "on" and "along" stand in "together"'
            builder.add("E237", span(stray), what, _WRAPPED)
        first: dict[str, Place] = {}
        for part in parts:
            self.scope.broken |= rule_of(part) not in ("on", "along")
            if rule_of(part) == "together":
                what, help = '"together" stands inside "together"', "put its parts directly into the outer one"
                builder.add("E237", _word(part), what, help)
            elif rule_of(part) in BLOCKS and (body := self.body(part)):
                bodies.append(body)
                for name in body.names:
                    if name in first:
                        line, _ = builder.source.place(first[name][0])
                        what = f"{name} plays since line {line} already, at the same time"
                        help = 'an element plays one thing at a time: put this behind the end of "together"'
                        builder.add("E236", _word(part), what, help)
                        sound = False
                    first.setdefault(name, span(part))
        self.scope.broken |= not (sound and bodies)
        return Together(tuple(bodies)) if sound and bodies else None

    def body(self, tree: Any) -> On | Along | None:
        """Return what some elements play; None, with findings, when its head could not be read."""
        head, *rest = tree.children
        builder, place, every, step = self.scope.builder, span(tree), None, head
        names = self.names(head) if rule_of(head) == "names" else None
        if rest and rule_of(rest[0]) in ("period", "every_use"):
            step = rest.pop(0)
            every = builder.quantity(step) if rule_of(step) == "period" else float("nan")
        if every == every and every is not None and names is not None and len(names) == 1:
            what = f'"along" goes from one element to the next, and {names[0]} is one'
            help = "name two or more elements, or write: on NAME { ... }"
            builder.add("E238", span(head), what, help, Patch(place[0], span(step)[1], f"on {names[0]}"))
            names = None
        body = cast(tuple[Statement, ...], self.scope.body(rest, ()))
        if not rest:
            what = f'there is nothing between the braces of "{rule_of(tree)}"'
            builder.add("E217", place, what, "put the statements that these elements play between them")
        if names is None or every != every or not body:
            self.scope.broken = True
            return None
        if every is not None:
            return Along(names, every, body)
        return On(tuple(name for name in self.elements if name in names), body)

    def names(self, tree: Any) -> tuple[str, ...] | None:
        """Return the elements that a list names, ranges of them in the order of the set or against it."""
        found: list[str] = []
        builder, before, sound = self.scope.builder, span(tree)[0], True
        for part in tree.children:
            if not rule_of(part):
                return self.elements
            known = [place for place in map(self.place, part.children) if place is not None]
            sound &= len(known) == len(part.children)
            if len(known) == len(part.children):
                first, last = known[0], known[-1]
                meant = self.elements[first : last + 1] if first <= last else self.elements[last : first + 1][::-1]
                if again := [name for name in meant if name in found]:
                    cures = [Patch(before, span(part)[1], "")] if len(known) == 1 else []
                    builder.add("E236", span(part), f"{again[0]} is named already", "name each element once", *cures)
                    sound = False
                found += meant
            before = span(part)[1]
        return tuple(found) if sound else None

    def place(self, token: Any) -> int | None:
        """Return which element a name means; None, with a finding, when it means none."""
        if str(token) in self.elements:
            return self.elements.index(str(token))
        builder, parts = self.scope.builder, str(token).split("-")
        close: str | None = ", ".join(parts) if set(parts) <= set(self.elements) else None
        close = close or ("all" if str(token).casefold() in _EVERY else nearest(str(token), self.elements))
        cures = (Patch(*span(token), close),) if close else ()
        what = f'"{short(token)}" is not an element of this set'
        builder.add("E235", span(token), what, f"its elements are: {', '.join(self.elements)}", *cures)
        return None


def _unread(tree: Any) -> bool:
    """Whether this stands for a statement, or the head of a block, that could not be read and was reported."""
    return not rule_of(tree) or (rule_of(tree) == "repeat" and getattr(tree.children[0], "type", "") == "BROKEN")


def _block_in(tree: Any) -> Any:
    """The first block for elements inside of a statement, or None."""
    inside = [part for part in getattr(tree, "children", ()) if rule_of(part)]
    return next((found for part in inside if (found := part if rule_of(part) in BLOCKS else _block_in(part))), None)


def _word(tree: Any) -> Place:
    """Where the first word of a block stands."""
    start, _ = span(tree)
    return start, start + len(rule_of(tree)) if rule_of(tree) in BLOCKS else span(tree)[1]

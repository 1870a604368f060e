"""From the tree to statements: numbers into SI, texts unescaped, and every number that cannot be, told at its place."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, cast

from thermicon.icons.errors import TITLES
from thermicon.icons.frame import Metadata, text_fault
from thermicon.icons.source import Edit, Finding, Source
from thermicon.icons.statements import (
    Broken,
    Change,
    Direction,
    Drive,
    Hold,
    Repeat,
    Rest,
    Return,
    Statement,
    fault,
)
from thermicon.icons.units import Kind, to_si
from thermicon.icons.words import EXAMPLES, nearest

Place = tuple[int, int]
_ESCAPES = {"n": "\n", '"': '"', "\\": "\\"}
_MANY = 1_000_000_000


@dataclass(frozen=True, slots=True)
class IconDraft:
    """An icon as written: name (None when unreadable), where it stands, metadata and statements."""

    name: str | None
    place: Place
    metadata: Metadata
    body: tuple[Statement | Broken, ...]


@dataclass(slots=True)
class Builder:
    """Turns parts of the tree into model parts; collects findings, and where each statement's parts stand in the text.

    ``places`` maps ``id(statement)`` to the offsets of its parts; ``kept`` keeps those ids from being used again.
    """

    source: Source
    findings: list[Finding] = field(default_factory=list)
    places: dict[int, dict[str, Place]] = field(default_factory=dict)
    kept: list[object] = field(default_factory=list)

    def icon(self, tree: Any) -> IconDraft:
        """Return an icon; an empty one is a finding."""
        head, *parts = tree.children
        name = str(head) if head.type == "NAME" else None
        keys = [part for part in parts if _rule(part) == "metadata"]
        body = self.body([part for part in parts if _rule(part) != "metadata"])
        place = span(head) if name else span(tree)
        if not body:
            what = "there is nothing between the braces"
            self.add("E217", place, what, 'an icon needs a statement, such as "cool by 6 °C at 3 °C/s"')
        return IconDraft(name, place, self.metadata(keys), body)

    def body(self, parts: Iterable[Any]) -> tuple[Statement | Broken, ...]:
        """Return statements in order, with Broken for each that could not be read."""
        return tuple(self.statement(part) for part in parts)

    def statement(self, tree: Any) -> Statement | Broken:
        """Return one statement, and remember the places of its parts."""
        before = len(self.findings)
        place = span(tree)
        made: Statement | Broken
        if _rule(tree) == "repeat":
            made = self.repeat(tree)
        else:
            values = {part.data: self.quantity(part) for part in getattr(tree, "children", ()) if _rule(part)}
            sound = len(self.findings) == before and _rule(tree) != ""
            made = self.leaf(tree, values) if sound else Broken(self.at(place))
        self.kept.append(made)
        self.places[id(made)] = self.parts(tree, place)
        return made

    def leaf(self, tree: Any, values: dict[str, float]) -> Statement:
        """Return the statement for a tree whose numbers are all in order."""
        rate, time = values.get("rate", values.get("current_rate")), values.get("time")
        at = self.at(span(tree))
        match _rule(tree):
            case "change":
                direction = cast(Direction, str(tree.children[0]))
                return Change(direction, values.get("difference"), values.get("absolute"), rate, time, at)
            case "drive":
                return Drive(values["current"], rate, time, at)
            case "return":
                return Return(rate, time, at)
            case "hold":
                return Hold(values["time"], at)
        return Rest(values["time"], at)

    def repeat(self, tree: Any) -> Repeat | Broken:
        """Return a repeat; an impossible count counts as one, so that its body is checked."""
        head, *parts = tree.children
        body = self.body(parts)
        count = 1
        if head.type == "NUMBER":
            digits = str(head).removeprefix("+")
            count = int(digits) if digits.isascii() and digits.isdigit() and len(digits) <= 10 else 0
            if not 1 <= count <= _MANY:
                what = f'"{_short(head)}" is not a positive whole number'
                self.add("E207", span(head), what, "a repeat has a count from 1, such as: repeat 3 { ... }")
                count = 1
        if not body:
            what = "there is nothing between the braces of this repeat"
            self.add("E217", span(tree), what, "put the statements that repeat between them")
            return Broken(self.at(span(tree)))
        return Repeat(count, body, self.at(span(tree)))

    def parts(self, tree: Any, place: Place) -> dict[str, Place]:
        """Return the offsets of what messages may point at: word, target, pace, count, rate, whole."""
        start, end = place
        word = self.source.text[start:end].split(maxsplit=1)[0] if end > start else ""
        found = {"whole": place, "word": (start, start + len(word))}
        for part in getattr(tree, "children", ()):
            rule = _rule(part)
            if rule in ("absolute", "difference", "current"):
                found["target"] = span(part)
            elif rule in ("rate", "current_rate", "time"):
                found["pace"] = span(part)
                found[rule] = span(part)
        if _rule(tree) == "repeat":
            found["count"] = (start, span(tree.children[0])[1])
        return found

    def quantity(self, tree: Any) -> float:
        """Return the SI value of a number with its unit; NaN, and a finding, when no statement may have it."""
        kind = cast(Kind, str(tree.data))
        number, unit = tree.children
        place = span(tree)
        try:
            value = to_si(str(number), str(unit), kind)
        except ValueError as error:
            self.add("E218", span(number), str(error), EXAMPLES[kind])
            return float("nan")
        found = fault(value, kind)
        if found:
            positive = str(number).lstrip("-−")
            cures = (Edit(*span(number), positive),) if value < 0 and kind != "absolute" else ()
            self.add(found[0], place, found[1], EXAMPLES[kind], *cures)
            return float("nan")
        return value

    def metadata(self, trees: Iterable[Any]) -> Metadata:
        """Return the metadata of a header or of the set block."""
        values: dict[str, str] = {}
        first: dict[str, int] = {}
        for tree in trees:
            key, token = str(tree.children[0]), tree.children[1]
            text = self.text(token)
            if key in first:
                line, _ = self.source.place(first[key])
                self.add("E213", span(tree), f'"{key}" stands on line {line} already', "keep one of them")
            elif text is not None and not text.strip(" \t\n," if key == "tags" else None):
                self.add("E117", span(token), "the text is empty", f"write something, or leave {key} out")
            elif text is not None:
                values[key] = text
            first.setdefault(key, span(tree)[0])
        tags = tuple(dict.fromkeys(tag.strip() for tag in values.pop("tags", "").split(",") if tag.strip()))
        return Metadata(**values, tags=tags)

    def text(self, token: Any) -> str | None:
        """Return a quoted text without quotes and escapes; None, and a finding, when it cannot be."""
        start = span(token)[0]
        out: list[str] = []
        inner = str(token)[1:-1]
        index = 0
        while index < len(inner):
            char = inner[index]
            if char == "\\":
                index += 1
                if inner[index] not in _ESCAPES:
                    place = (start + index, start + index + 2)
                    help = 'in a text, \\" \\\\ and \\n stand for a quotation mark, a backslash and a new line'
                    self.add("E112", place, f'"\\{inner[index]}" means nothing', help, Edit(place[0], place[0], "\\"))
                    return None
                char = _ESCAPES[inner[index]]
            out.append(char)
            index += 1
        text = "".join(out)
        wrong = text_fault(text) if text.strip() else None
        if wrong:
            self.add("E105", span(token), wrong, "take it away")
            return None
        return text

    def choice(self, token: Any, known: Iterable[str], code: str, noun: str) -> str | None:
        """Return a word that must be one of those known; None, and a finding, when it is not."""
        options = list(known)
        if str(token) in options:
            return str(token)
        close = nearest(str(token), options)
        cures = (Edit(*span(token), close),) if close else ()
        self.add(code, span(token), f'"{_short(token)}" is not {noun}', f"one of: {', '.join(options)}", *cures)
        return None

    def at(self, place: Place) -> tuple[int, int]:
        """Return line and column of a place."""
        return self.source.place(place[0])

    def add(self, code: str, place: Place, what: str, help: str = "", *cures: Edit) -> None:
        """Add a finding."""
        assert code in TITLES
        self.findings.append(Finding(code, place[0], place[1], what, help, cures))


def span(item: Any) -> Place:
    """Return the offsets of a tree or token."""
    if hasattr(item, "data"):
        return item.meta.start_pos, item.meta.end_pos
    start = item.start_pos or 0
    return start, max(item.end_pos or 0, start + len(item))


def _rule(item: Any) -> str:
    return str(getattr(item, "data", ""))


def _short(text: object) -> str:
    return str(text) if len(str(text)) <= 30 else str(text)[:29] + "…"

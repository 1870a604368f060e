"""From tokens to values: numbers into SI, texts unescaped, with an error at the place of each that is not valid."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, cast

from ..model.context import Metadata, text_fault
from ..model.errors import TITLES
from ..model.units import Kind, fault, to_si
from ..model.words import EXAMPLES, nearest
from .failed_statement import short
from .source import Edit, Finding, Source

Place = tuple[int, int]
_KINDS: dict[str, Kind] = {"signed": "change", "period": "time", "current_change": "current"}
_TARGETS = ("absolute", "difference", "signed", "current", "current_change", "by_use", "to_use")
_ESCAPES = {"n": "\n", '"': '"', "\\": "\\"}


@dataclass(slots=True)
class Builder:
    """Turns parts of the tree into model parts; collects findings, and where each statement's parts stand in the text.

    ``places`` maps ``id(statement)`` to the offsets of its parts; ``kept`` keeps those ids from being used again.
    """

    source: Source
    findings: list[Finding] = field(default_factory=list)
    places: dict[int, dict[str, Place]] = field(default_factory=dict)
    kept: list[object] = field(default_factory=list)

    def parts(self, tree: Any, place: Place) -> dict[str, Place]:
        """Return the offsets of what messages may point at: word, target, pace, count, rate, whole."""
        start, end = place
        word = self.source.text[start:end].split(maxsplit=1)[0] if end > start else ""
        found = {"whole": place, "word": (start, start + len(word))}
        for part in getattr(tree, "children", ()):
            rule = rule_of(part)
            if rule in _TARGETS:
                found["target"] = span(part)
            elif rule in ("rate", "current_rate", "time", "at_use", "over_use", "for_use"):
                found["pace"] = found["time" if rule == "for_use" else rule] = span(part)
            elif getattr(part, "type", "") == "DIRECTION":
                found["direction"] = span(part)
        if rule_of(tree) == "repeat":
            found["count"] = (start, span(tree.children[0])[1])
        return found

    def quantity(self, tree: Any, wave: bool = False) -> float:
        """Return the SI value of a number with its unit; NaN, and a finding, when no statement may have it."""
        rule = str(tree.data)
        kind = _KINDS.get(rule) or cast(Kind, rule)
        number, unit = tree.children
        place, help = span(tree), EXAMPLES["difference" if kind == "change" else kind]
        try:
            value = to_si(str(number), str(unit), kind)
        except ValueError as error:
            self.add("E218", span(number), str(error), help)
            return float("nan")
        found = fault(value, kind)
        if not found and rule == "current_change" and value == 0:
            found = "E202", "a change must not be zero"
        if found:
            positive = str(number).lstrip("-−")
            signed = ("absolute", "change", "current")
            cures = (Edit(*span(number), positive),) if value < 0 and kind not in signed else ()
            if wave and kind == "difference" and found[0] == "E202":
                found = "E202", "an amplitude is positive"
                help = 'a wave goes both ways; to begin downwards, add "starting cool"'
            self.add(found[0], place, found[1], help, *cures)
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
                self.add("E213", span(tree), f'"{key}" is already on line {line}', "keep one of them")
            elif text is not None and not text.strip(" \t\n," if key == "tags" else None):
                self.add("E117", span(token), "the text is empty", f"write something, or leave {key} out")
            elif text is not None:
                values[key] = text
            first.setdefault(key, span(tree)[0])
        tags = tuple(dict.fromkeys(tag.strip() for tag in values.pop("tags", "").split(",") if tag.strip()))
        return Metadata(**values, tags=tags)

    def text(self, token: Any) -> str | None:
        """Return a quoted text without quotes and escapes; None, with a finding, when it is not valid."""
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
            self.add("E105", span(token), wrong, "remove it")
            return None
        return text

    def choice(self, token: Any, known: Iterable[str], code: str, noun: str) -> str | None:
        """Return a word that must be one of those known; None, and a finding, when it is not."""
        options = list(known)
        if str(token) in options:
            return str(token)
        close = nearest(str(token), options)
        cures = (Edit(*span(token), close),) if close else ()
        self.add(code, span(token), f'"{short(token)}" is not {noun}', f"one of: {', '.join(options)}", *cures)
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


def rule_of(item: Any) -> str:
    """Return the name of a tree's rule, or "" for a token."""
    return str(getattr(item, "data", ""))

"""From the tree to a set: the file's order, its one set block, its icons, and whether each of them can be run."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, cast

from thermicon.icons.build import Builder, IconDraft, Place, span
from thermicon.icons.check import ASSUMED_BASELINE_C, MOST_CORNERS, Problem, corner_count, problems
from thermicon.icons.frame import Frame, Metadata
from thermicon.icons.icon import Icon, IconSet
from thermicon.icons.recover import read
from thermicon.icons.source import Edit, Finding, Source
from thermicon.icons.statements import Control, Repeat, Return, Statement
from thermicon.icons.units import exact
from thermicon.icons.words import CONTROLS

MOST_CORNERS_A_FILE = 200_000


@dataclass(frozen=True, slots=True)
class Analysis:
    """Either the set, or the findings in the order of the text, with how many were not kept."""

    icons: IconSet | None
    findings: tuple[Finding, ...]
    more: int


def analyse(source: Source) -> Analysis:
    """Parse and check a source; never raises."""
    reading = read(source)
    return _Assembler(source).run(reading.tree, reading.findings, reading.more)


class _Assembler:
    def __init__(self, source: Source) -> None:
        self.source = source
        self.builder = Builder(source)
        self.name = self.title = ""
        self.metadata = Metadata()
        self.site: str | None = None
        # None below means "not readable", so that one mistake does not draw others after it.
        self.control: Control | None = "skin"
        self.baseline: float | None = None
        self.baseline_known = True

    def run(self, tree: Any, syntax: tuple[Finding, ...], more: int) -> Analysis:
        parts = tree.children
        kinds = [getattr(part, "data", "broken") for part in parts]
        self.version(parts, kinds)
        self.set_block(parts, kinds)
        drafts = [self.builder.icon(part) for part, kind in zip(parts, kinds, strict=True) if kind == "icon"]
        self.names(drafts)
        self.meaning(drafts)
        if not drafts and "broken" not in kinds:
            end = len(self.source.text.rstrip())
            help = "add one: icon my-icon { cool by 6 °C at 3 °C/s; return at 3 °C/s }"
            self.builder.add("E008", (max(0, end - 1), end), "the file ends without an icon", help)
        findings = sorted((*syntax, *self.builder.findings), key=lambda finding: finding.start)
        if findings or more:
            return Analysis(None, tuple(findings), more)
        frame = Frame(self.control or "skin", self.baseline, self.site)
        icons = tuple(
            Icon(draft.name or "", cast(tuple[Statement, ...], draft.body), frame, draft.metadata) for draft in drafts
        )
        return Analysis(IconSet(self.name, self.title, frame, self.metadata, icons), (), 0)

    def version(self, parts: list[Any], kinds: list[str]) -> None:
        help = "the first line of every file is: cue 1"
        found = [part for part, kind in zip(parts, kinds, strict=True) if kind == "version"]
        for place, part in enumerate(found):
            number = part.children[0]
            if str(number) != "1":
                what = f"this is version 1 of the language, not {str(number)[:20]}"
                self.builder.add("E010", span(number), what, help, Edit(*span(number), "1"))
            if place:
                line, _ = self.source.place(span(found[0])[0])
                self.builder.add("E213", span(part), f"the version stands on line {line} already", "keep the first")
        if found and kinds[0] not in ("version", "broken"):
            self.builder.add("E214", span(found[0]), "the version comes after something else", help)
        if not found and kinds[:1] != ["broken"]:
            first = span(parts[0])[0] if parts else 0
            line = self.source.starts[self.source.place(first)[0] - 1]
            end = line + len(self.source.lines[self.source.place(first)[0] - 1])
            what = "the language's version is not said before this"
            self.builder.add("E009", (first, end), what, help, Edit(0, 0, "cue 1\n"))

    def set_block(self, parts: list[Any], kinds: list[str]) -> None:
        first: Any = None
        for part, kind in zip(parts, kinds, strict=True):
            if kind != "set":
                continue
            word = (span(part)[0], span(part)[0] + 3)
            if first is not None:
                line, _ = self.source.place(span(first)[0])
                self.builder.add("E212", word, f"a set stands on line {line} already", "a file is one set")
                continue
            first = part
            if "icon" in kinds[: parts.index(part)]:
                self.builder.add("E214", word, "the set comes after an icon", "put the set above the first icon")
            self.settings(part)

    def settings(self, tree: Any) -> None:
        seen: dict[str, int] = {}
        metadata = []
        for part in tree.children:
            rule = str(getattr(part, "data", part.type if hasattr(part, "type") else ""))
            if rule == "NAME":
                self.name = str(part)
            elif rule == "TITLE":
                self.title = self.builder.text(part) or ""
                self.title = self.title if self.title.strip() else ""
            elif rule == "metadata":
                metadata.append(part)
            elif rule != "BROKEN" and rule in seen:
                line, _ = self.source.place(seen[rule])
                self.builder.add("E213", span(part), f'"{rule}" stands on line {line} already', "keep one of them")
            elif rule != "BROKEN":
                seen[rule] = span(part)[0]
                self.setting(rule, part.children[0])
        if any(getattr(part, "type", "") == "BROKEN" for part in tree.children):
            self.control = self.control if "control" in seen else None
            self.baseline_known = self.baseline_known and "baseline" in seen
        self.metadata = self.builder.metadata(metadata)

    def setting(self, rule: str, value: Any) -> None:
        if rule == "site":
            self.site = str(value)
        elif rule == "control":
            self.control = cast(Control | None, self.builder.choice(value, CONTROLS, "E215", "a control"))
        else:
            level = self.builder.quantity(value)
            self.baseline_known = level == level
            self.baseline = level if self.baseline_known else None

    def names(self, drafts: list[IconDraft]) -> None:
        first: dict[str, Place] = {}
        for draft in drafts:
            if draft.name is None:
                continue
            if draft.name in first:
                line, _ = self.source.place(first[draft.name][0])
                free = next(name for n in range(2, 10**6) if (name := f"{draft.name}-{n}") not in first)
                what = f"line {line} has an icon of this name already"
                self.builder.add("E211", draft.place, what, "each icon has a name of its own", Edit(*draft.place, free))
            first.setdefault(draft.name, draft.place)

    def meaning(self, drafts: list[IconDraft]) -> None:
        total = 0
        for draft in drafts:
            corners = corner_count(draft.body)
            if corners <= MOST_CORNERS:
                total += corners
            if total > MOST_CORNERS_A_FILE:
                what = f"written out, the icons up to here have {total:,} corners"
                help = f"a file has at most {MOST_CORNERS_A_FILE:,} corners"
                self.builder.add("E220", draft.place, what, help)
                return
            if self.control is None:
                continue
            self.returns(draft.body)
            for problem in problems(draft.body, self.control, self.rest()):
                self.add(problem, draft)

    def rest(self) -> Fraction | None:
        if self.control == "current":
            return Fraction(0)
        if not self.baseline_known:
            return None
        return exact(ASSUMED_BASELINE_C if self.baseline is None else self.baseline, "absolute")

    def returns(self, body: tuple[Any, ...]) -> None:
        wrong, right = ("rate", "A/s") if self.control == "current" else ("current_rate", "°C/s")
        for part in body:
            if isinstance(part, Repeat):
                self.returns(part.body)
            elif isinstance(part, Return) and (place := self.builder.places[id(part)].get(wrong)):
                what = f"this set controls the {self.control}"
                self.builder.add(
                    "E210", place, what, f'a rate in {right}, such as "return at 1 {right}"', Edit(*place, f"1 {right}")
                )

    def add(self, problem: Problem, draft: IconDraft) -> None:
        places = self.builder.places[id(problem.statement)] if problem.statement else {"name": draft.place}
        place = places.get(problem.part, places.get("whole", draft.place))
        cures = tuple(Edit(*places[part], text) for part, text in problem.cures if part in places)
        self.builder.add(problem.code, place, problem.what, problem.help, *cures)

"""Assembly of an icon set from the syntax tree."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod
from typing import Any, cast

from ..model.check import ASSUMED_BASELINE_C, MOST_CORNERS, Problem, corner_count, survey
from ..model.context import Context, Metadata, elements_fault
from ..model.errors import MOST_ERRORS
from ..model.family import FEWER, MOST_MEMBERS, Family
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.members import MOST_EFFORT, MOST_FAILING, FailedMember, MemberErrors, effort
from ..model.parameter import path_of, statement_at
from ..model.spatial import SpatialIcon, bodies_of
from ..model.statements import Broken, Repeat, Return, Statement
from ..model.units import Control, exact
from ..model.words import CONTROLS, nearest
from .bodies import IconDraft, icon_draft
from .build import Builder, Place, span
from .recover import DEEPEST, read
from .source import Finding, Patch, Source

Body = tuple[Statement, ...]
# Of all icons of a file, written out: two of the longest.
MOST_CORNERS_A_FILE = 200_000

REFUSES = "a total refuses the file and leaves no member out: change the range, or the total"


@dataclass(frozen=True, slots=True)
class Analysis:
    """Either the set, or the findings in the order of the text, with how many were not kept."""

    icons: IconSet | None
    findings: tuple[Finding, ...]
    more: int


def analyse(source: Source) -> Analysis:
    """Parse and check a source; never raises."""
    return _Assembler(source).run(*read(source))


class _Assembler:
    def __init__(self, source: Source) -> None:
        self.source = source
        self.builder = Builder(source)
        self.name = self.title = ""
        self.metadata = Metadata()
        self.site: str | None = None
        self.elements: tuple[str, ...] | None = ()
        # None below means "not readable", so that one mistake does not draw others after it.
        self.control: Control | None = "skin"
        self.baseline: float | None = None
        self.baseline_known = True
        self.trees: list[Any] = []
        self.index: dict[str, int] = {}
        self.drafts: dict[int, IconDraft] = {}
        self.icons: dict[int, Icon | Family | None] = {}
        self.spatial: list[SpatialIcon] = []
        self.playing: list[int] = []
        self.corners = self.members = self.effort = 0
        self.unread = False

    def run(self, tree: Any, syntax: tuple[Finding, ...], more: int) -> Analysis:
        parts, self.unread = tree.children, bool(syntax)
        kinds = [getattr(part, "data", "broken") for part in parts]
        self.version(parts, kinds)
        self.set_block(parts, kinds)
        self.trees = [part for part, kind in zip(parts, kinds, strict=True) if kind == "icon"]
        for place, icon_tree in enumerate(self.trees):
            self.index.setdefault(str(icon_tree.children[0]), place)
        made = [self.made(place) for place in range(len(self.trees))]
        drafts = [self.drafts[place] for place in range(len(self.trees))]
        self.names(drafts)
        if not drafts and "broken" not in kinds:
            end = len(self.source.text.rstrip())
            help = "add one: icon my-icon { cool by 6 °C at 3 °C/s; return at 3 °C/s }"
            self.builder.add("E008", (max(0, end - 1), end), "the file ends without an icon", help)
        findings = sorted((*syntax, *self.builder.findings), key=lambda finding: finding.start)
        if findings or more:
            return Analysis(None, tuple(findings), more)
        icons = tuple(icon for icon in made if icon is not None)
        spatial = tuple(self.spatial)
        return Analysis(IconSet(self.name, self.title, self.context(), self.metadata, icons, spatial), (), 0)

    def context(self) -> Context:
        return Context(self.control or "skin", self.baseline, self.site, self.elements or ())

    def version(self, parts: list[Any], kinds: list[str]) -> None:
        help = "the first line of every file is: cue 1"
        found = [part for part, kind in zip(parts, kinds, strict=True) if kind == "version"]
        for place, part in enumerate(found):
            number = part.children[0]
            if str(number) != "1":
                what = f"this is version 1 of the language, not {str(number)[:20]}"
                self.builder.add("E010", span(number), what, help, Patch(*span(number), "1"))
            if place:
                line, _ = self.source.place(span(found[0])[0])
                self.builder.add("E213", span(part), f"the version is already on line {line}", "keep the first")
        if found and kinds[0] not in ("version", "broken"):
            self.builder.add("E214", span(found[0]), "the version comes after something else", help)
        if not found and kinds[:1] != ["broken"]:
            first = span(parts[0])[0] if parts else 0
            line = self.source.starts[self.source.place(first)[0] - 1]
            end = line + len(self.source.lines[self.source.place(first)[0] - 1])
            what = "the version of the language is missing before this"
            self.builder.add("E009", (first, end), what, help, Patch(0, 0, "cue 1\n"))

    def set_block(self, parts: list[Any], kinds: list[str]) -> None:
        first: Any = None
        for part, kind in zip(parts, kinds, strict=True):
            if kind != "set":
                continue
            word = (span(part)[0], span(part)[0] + 3)
            if first is not None:
                line, _ = self.source.place(span(first)[0])
                self.builder.add("E212", word, f"a set is already on line {line}", "a file is one set")
                continue
            first = part
            if "icon" in kinds[: parts.index(part)]:
                self.builder.add("E214", word, "the set comes after an icon", "put the set above the first icon")
            self.settings(part)

    def settings(self, tree: Any) -> None:
        seen: dict[str, int] = {}
        metadata, named = [], None
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
                self.builder.add("E213", span(part), f'"{rule}" is already on line {line}', "keep one of them")
            elif rule != "BROKEN":
                seen[rule], value = span(part)[0], part.children[0]
                if rule == "site":
                    self.site = str(value)
                elif rule == "elements":
                    self.elements = tuple(map(str, part.children))
                    named = part
                elif rule == "control":
                    self.control = cast(Control | None, self.builder.choice(value, CONTROLS, "E215", "a control"))
                else:
                    level = self.builder.quantity(value)
                    self.baseline_known = level == level
                    self.baseline = level if self.baseline_known else None
        if any(getattr(part, "type", "") == "BROKEN" for part in tree.children):
            self.control = self.control if "control" in seen else None
            self.baseline_known = self.baseline_known and "baseline" in seen
            self.elements = self.elements or None
        if named is not None and (wrong := elements_fault(self.elements or (), self.control or "skin")):
            self.builder.add("E239", span(named), *wrong)
            self.elements = None  # not known, so that icons draw no errors after it
        self.metadata = self.builder.metadata(metadata)

    def names(self, drafts: list[IconDraft]) -> None:
        first: dict[str, Place] = {}
        for draft in drafts:
            if draft.name is None:
                continue
            head, mark, _ = draft.name.partition("_")
            own = self.icons.get(self.index.get(head, -1)) if mark else None
            if isinstance(own, Family) and draft.name in own:
                what = f"a member of family {head} has this name"
                self.builder.add("E211", draft.place, what, "each icon needs a different name")
            elif mark and draft.over is not None:
                what = f'"{draft.name}" is a name for a member of a family'
                self.builder.add(
                    "E113", draft.place, what, "a family has a name without underscores", Patch(*draft.place, head)
                )
            if draft.name in first:
                line, _ = self.source.place(first[draft.name][0])
                free = next(name for n in range(2, 10**6) if (name := f"{draft.name}-{n}") not in first)
                what = f"line {line} has an icon of this name already"
                self.builder.add(
                    "E211", draft.place, what, "each icon needs a different name", Patch(*draft.place, free)
                )
            first.setdefault(draft.name, draft.place)

    def made(self, place: int) -> Icon | Family | None:
        """Return the icon or family at a place in the file; None, and findings, when something is wrong with it."""
        if place not in self.icons:
            self.playing.append(place)
            self.drafts[place] = icon_draft(self.builder, self.trees[place], self.resolve, self.elements)
            self.icons[place] = self.meaning(self.drafts[place])
            self.playing.pop()
        return self.icons[place]

    def resolve(self, name: str, place: Place) -> Icon | None:
        """Return the icon that a ``play`` names; None, with a finding, when it cannot be played."""
        family, _, values = name.partition("_")
        known = name if name in self.index else family if values and family in self.index else None
        if known is None:
            few = len(self.builder.findings) < MOST_ERRORS  # beyond, errors are only counted
            close = nearest(name, list(self.index)) if few else None
            cures = (Patch(*place, close),) if close else ()
            self.builder.add(
                "E230", place, f'no icon is called "{name[:60]}"', "play names an icon of this file", *cures
            )
            return None
        index = self.index[known]
        if index in self.playing:
            names = [str(self.trees[n].children[0]) for n in self.playing[self.playing.index(index) :]]
            what = f"these icons play each other in a circle: {' plays '.join([*names, known])}"
            self.builder.add("E232", place, what, "an icon cannot play itself, nor one that plays it")
            return None
        if len(self.playing) > DEEPEST:
            what = f"icons play one another more than {DEEPEST} deep"
            self.builder.add("E115", place, what, "write the statements of the innermost icons out")
            return None
        found = self.made(index)
        if not isinstance(found, Family):
            return found
        member = found.find(name) if values else None
        if member is None:
            what = f"{known} is a family of {len(found):,} icons" + (", but this is not one of them" if values else "")
            cures = (Patch(*place, found[0].name),)
            self.builder.add("E230", place, what, f"play one of its members, such as {found[0].name}", *cures)
        return member

    def meaning(self, draft: IconDraft) -> Icon | Family | None:
        """Check what a draft means; return the icon or family, or None and findings."""
        before = len(self.builder.findings)
        if self.corners > MOST_CORNERS_A_FILE:
            return None
        corners = corner_count(draft.body)
        self.corners += corners if corners <= MOST_CORNERS else 0
        if draft.parts:
            self.corners += sum(corner_count(body.body) * len(body.names) for body in bodies_of(draft.parts))
        if self.corners > MOST_CORNERS_A_FILE:
            what = f"written out, the icons up to here have {self.corners:,} corners"
            self.builder.add("E220", draft.place, what, f"a file has at most {MOST_CORNERS_A_FILE:,} corners")
            return None
        if self.control is None:
            return None
        if self.elements:
            self.several(draft, before)
            return None
        self.returns(draft.body)
        wrong, right = ("rate", "A/s") if self.control == "current" else ("current_rate", "°C/s")
        for slot in draft.slots:
            if slot.field == "rate_per_s" and slot.kind == wrong:
                place = self.builder.places[id(statement_at(cast(Body, draft.body), slot.path))]
                what = f"{slot.parameter} is not a rate in {right}; this set controls the {self.control}"
                self.builder.add("E210", place["pace"], what, f"give {slot.parameter} the unit {right}")
        if draft.over is not None:
            return self.family(draft, before)
        for problem in survey(draft.body, self.control, self.rest()).problems:
            self.add(problem, draft)
        if len(self.builder.findings) > before or self.unsound(draft):
            return None
        return Icon(cast(str, draft.name), cast(Body, draft.body), self.context(), draft.metadata)

    def several(self, draft: IconDraft, before: int) -> None:
        """Check what an icon on several elements means; keep it, or add findings."""
        if draft.over is not None and not draft.over.unread and len(self.builder.findings) == before:
            what = "a family in a set with elements is not in this version"
            self.builder.add("E120", draft.place, what, "write each of its icons out")
        rest = self.rest()
        for body in bodies_of(draft.parts):
            self.returns(body.body)
            course = survey(body.body, cast(Control, self.control), rest)
            for problem in course.problems:
                self.add(problem, draft)
            if not course.problems and course.timed and course.level != rest:
                last = self.builder.places[id(body.body[-1])]["whole"]
                help = 'what elements play begins and ends at baseline: add a line such as "return at 3 °C/s"'
                cure = Patch(last[1], last[1], "; return at 3 °C/s")
                self.builder.add("E240", last, "this body ends away from baseline", help, cure)
        sound = draft.name is not None and draft.parts and not draft.unread and self.baseline_known
        if len(self.builder.findings) > before or not sound:
            return
        try:
            self.spatial.append(SpatialIcon(cast(str, draft.name), draft.parts, self.context(), draft.metadata))
        except ValueError as wrong:
            what, _, help = str(wrong).removeprefix(f"icon {draft.name} ").partition("; ")
            self.builder.add("E221", draft.place, f"this icon {what}", help)

    def family(self, draft: IconDraft, before: int) -> Family | None:
        """Return the family of a draft, every member checked; None, with findings, when one of them is not valid."""
        over = draft.over
        if over is None or over.unread or len(self.builder.findings) > before or self.unsound(draft):
            return None
        name, parameters, template = cast(str, draft.name), tuple(over.named.values()), cast(Body, draft.body)
        if "_" in name:  # such a name is refused with those of the other icons
            return None
        members = prod(map(len, parameters))
        self.members += members
        if self.members > MOST_MEMBERS:
            if self.members - members <= MOST_MEMBERS:
                what = f"the families up to here have {self.members:,} members"
                self.builder.add("E231", draft.place, what, f"a file has at most {MOST_MEMBERS:,}: {FEWER}")
            return None
        statements = effort(members, template, draft.slots)
        self.effort += statements
        if self.effort > MOST_EFFORT:
            if self.effort - statements <= MOST_EFFORT:
                what = f"{self.members:,} members have {self.effort:,} statements to check"
                help = f"a file has at most {MOST_EFFORT:,}: fewer members, statements or repeats, or several files"
                self.builder.add("E231", draft.place, what, help)
            return None
        try:
            return Family(name, parameters, template, draft.slots, self.context(), draft.metadata)
        except MemberErrors as error:
            self.add(self.member_problem(error.failed, members, template), draft)
        except ValueError:
            if not (self.unread or self.builder.findings):  # otherwise the reason has been reported already
                raise
        return None

    def member_problem(self, failed: FailedMember, members: int, template: Body) -> Problem:
        """Return what is wrong with a member as a problem of the template, with the values that it arises for."""
        which = failed.name.partition("_")[2].replace("_", ", ")
        least = "at least " if failed.failing == MOST_FAILING else ""
        many = f", one of {least}{failed.failing:,} such members of {members:,}" if failed.failing > 1 else ""
        problem = failed.problem
        statement = problem.statement
        if statement is not None:
            statement = statement_at(template, path_of(failed.statements, statement))
        help = f"{problem.help}; {REFUSES}" if problem.code == "E222" else problem.help
        return replace(problem, statement=statement, what=f"{problem.what} (with {which}{many})", help=help, cures=())

    def unsound(self, draft: IconDraft) -> bool:
        """Tell whether a draft cannot be made, although nothing was found to be wrong with what it says itself."""
        return draft.name is None or not draft.body or broken(draft.body) or not self.baseline_known

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
                what, cure = f"this set controls the {self.control}", Patch(*place, f"1 {right}")
                self.builder.add("E210", place, what, f'a rate in {right}, such as "return at 1 {right}"', cure)

    def add(self, problem: Problem, draft: IconDraft) -> None:
        # A statement of an icon that is played is reported where that icon stands.
        places = self.builder.places.get(id(problem.statement)) if problem.statement else {"name": draft.place}
        if places is None:
            return
        place = places.get(problem.part, places.get("whole", draft.place))
        cures = tuple(Patch(*places[part], text) for part, text in problem.cures if part in places)
        self.builder.add(problem.code, place, problem.what, problem.help, *cures)


def broken(body: Sequence[Statement | Broken]) -> bool:
    """Tell whether a statement of a body could not be read."""
    return any(isinstance(part, Broken) or (isinstance(part, Repeat) and broken(part.body)) for part in body)

"""What a paper says of a set of icons: a paragraph for its methods, with the course of every icon in words."""

import re
from collections.abc import Sequence
from importlib.metadata import version

from ..model.family import Family
from ..model.family_check import Summary
from ..model.format import Holes, Wording
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.parameter import Parameter, Path
from ..model.statements import (
    Broken,
    Current,
    Hold,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Statement,
    Step,
    Total,
    Wave,
)
from ..model.units import Control, Kind, decimal_text, quantity
from .references import cited, plain_doi, sources

_PRESCRIBED = {
    "skin": "the temperature of the skin surface",
    "display": "the temperature of the display",
    "current": "the drive current",
}
_MINUS = re.compile(r"(?<![\w.])-(?=[0-9])")
_RAMPS = {"warm": "warming", "cool": "cooling", "change": "a change"}
_SIDES = {"warm": " up", "cool": " down", "change": ""}
_COUNTS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]


def methods(icons: IconSet, rig_about: str | None = None) -> str:
    r"""Return a paragraph for the methods section of a paper: the set, every icon in words, and the sources.

    Parameters
    ----------
    icons
        The set.
    rig_about
        Description of the rig, such as ``Rig.about``; None: no rig is described.

    Returns
    -------
    str
        Plain text.

    Examples
    --------
    >>> from thermicon.icons import parse
    >>> text = methods(parse("cue 1; icon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s }"))
    >>> print(*text.split(". ")[:3], sep="\n")
    One thermal icon was used
    It prescribes the temperature of the skin surface
    It lasts 4 s
    """
    many, control = len(icons) > 1, icons.context.control
    title = f" of the set “{icons.title}”" if icons.title else ""
    count = counted(len(icons), "thermal icon")
    site = f" at the site “{icons.context.site}”" if icons.context.site else ""
    said = [
        f"{count[:1].upper()}{count[1:]}{title} {'were' if many else 'was'} used.",
        f"{'They prescribe' if many else 'It prescribes'} {_PRESCRIBED[control]}{site}{_baseline(icons)}.",
        f"{'They last' if many else 'It lasts'} {_lengths(icons)}.",
        f"{'Their courses' if many else 'Its course'}, from baseline: {'; '.join(map(_entry, icons.entries))}.",
    ]
    named = [f"{by or ''}{_doi(by, doi)}" for by, doi in sources(icons)]
    if named:
        said.append(f"Sources, as the set names them: {'; '.join(named)}.")
    unsure = [f"{each.surnames[0]} {each.year}" for each in cited(icons).references if each.unverified]
    if unsure:
        said.append(f"[Check before printing: details of {listed(unsure)} are unverified in the bibliography.]")
    if rig_about:
        said.append(f"The rig was modelled as follows: {_one_line(rig_about)}.")
    said.append(f"The icons are written in the cue language of thermicon {version('thermicon')}, ")
    return f"{' '.join(said)}content hash {icons.content_hash[:12]}."


def course(body: Sequence[Statement], control: Control, holes: Holes | None = None, path: Path = ()) -> str:
    """Return statements as one phrase; ``holes`` names the parameter that stands in a field, as in ``format``.

    >>> course((Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)), "skin")
    'cooling by 6 °C at 3 °C/s, a hold of 4 s and a return to baseline at 3 °C/s'
    """
    return _Course(control, holes or {}).body(body, path)


def counted(count: int, noun: str) -> str:
    """Return a number and a noun, in words up to twelve.

    >>> counted(1, "icon"), counted(6, "icon"), counted(240, "icon")
    ('one icon', 'six icons', '240 icons')
    """
    number = _COUNTS[count] if count < len(_COUNTS) else f"{count:,}"
    return f"{number} {noun}{'' if count == 1 else 's'}"


def listed(parts: Sequence[str]) -> str:
    """Return parts joined as a sentence lists them.

    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join(filter(None, (", ".join(parts[:-1]), *parts[-1:])))


class _Course(Wording):
    def body(self, body: "Sequence[Statement | Broken]", path: Path) -> str:
        phrases = (self.phrase(part, (*path, n)) for n, part in enumerate(body))
        return listed([phrase for phrase in phrases if phrase])

    def phrase(self, part: Statement | Broken, path: Path) -> str:
        match part:
            case Ramp(direction=word):
                return f"{_RAMPS[word]} {self.goal(part, path)} {self.pace(part, path)}"
            case Current():
                return f"a ramp {self.goal(part, path)} {self.pace(part, path)}"
            case Hold():
                return f"a hold of {self.value(part, path, 'duration_s', 'time')}"
            case Rest():
                return f"a rest of {self.value(part, path, 'duration_s', 'time')} at baseline"
            case Return():
                return f"a return to baseline {self.pace(part, path)}"
            case Step(direction=word):
                return f"a step{_SIDES[word]} {self.goal(part, path)}"
            case Pulse(direction=word):
                time = self.value(part, path, "duration_s", "time")
                return f"a pulse{_SIDES[word]} {self.goal(part, path)} for {time}"
            case Wave():
                size = self.goal(part, path).removeprefix("by ")
                period, time = (self.value(part, path, name, "time") for name in ("period_s", "duration_s"))
                shape = "sawtooth wave" if part.shape == "sawtooth" else f"{part.shape} wave"
                first = "upwards" if part.sign > 0 else "downwards"
                return f"a {shape} of ±{size} and a period of {period} for {time}, {first} first"
            case Play():
                return f"the course of {part.icon.name}"
            case Repeat():
                count = self.holes.get((path, "count"))
                if count is not None:
                    return f"{count} × ({self.body(part.body, path)})"
                return f"{part.count:,} times ({self.body(part.body, path)})"
            case Total() | Broken():
                return ""

    def value(self, part: object, path: Path, name: str, kind: Kind) -> str:
        text = super().value(part, path, name, kind)
        return text if (path, name) in self.holes else text.replace("-", "−", 1)


def _entry(entry: Icon | Family) -> str:
    means = f" (“{entry.metadata.means}”)" if entry.metadata.means else ""
    tags = f", tagged {listed([f'“{tag}”' for tag in entry.metadata.tags])}" if entry.metadata.tags else ""
    if isinstance(entry, Icon):
        words = course(entry.statements, entry.context.control)
        return f"{entry.name}{means}, {words} ({round(entry.corners().duration_s, 2):g} s{tags})"
    holes = {(slot.path, slot.field): slot.parameter for slot in entry.slots}
    words = course(entry.template, entry.context.control, holes)
    over = listed([_values(parameter) for parameter in entry.parameters])
    found = entry.summary()
    size = counted(len(entry), "icon")
    return f"{entry.name}{means}, a family of {size} over {over}: {words} ({_span(found)}{tags})"


def _values(parameter: Parameter) -> str:
    unit = f" {parameter.unit}" if parameter.unit else ""
    if parameter.span is None:
        said = listed(list(map(decimal_text, parameter.listed))) + unit
    else:
        low, high, step = map(decimal_text, parameter.span)
        said = f"{low} to {high}{unit} in steps of {step}{unit}"
    return f"{parameter.name} ({re.sub(_MINUS, '−', said)})"


def _span(found: Summary) -> str:
    low, high = f"{round(found.shortest_s, 2):g}", f"{round(found.longest_s, 2):g}"
    return f"{low} s" if low == high else f"{low} to {high} s"


def _baseline(icons: IconSet) -> str:
    level = icons.context.baseline_C
    if level is None:
        return ""
    rest = f"a baseline of {quantity(level, 'absolute')}"
    return f", on a display that rests at {rest}" if icons.context.control == "current" else f", from {rest}"


def _lengths(icons: IconSet) -> str:
    found = icons.summary()
    length = _span(found)
    if icons.context.control != "current" and icons.context.baseline_C is None:
        return length
    unit = "A" if icons.context.control == "current" else "°C"
    levels = re.sub(_MINUS, "−", f"{round(found.lowest, 2):g} to {round(found.highest, 2):g} {unit}")
    steep = f", at rates of up to {round(found.steepest_per_s, 2):g} {unit}/s" if found.steepest_per_s else ""
    return f"{length} and lie within {levels}{steep}" if len(icons) > 1 else f"{length} within {levels}{steep}"


def _doi(by: str | None, doi: str | None) -> str:
    return f"{', ' if by else ''}doi:{plain_doi(doi)}" if doi else ""


def _one_line(about: str) -> str:
    head, *rows = [row for row in about.splitlines() if row.strip()] or [""]
    out = head.strip()
    for row in rows:  # a row that is indented further goes on with the one before
        out += (" " if row.startswith(" " * 8) else "; ") + " ".join(row.split())
    return out.rstrip(".")

"""What a paper says of a set of icons: a paragraph for its methods, and BibTeX entries for its sources."""

import re
from importlib.metadata import version

from ..model.family import Family
from ..model.family_check import Summary
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.parameter import Parameter
from ..model.units import decimal_text, quantity
from .course import counted, course, listed
from .references import Cited, Reference, cited, plain_doi, sources

TITLE, AUTHORS, LICENCE = "thermicon: a workbench for thermal icons", "The thermicon authors", "MIT"
_PRESCRIBED = {
    "skin": "the temperature of the skin surface",
    "display": "the temperature of the display",
    "current": "the drive current",
}
_MINUS = re.compile(r"(?<![\w.])-(?=[0-9])")
_FIELDS = ("author", "title", "journal", "booktitle", "year", "volume", "number", "pages", "doi")
_ESCAPES = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
_ESCAPES |= {mark: "\\" + mark for mark in "&%$#_{}"}


def methods(icons: IconSet, rig_about: str | None = None) -> str:
    r"""Return a paragraph for the methods section of a paper: the set, every icon in words, and the sources.

    Parameters
    ----------
    icons
        The set.
    rig_about
        Description of the rig, from ``Rig.about``; None: no rig is described.

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


def bibtex(icons: IconSet) -> str:
    """Return BibTeX entries for the sources of a set and its icons, and for thermicon itself.

    Parameters
    ----------
    icons
        The set.

    Returns
    -------
    str
        Entries in UTF-8, from the shipped bibliography; a note names what is unverified. A source that the bibliography
        lacks becomes an ``@misc`` entry from the metadata of the set, and is marked.

    Examples
    --------
    >>> from thermicon.icons import read_cue
    >>> [line for line in bibtex(read_cue("six-icons")).splitlines() if line.startswith("@")]
    ['@inproceedings{singhal-jones-2015,', '@article{singhal-jones-2018,', '@misc{thermicon,']
    """
    found = cited(icons)
    entries = [_known(each, found) for each in found.references]
    entries += [_unknown(place, *each) for place, each in enumerate(found.unknown, start=1)]
    own = f"Computer program, version {version('thermicon')}, {LICENCE} licence"
    entries.append(_written("misc", "thermicon", {"author": f"{{{AUTHORS}}}", "title": f"{{{TITLE}}}", "note": own}))
    return "\n".join(entries)


def escaped(text: str) -> str:
    r"""Return a text in which the characters that mean something to TeX stand for themselves.

    >>> print(escaped("50 % & more_or_less"))
    50 \% \& more\_or\_less
    """
    return " ".join("".join(_ESCAPES.get(char, char) for char in text).split())


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


def _known(each: Reference, found: Cited) -> str:
    values = {name: str(value) for name in _FIELDS if (value := getattr(each, name)) is not None}
    marks = [f"details unverified: {each.unverified}"] if each.unverified else []
    marks += ["the cue set does not state the year"] if each.key in found.undated else []
    made = {name: value if name == "doi" else escaped(value) for name, value in values.items()}
    made["title"] = f"{{{made['title']}}}"
    if "pages" in made:
        made["pages"] = made["pages"].replace("-", "--")
    return _written(each.type, each.key, {**made, **({"note": escaped("; ".join(marks))} if marks else {})})


def _unknown(place: int, by: str, doi: str | None) -> str:
    note = "As the cue set names it; not in the bibliography of thermicon, details unverified"
    values = {"howpublished": escaped(by)} if by.strip() else {}
    if doi:
        values["doi"] = escaped(plain_doi(doi)).replace(r"\_", "_")
    year = re.search(r"\b(?:19|20)[0-9]{2}\b", by)
    if year:
        values["year"] = year[0]
    return _written("misc", f"source-{place}", {**values, "note": note})


def _written(kind: str, key: str, values: dict[str, str]) -> str:
    rows = [f"  {name} = {{{value}}}," for name, value in values.items()]
    return "\n".join([f"@{kind}{{{key},", *rows, "}"]) + "\n"

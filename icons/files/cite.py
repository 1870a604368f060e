"""The methods paragraph about a set for a paper."""

import re
from collections.abc import Mapping, Sequence
from importlib import resources
from importlib.metadata import version

from ..model.family import Family
from ..model.format import statement_text
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.units import quantity

_PRESCRIBED = {
    "skin": "the temperature of the skin surface",
    "display": "the temperature of the display",
    "current": "the drive current",
}
_COUNTS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]
_MINUS = re.compile(r"(?<![\w.])-(?=[0-9])")
_ENTRY = re.compile(r"@(?P<type>[a-z]+)\{(?P<key>[a-z0-9-]+),\n(?P<fields>(?:  .*\n)*)\}")
_FIELD = re.compile(r"  ([a-z]+) = \{(.*)\},\n")
_YEAR = re.compile(r"\b(?:19|20)[0-9]{2}\b")
_RESOLVER = re.compile(r"^(?:https?://(?:dx\.)?doi\.org/|doi:)\s*", re.IGNORECASE)

YEAR = "2026"
"""Of the release, as in ``CITATION.cff``."""
Reference = Mapping[str, str]
"""A publication: its ``key``, ``type`` and BibTeX fields, where they were ``seen``, and what is ``unverified``."""
Source = tuple[str | None, str | None]
"""The ``by`` and the ``doi`` of a set or an icon."""


def methods(icons: IconSet, rig_about: str | None = None, people: str = "") -> str:
    """Return two paragraphs for the methods section of a paper: the icons with their sources, and the prediction.

    ``rig_about`` describes the rig, as ``Rig.about`` does, and ``people`` who is predicted to feel; empty: not told.
    """
    icons.check_one_element()
    many, control = len(icons) > 1, icons.context.control
    title = f" of the set “{icons.title}”" if icons.title else ""
    count = counted(len(icons), "thermal icon")
    site = f" at the site “{icons.context.site}”" if icons.context.site else ""
    if (level := icons.context.baseline_C) is not None:
        site += ", on a display that rests at" if control == "current" else ", from"
        site += f" a baseline of {quantity(level, 'absolute')}"
    said = [
        f"{count[:1].upper()}{count[1:]}{title} {'were' if many else 'was'} used.",
        f"{'They prescribe' if many else 'It prescribes'} {_PRESCRIBED[control]}{site}.",
        f"{'They last' if many else 'It lasts'} {_lengths(icons)}.",
        f"{'Their courses' if many else 'Its course'}, from baseline: {'; '.join(map(_course, icons.entries))}.",
    ]
    if named := sources(icons):
        texts = (", ".join(filter(None, (by, doi and f"doi:{plain_doi(doi)}"))) for by, doi in named)
        said.append(f"Sources, as the set names them: {'; '.join(texts)}.")
    unsure = [f"{surnames(each)[0]} {each['year']}" for each in cited(icons) if "unverified" in each]
    if unsure:
        said.append(f"[Check before printing: details of {', '.join(unsure)} are unverified in the bibliography.]")
    by = f"by thermicon {version('thermicon')}{people and f' for {people}'}"
    second = [f"Temperatures, detection and confusions of the icons are *predicted*, not measured, {by}."]
    if rig_about:
        second.append(f"The rig was modelled as follows: {_one_line(rig_about)}.")
    second.append(f"The icons are written in the cue language, content hash {icons.content_hash[:12]}.")
    return f"{' '.join(said)}\n\n{' '.join(second)}"


def bibtex(icons: IconSet) -> str:
    """Return BibTeX of the software and of what a set cites; of a DOI that the bibliography lacks, what is known.

    >>> from thermicon.icons import load_library
    >>> print(bibtex(load_library("six-icons")).partition(",")[0])
    @software{thermicon
    """
    own = {"title": "{thermicon}: a workbench for thermal icons", "author": "{The thermicon authors}", "year": YEAR}
    entries: list[Reference] = [{"type": "software", "key": "thermicon", **own, "version": version("thermicon")}]
    entries += cited(icons)
    known = {each.get("doi", "").lower() for each in entries}
    dois = {plain_doi(doi): by or "" for by, doi in sources(icons) if doi}
    entries += [
        {"type": "misc", "key": re.sub(r"\W+", "-", doi), "note": by, "doi": doi}
        for doi, by in dois.items()
        if doi.lower() not in known
    ]
    blocks, about = [], ("type", "key", "seen", "unverified")
    for each in entries:
        lines = [f"  {name} = {{{text}}},\n" for name, text in each.items() if name not in about and text]
        doubt = f"% to be checked: {each['unverified']}\n" if "unverified" in each else ""
        blocks.append(f"{doubt}@{each['type']}{{{each['key']},\n{''.join(lines)}}}")
    return "\n\n".join(blocks)


def counted(count: int, noun: str) -> str:
    """Return a number and a noun, in words up to twelve.

    >>> counted(1, "icon"), counted(6, "icon"), counted(240, "icon")
    ('one icon', 'six icons', '240 icons')
    """
    number = _COUNTS[count] if count < len(_COUNTS) else f"{count:,}"
    return f"{number} {noun}{'' if count == 1 else 's'}"


def _course(entry: Icon | Family) -> str:
    notes = [f"“{entry.metadata.means}”"] if entry.metadata.means else []
    notes += [f"tagged {', '.join(entry.metadata.tags)}"] if entry.metadata.tags else []
    head = f"{entry.name} ({'; '.join(notes)})" if notes else entry.name
    holes = {}
    if isinstance(entry, Family):
        holes = {(slot.path, slot.field): slot.parameter for slot in entry.slots}
        head += f", a family of {counted(len(entry), 'icon')} over {' and '.join(map(str, entry.parameters))}"
    body = entry.template if isinstance(entry, Family) else entry.statements
    lines = [statement_text(part, entry.context.control, "", holes, (n,)) for n, part in enumerate(body)]
    words = ", ".join(" ".join(line.split()) for text in lines for line in text.split("\n"))
    words = words.replace("{,", "{").replace(", }", " }")
    return _MINUS.sub("−", f"{head}: {words}")


def _lengths(icons: IconSet) -> str:
    found = icons.summary()
    low, high = f"{round(found.shortest_s, 2):g}", f"{round(found.longest_s, 2):g}"
    length = f"{low} s" if low == high else f"{low} to {high} s"
    if icons.context.control != "current" and icons.context.baseline_C is None:
        return length
    unit = "A" if icons.context.control == "current" else "°C"
    levels = _MINUS.sub("−", f"{round(found.lowest, 2):g} to {round(found.highest, 2):g} {unit}")
    steep = f", at rates of up to {round(found.steepest_per_s, 2):g} {unit}/s" if found.steepest_per_s else ""
    return f"{length} and lie within {levels}{steep}" if len(icons) > 1 else f"{length} within {levels}{steep}"


def _one_line(about: str) -> str:
    head, *rows = [row for row in about.splitlines() if row.strip()] or [""]
    out = head.strip()
    for row in rows:  # a row that is indented further goes on with the one before
        out += (" " if row.startswith(" " * 8) else "; ") + " ".join(row.split())
    return out.rstrip(".")


def references() -> tuple[Reference, ...]:
    """Return the bibliography that ships, one field a line in the file."""
    text = resources.files("thermicon.icons").joinpath("data/references.bib").read_text(encoding="utf-8")
    entries = _ENTRY.finditer(text)
    return tuple({"key": each["key"], "type": each["type"], **dict(_FIELD.findall(each["fields"]))} for each in entries)


def surnames(each: Reference) -> list[str]:
    """Return the last names of the authors of a publication, in order."""
    return [author.split()[-1] for author in each["author"].split(" and ")]


def sources(icons: IconSet) -> tuple[Source, ...]:
    """Return the different pairs of ``by`` and ``doi`` of a set and its icons, in order."""
    found = (icons.metadata, *(entry.metadata for entry in icons.entries))
    return tuple(dict.fromkeys((each.by, each.doi) for each in found if each.by or each.doi))


def cited(icons: IconSet) -> list[Reference]:
    """Publications that a set cites: by a DOI, or in ``by`` a first name with a year, or two first last names."""
    found: dict[str, Reference] = {}
    for by, doi in sources(icons):
        if doi is not None:
            same = [each for each in references() if each.get("doi", "").lower() == plain_doi(doi).lower()]
        else:
            same = [each for each in references() if _names(by or "", each)]
        found.update({each["key"]: each for each in same})
    return [found[key] for key in sorted(found)]


def plain_doi(text: str) -> str:
    """Return a DOI without the address of a resolver.

    >>> plain_doi("https://doi.org/10.1145/2858036.2858205")
    '10.1145/2858036.2858205'
    """
    return _RESOLVER.sub("", text.strip())


def _names(text: str, each: Reference) -> bool:
    years = set(_YEAR.findall(text))
    needed: Sequence[str] = surnames(each)[: 1 if years else 2]
    said = all(re.search(rf"\b{re.escape(name)}\b", text, re.IGNORECASE) for name in needed)
    return said and (not years or each["year"] in years)

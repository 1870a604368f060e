"""The bibliography that ships with the icon sets, which of it a set cites, and that as BibTeX entries."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from importlib.metadata import version

from ..model.context import Metadata
from ..model.iconset import IconSet

TYPES = ("article", "inproceedings", "book", "phdthesis", "misc")
_HEAD = re.compile(r"@([a-z]+)\{([a-z0-9-]+),")
_FIELD = re.compile(r"([a-z]+) = \{(.*)\},")
_DOI = re.compile(r"10\.[0-9]{4,9}/\S+")
_YEAR = re.compile(r"\b(?:19|20)[0-9]{2}\b")
_RESOLVER = re.compile(r"^(?:https?://(?:dx\.)?doi\.org/|doi:)\s*", re.IGNORECASE)

TITLE, AUTHORS, LICENCE = "thermicon: a workbench for thermal icons", "The thermicon authors", "MIT"
_FIELDS = ("author", "title", "journal", "booktitle", "year", "volume", "number", "pages", "doi")
_ESCAPES = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
_ESCAPES |= {mark: "\\" + mark for mark in "&%$#_{}"}


class BibliographyError(ValueError):
    """An invalid bibliography; the message names the file, the entry, the key and the cure."""


@dataclass(frozen=True, slots=True)
class Reference:
    """A publication: BibTeX fields in TeX's spelling, where they were ``seen``, and what of them is ``unverified``.

    Raises BibliographyError for an unknown type, an empty text, a year or an invalid DOI.
    """

    key: str
    type: str
    author: str
    title: str
    year: str
    seen: str
    journal: str | None = None
    booktitle: str | None = None
    volume: str | None = None
    number: str | None = None
    pages: str | None = None
    doi: str | None = None
    unverified: str | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not value.strip():
                raise BibliographyError(f"{self.key}: {field.name} is an empty text; leave it out")
        if not re.fullmatch(_YEAR, self.year):
            raise BibliographyError(f"{self.key}: year = {self.year!r} must be a year such as 2018")
        if self.type not in TYPES:
            raise BibliographyError(f"{self.key}: type = {self.type!r} must be one of {', '.join(TYPES)}")
        if self.doi is not None and not _DOI.fullmatch(self.doi):
            raise BibliographyError(
                f"{self.key}: doi = {self.doi!r} is not a DOI, such as 10.3390/bioengineering10101156"
            )

    @property
    def surnames(self) -> tuple[str, ...]:
        """The last names of the authors, in order."""
        return tuple(author.split()[-1] for author in self.author.split(" and "))


@dataclass(frozen=True, slots=True)
class Cited:
    """What a set cites: publications of the bibliography, and texts with DOIs (or None) that are not in it.

    ``undated`` holds the keys of publications that were cited without a year.
    """

    references: tuple[Reference, ...]
    unknown: tuple[tuple[str, str | None], ...]
    undated: frozenset[str]


@cache
def references() -> tuple[Reference, ...]:
    """Return the bibliography that ships.

    >>> next(each.doi for each in references() if each.key == "shani-lineykin-2025")
    '10.3390/bioengineering12020209'
    """
    file = resources.files("thermicon.icons").joinpath("data/references.bib")
    return read_references(file.read_text(encoding="utf-8"), "references.bib")


def read_references(text: str, where: str) -> tuple[Reference, ...]:
    """Return the entries of a BibTeX text with one field a line; BibliographyError names the line and the cure."""
    entries: list[dict[str, str]] = []
    names = [field.name for field in fields(Reference)]
    for number, line in enumerate(map(str.strip, text.splitlines()), start=1):
        if head := _HEAD.fullmatch(line):
            entries.append({"type": head[1], "key": head[2]})
        elif (field := _FIELD.fullmatch(line)) and entries and field[1] in names and field[1] not in entries[-1]:
            entries[-1][field[1]] = field[2]
        elif line not in ("", "}") and not line.startswith("%"):
            raise BibliographyError(
                f"{where}:{number}: {line[:60]!r} is neither the head of an entry, @article{{key, nor a field,"
                f" name = {{text}}, that stands once; fields are: {', '.join(names[2:])}"
            )
    for name in ("author", "title", "year", "seen"):
        for entry in entries:
            if name not in entry:
                raise BibliographyError(
                    f"{where}: {entry['key']}: {name} is missing; without it an entry does not load"
                )
    try:
        found = {entry["key"]: Reference(**entry) for entry in entries}
    except BibliographyError as problem:
        raise BibliographyError(f"{where}: {problem}") from None
    if len(found) < len(entries):
        raise BibliographyError(f"{where}: two entries have one key; give each a different one")
    return tuple(found.values())


def sources(icons: IconSet) -> tuple[tuple[str | None, str | None], ...]:
    """Return the different pairs of ``by`` and ``doi`` of a set and its icons, in order."""
    pairs = ((each.by, each.doi) for each in _metadata(icons) if each.by or each.doi)
    return tuple(dict.fromkeys(pairs))


def cited(icons: IconSet, known: Iterable[Reference] | None = None) -> Cited:
    """Return what a set cites of a bibliography, by default the one that ships.

    A DOI names a publication; so do the first author's last name and a year in ``by``. Without a year the first two
    last names must be there: publications that the set cites with a year are then meant, or else all of theirs.

    >>> from thermicon.icons import read_cue
    >>> [each.key for each in cited(read_cue("six-icons")).references]
    ['singhal-jones-2015', 'singhal-jones-2018']
    """
    listed = references() if known is None else tuple(known)
    found: dict[str, Reference] = {}
    unknown: list[tuple[str, str | None]] = []
    undated: dict[str, Reference] = {}
    for by, doi in sources(icons):
        if doi is not None:
            same = [each for each in listed if each.doi and each.doi.lower() == plain_doi(doi).lower()]
            dated = bool(same)
        else:
            dated = bool(_YEAR.search(by or ""))
            same = [each for each in listed if _names(by or "", each)]
        (found if dated else undated).update({each.key: each for each in same})
        if not same and (doi is not None or (by or "").strip().lower() != "thermicon"):
            unknown.append((by or "", doi))
    meant = {key: each for key, each in undated.items() if each.surnames[:2] not in _pairs(found.values())}
    only = frozenset(meant.keys() - found.keys())
    found.update(meant)
    return Cited(tuple(sorted(found.values(), key=lambda each: each.key)), tuple(unknown), only)


def plain_doi(text: str) -> str:
    """Return a DOI without the address of a resolver.

    >>> plain_doi("https://doi.org/10.1145/2858036.2858205")
    '10.1145/2858036.2858205'
    """
    return _RESOLVER.sub("", text.strip())


def _pairs(listed: Iterable[Reference]) -> set[tuple[str, ...]]:
    return {each.surnames[:2] for each in listed}


def _names(text: str, each: Reference) -> bool:
    years = set(_YEAR.findall(text))
    needed = each.surnames[: 1 if years else 2]
    said = all(re.search(rf"\b{re.escape(name)}\b", text, re.IGNORECASE) for name in needed)
    return said and (not years or each.year in years)


def _metadata(icons: IconSet) -> Iterator[Metadata]:
    yield icons.metadata
    for entry in icons.entries:
        yield entry.metadata


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


def _known(each: Reference, found: Cited) -> str:
    values = {name: value for name in _FIELDS if (value := getattr(each, name)) is not None}
    marks = [f"details unverified: {each.unverified}"] if each.unverified else []
    marks += ["the cue set does not state the year"] if each.key in found.undated else []
    return _written(each.type, each.key, {**values, **({"note": "; ".join(marks)} if marks else {})})


def _unknown(place: int, by: str, doi: str | None) -> str:
    note = "As the cue set names it; not in the bibliography of thermicon, details unverified"
    values = {"howpublished": escaped(by)} if by.strip() else {}
    if doi:
        values["doi"] = escaped(plain_doi(doi)).replace(r"\_", "_")
    year = _YEAR.search(by)
    if year:
        values["year"] = year[0]
    return _written("misc", f"source-{place}", {**values, "note": note})


def _written(kind: str, key: str, values: dict[str, str]) -> str:
    rows = [f"  {name} = {{{value}}}," for name, value in values.items()]
    return "\n".join([f"@{kind}{{{key},", *rows, "}"]) + "\n"

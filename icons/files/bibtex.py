"""BibTeX entries for the sources of a set of icons, and for thermicon itself."""

import re
from importlib.metadata import version

from ..model.iconset import IconSet
from .references import Cited, Reference, cited, plain_doi

TITLE, AUTHORS, LICENCE = "thermicon: a workbench for thermal icons", "The thermicon authors", "MIT"
_FIELDS = ("author", "title", "journal", "booktitle", "year", "volume", "number", "pages", "doi")
_ESCAPES = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
_ESCAPES |= {mark: "\\" + mark for mark in "&%$#_{}"}


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
    year = re.search(r"\b(?:19|20)[0-9]{2}\b", by)
    if year:
        values["year"] = year[0]
    return _written("misc", f"source-{place}", {**values, "note": note})


def _written(kind: str, key: str, values: dict[str, str]) -> str:
    rows = [f"  {name} = {{{value}}}," for name, value in values.items()]
    return "\n".join([f"@{kind}{{{key},", *rows, "}"]) + "\n"

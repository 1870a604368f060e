"""The sections of the site from the headings of docs/README.md."""

from __future__ import annotations

import re
from dataclasses import dataclass

MORE = {"start/index": ("Five minutes <five-minutes>", "[0-9]*"), "contribute/index": ("contributing", "changelog")}
"""Pages of a section that docs/README.md does not list: they stand elsewhere in the repository."""

ICONS = {
    "Start": "rocket",
    "How to": "tools",
    "Explain": "light-bulb",
    "Reference": "book",
    "Gallery": "image",
    "Contribute": "people",
}

WELCOME = """# thermicon

Write **thermal icons** as text, see what they do to display, skin and receptors, and predict which of them people
confuse, before anybody is heated or cooled. Everything here that looks like a result is a prediction, not a
measurement.

<!-- site: moving percept -->
<!-- end of site -->

::::{grid} 1 2 2 3
:gutter: 3

CARDS
::::

![Six icons: distances and predicted confusions](../images/six-icons.png)
"""


@dataclass(frozen=True, slots=True)
class Section:
    """One section: its heading, the sentences below it, and its list of pages as Markdown."""

    title: str
    about: str
    listing: str

    @property
    def index(self) -> str:
        """Source of the section's first page; a section of one page is that page."""
        links = self.links
        folder = re.sub(r"\W+", "-", self.title.lower())
        return links[0] if len(links) == 1 and "/" not in links[0] else f"{folder}/index.md"

    @property
    def links(self) -> list[str]:
        """Pages of the section, from docs/, in their order."""
        return re.findall(r"^- \[[^]]+\]\(([^)#]+)\)", self.listing, flags=re.MULTILINE)


def read_sections(text: str) -> list[Section]:
    """Return the sections of the index in their order.

    >>> [section.index for section in read_sections("# D\n\n## How to\n\nBy job.\n\n- [A](how-to/a.md): it.\n")]
    ['how-to/index.md']
    """
    sections = []
    for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title, _, body = part.partition("\n")
        about, _, listing = body.strip().partition("\n- ")
        sections.append(Section(title, about.strip(), f"- {listing}"))
    return sections


def front_page(sections: list[Section]) -> str:
    """Return the first page of the site: a card for each section."""
    cards = "\n".join(
        f":::{{grid-item-card}} {{octicon}}`{ICONS[section.title]};1.2em` {section.title}\n"
        f":link: {section.index.removesuffix('.md')}\n:link-type: doc\n\n{section.about}\n:::\n"
        for section in sections
    )
    return WELCOME.replace("CARDS", cards) + _toctree(
        [f"{section.title} <{section.index.removesuffix('.md')}>" for section in sections]
    )


def with_toctree(text: str, index: str, sections: list[Section]) -> str:
    """Return the first page of a section with the pages below it."""
    section = next(each for each in sections if each.index == index)
    folder, name = index.removesuffix(".md").rsplit("/", 1)
    entries = [link.removesuffix(".md").removeprefix(f"{folder}/") for link in section.links]
    pages = [each for each in entries if each != "README"]
    return text.rstrip() + "\n\n" + _toctree([*pages, *MORE.get(f"{folder}/{name}", ())], maxdepth=1)


def _toctree(entries: list[str], maxdepth: int = 2) -> str:
    return "\n".join(["", "```{toctree}", ":hidden:", ":glob:", f":maxdepth: {maxdepth}", "", *entries, "```", ""])

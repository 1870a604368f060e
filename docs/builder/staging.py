"""The source folder that Sphinx builds the site from."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from page_pictures import COLUMN, MARK, command_lines, page_picture
from pygments.lexers import get_lexer_by_name
from sections import front_page, read_sections, with_toctree

ROOT = Path(__file__).resolve().parents[2]
MOVED = {
    "README.md": "start/five-minutes.md",
    "CONTRIBUTING.md": "contribute/contributing.md",
    "CHANGELOG.md": "contribute/changelog.md",
    "docs/README.md": "index.md",
    "docs/start/README.md": "start/index.md",
    "docs/contribute/README.md": "contribute/index.md",
}
"""Where pages of the repository stand on the site, apart from those that only lose their `docs/`."""

LINK = re.compile(r"(?P<before>\]\()(?P<target>(?!\w+:)[^)\s#]+)(?P<anchor>#[^)\s]*)?(?=\))")
FENCE = re.compile(r"^(?P<indent> *)```(?P<kind>[\w{}-]*)\n.*?^ *```", re.MULTILINE | re.DOTALL)
NO_LEXER = ("", "csv", "cue")
"""Languages of blocks that a code host colours and Pygments does not know, or none."""
SLOT = re.compile(r"<!-- site: (?P<name>[\w ]+) -->\n(?P<meanwhile>.*?)<!-- end of site -->\n?", re.DOTALL)
"""What only the site has, made from the program; a code host shows the sentences between the marks instead."""
HEADINGS = re.compile(r"\A(?:#+ .+\n\n)*")
"""What stands above the first paragraph of a page, beside which its picture stands."""

NOT_SEARCHED = ("contribute/changelog.md", "reference/errors.md", "reference/refusals.md")
"""Pages with a little of everything: a search would name them before the page on what was asked."""


class StagingError(RuntimeError):
    """A page that cannot be put on the site: which one, and what is wrong with it."""


@dataclass(frozen=True, slots=True)
class Staging:
    """The folder of the site's sources, what fills its pages, where pictures are kept if any, and what was written."""

    folder: Path
    slots: dict[str, Callable[[], str]]
    pictures: Path | None = None
    written: set[str] = field(default_factory=set)

    def stage(self, more: dict[str, str]) -> None:
        """Write every source, and more pages by name; what is as before keeps its time and is not read again."""
        self.written.clear()
        for path in notebooks():
            text = path.read_text(encoding="utf-8")
            lexer = '"language_info": {"pygments_lexer": "ipython3",'
            self.write(f"start/{path.name}", text.replace('"language_info": {', lexer, 1))
        sections = read_sections((ROOT / "docs" / "README.md").read_text(encoding="utf-8"))
        for path in pages():
            where = PurePosixPath(path.relative_to(ROOT).as_posix())
            here, text = staged(where), path.read_text(encoding="utf-8")
            if where.name == "README.md" and where.parts[0] == "docs":
                text = front_page(sections) if len(where.parts) == 2 else with_toctree(text, str(here), sections)
            front = "---\nnosearch: true\n---\n\n" if str(here) in NOT_SEARCHED else ""
            self.write(str(here), front + self.filled(self.linked(text, where, here), where))
        for section in sections:
            if section.index not in self.written:
                text = f"# {section.title}\n\n{section.about}\n\n{section.listing}\n"
                text = self.linked(text, PurePosixPath("docs/README.md"), PurePosixPath(section.index))
                self.write(section.index, with_toctree(text, section.index, sections))
        for name, text in more.items():
            self.write(name, text)
        for left in sorted(self.folder.rglob("*")):
            if left.is_file() and left.relative_to(self.folder).as_posix() not in self.written:
                left.unlink()

    def write(self, name: str, content: str | bytes) -> None:
        """Write one source unless it is there already with this content."""
        path, content = self.folder / name, content.encode() if isinstance(content, str) else content
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)
        self.written.add(name)

    def filled(self, text: str, where: PurePosixPath) -> str:
        """Return a page with what the program makes in place of what a code host shows."""

        def content(slot: re.Match[str]) -> str:
            if slot["name"] not in self.slots:
                raise StagingError(f"{where}: there is no slot {slot['name']!r}, only {', '.join(sorted(self.slots))}")
            return self.slots[slot["name"]]().rstrip() + "\n"

        def picture(mark: re.Match[str]) -> str:
            if self.pictures is None:
                return ""
            drawn = page_picture(mark, text, self.pictures)
            self.write(f"pictures/{drawn.name}", drawn.read_bytes())
            lines = " && ".join(f"thermicon {line}" for line in command_lines(mark))
            beside = "beside" if COLUMN in lines else "across"
            figure = f"```{{figure}} /pictures/{drawn.name}\n:alt: {mark['alt']}\n:figclass: {beside}\n\n"
            figure += f"*{mark['alt']}*: `{lines}`\n```\n\n"
            above.append(figure)
            return ""

        above: list[str] = []
        text = MARK.sub(picture, SLOT.sub(content, text))
        start = HEADINGS.search(text)
        return text[: start.end()] + "".join(above) + text[start.end() :] if start else text

    def linked(self, text: str, where: PurePosixPath, here: PurePosixPath) -> str:
        """Return a page of the repository with links as they are on the site, and with blocks in colour."""
        parts, end = [], 0
        for fence in FENCE.finditer(text):
            block, kind = fence[0], fence["kind"]
            if kind in NO_LEXER:
                block = block.replace(f"```{kind}", "```text", 1)
            elif not kind.startswith("{") and kind != "math":
                get_lexer_by_name(kind)
            parts += [self._links(text[end : fence.start()], where, here), block]
            end = fence.end()
        return "".join([*parts, self._links(text[end:], where, here)])

    def _links(self, prose: str, where: PurePosixPath, here: PurePosixPath) -> str:
        def replaced(link: re.Match[str]) -> str:
            target = PurePosixPath(os.path.normpath(where.parent / link["target"]))
            if not (ROOT / target).is_file():
                raise StagingError(f"{where}: the link to {link['target']} leads to no file")
            there = staged(target)
            if target.suffix not in {".md", ".ipynb"}:
                self.write(str(there), (ROOT / target).read_bytes())
            nearer = os.path.relpath(there, here.parent).replace(os.sep, "/")
            return f"{link['before']}{nearer}{link['anchor'] or ''}"

        return LINK.sub(replaced, prose)


def pages() -> list[Path]:
    """Return every page of the repository that stands on the site."""
    front = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
    return [*front, *sorted((ROOT / "docs").rglob("*.md"))]


def notebooks() -> list[Path]:
    """Return the tutorials that the site shows, in their order."""
    return sorted((ROOT / "notebooks").glob("[0-9]*.ipynb"))


def staged(path: PurePosixPath) -> PurePosixPath:
    """Return where a file of the repository stands among the sources of the site.

    >>> str(staged(PurePosixPath("docs/how-to/simulate.md")))
    'how-to/simulate.md'
    >>> str(staged(PurePosixPath("README.md")))
    'start/five-minutes.md'
    >>> str(staged(PurePosixPath("LICENSE")))
    'files/LICENSE'
    """
    if str(path) in MOVED:
        return PurePosixPath(MOVED[str(path)])
    if path.parts[0] == "docs":
        return PurePosixPath(*path.parts[1:])
    if path.suffix == ".ipynb":
        return PurePosixPath("start", path.name)
    return path if path.parts[0] == "images" else PurePosixPath("files", path)

"""Icons of a cue text as wholes: a new one, a copy, another name, or none, with all other text as it is written."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise

from .cue_check import read_text

_PIECE = re.compile(r'"(?:[^"\\\n]|\\.)*"|#[^\r\n]*|[{};]|[^\W\d_](?:[^\W_]|-)*|\n')
_NAME = re.compile(r"[^\W\d_](?:[^\W_]|-)*")


class CannotEdit(ValueError):
    """An edit does not fit the text; the sentence says why, or what to do by hand."""


@dataclass(frozen=True, slots=True)
class Block:
    """Where an icon or a family stands in a text: from its comments to the end of its line, name and brace between."""

    name: str
    begin: int
    start: int
    name_at: int
    brace: int
    end: int


def blocks_of(text: str) -> list[Block]:
    """The icons and families of a text in order; what has no closing brace ends with the text.

    >>> [(block.name, text[block.begin : block.end]) for text in ["cue 1; icon a { hold for 1 s } # x"]
    ...  for block in blocks_of(text)]
    [('a', 'icon a { hold for 1 s } # x')]
    """
    found: list[Block] = []
    depth, start, name, name_at = 0, -1, "", -1
    for piece in _PIECE.finditer(text):
        word = piece[0]
        if word == "{":
            depth += 1
        elif word == "}":
            depth = max(0, depth - 1)
            if depth == 0 and start >= 0 and name_at >= 0:
                end = _line_end(text, piece.end())
                found.append(Block(name, _with_comments(text, start), start, name_at, piece.start(), end))
                start, name_at = -1, -1
        elif depth == 0 and word == "icon" and start < 0:
            start = piece.start()
        elif depth == 0 and start >= 0 and name_at < 0 and _NAME.fullmatch(word):
            name, name_at = word, piece.start()
    if start >= 0 and name_at >= 0:
        found.append(Block(name, _with_comments(text, start), start, name_at, len(text), len(text)))
    return found


def without(text: str, *icons: str) -> str:
    """A text without some icons, with the comments right above them gone too."""
    gone = [block_of(text, icon) for icon in icons]
    rest = text
    for block in sorted(gone, key=lambda each: -each.begin):
        rest = f"{rest[: block.begin].rstrip()}\n{_gap(rest[block.end :])}"
    for block in gone:
        if _plays(rest, block.name):
            raise CannotEdit(f"{block.name} is played by another icon: change that one first")
    return rest


def only(text: str, chosen: tuple[str, ...]) -> str:
    """A text with the chosen icons alone; a family of which only some are chosen is written out.

    >>> only("cue 1\\nicon a { hold for 1 s }\\n# b\\nicon b { hold for 2 s }\\n", ("a",))
    'cue 1\\nicon a { hold for 1 s }\\n'
    """
    icons = read_text(text).icons
    if icons is None:
        raise CannotEdit("the text has errors: mend them first")
    names = {icon.name for icon in icons.entries}
    if all(name in names for name in chosen):
        others = [entry.name for entry in icons.entries if entry.name not in chosen]
        try:
            return without(text, *others)
        except CannotEdit:
            pass  # an icon that goes is played by one that stays: written out, each stands for itself
    kept = [icon for name in chosen if (icon := icons.find(name)) is not None]
    try:
        return str(replace(icons, entries=tuple(kept)))
    except ValueError as wrong:
        raise CannotEdit(f"the chosen icons cannot stand alone: {wrong}") from None


def block_of(text: str, icon: str) -> Block:
    """Where an icon, or the family that writes it, stands; raises CannotEdit where it does not."""
    blocks = blocks_of(text)
    for block in blocks:
        if block.name == icon:
            return block
    family = read_text(text).family_of(icon)
    if family is not None:
        for block in blocks:
            if block.name == family.name:
                return block
    raise CannotEdit(f"no icon called {icon} is written in the text")


def _plays(text: str, name: str) -> list[int]:
    """Offsets at which a text plays an icon, outside of comments and quotes."""
    words = [piece for piece in _PIECE.finditer(text) if piece[0][0] not in '"#']
    pairs = pairwise(words)
    return [word.start() for before, word in pairs if before[0] == "play" and word[0] == name]


def _with_comments(text: str, start: int) -> int:
    """Where the comment lines right above a line begin; the place itself behind other statements of a line."""
    line = text.rfind("\n", 0, start) + 1
    if text[line:start].strip():
        return start
    while line > 0:
        above = text.rfind("\n", 0, line - 1) + 1
        if not text[above:line].lstrip().startswith("#"):
            break
        line = above
    return line


def _line_end(text: str, end: int) -> int:
    """The end of a line behind a block when only a comment or a semicolon follows there."""
    stop = text.find("\n", end)
    rest = text[end : len(text) if stop < 0 else stop]
    if rest.strip(" \t;") and not rest.strip().lstrip(";").lstrip().startswith("#"):
        return end + len(rest) - len(rest.lstrip(" \t;"))
    return len(text) if stop < 0 else stop + 1


def _gap(rest: str) -> str:
    """What follows a block, with one empty line between."""
    return f"\n{rest.lstrip(chr(10))}" if rest.strip() else ""

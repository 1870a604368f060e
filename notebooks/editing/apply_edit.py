"""An edit of an icon written into the text it stands in: one number, or a repeat around all that moves it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from thermicon.icons.model.statements import Repeat, Total

from .cue_check import read_text
from .icon_edits import CannotEdit, block_of
from .number_literals import keyword_of, kind_of, offset_of, replaced, written

if TYPE_CHECKING:
    from thermicon.icons import Icon

_COUNT = re.compile(r"repeat\s+([0-9]+)")


def with_edit(text: str, edited: Icon, old: str, new: str) -> str:
    """Return the text in which an icon is as edited; comments, and all that is not edited, stay as they are written.

    ``old`` and ``new`` are the lines that show the edit. Raises CannotEdit where the text has changed since, where a
    family writes the icon, or where the edit is more than one number or repeat.

    >>> from thermicon.icons import parse
    >>> from thermicon.perception.selection.icon_numbers import numbers_of, with_number
    >>> text = "cue 1\\nicon dip { cool by 6 °C at 3 °C/s; return at 3 °C/s } # deep"
    >>> icon = parse(text)["dip"]
    >>> with_edit(text, with_number(icon, numbers_of(icon, 32.0)[0], 6.5), "cool by 6 …", "cool by 6.5 …")
    'cue 1\\nicon dip { cool by 6.5 °C at 3 °C/s; return at 3 °C/s } # deep'
    """
    by_hand = f"change it by hand: in {edited.name}, {old} → {new}"
    reading = read_text(text)
    icon = reading.find(edited.name)
    if icon is None:
        raise CannotEdit(f"no icon is called {edited.name} now; {by_hand}")
    family = reading.family_of(edited.name)
    if family is not None:
        raise CannotEdit(f"{edited.name} is written by the family {family.name}, all of which would change; {by_hand}")
    for tried in _candidates(text, icon, edited):
        found = read_text(tried).find(edited.name)
        if found is not None and found.statements == edited.statements:
            return tried
    raise CannotEdit(f"the text has changed, or the edit does not fit it; {by_hand}")


def _candidates(text: str, icon: Icon, edited: Icon) -> Iterator[str]:
    moving = [part for part in icon.statements if not isinstance(part, Total)]
    first = edited.statements[0]
    if isinstance(first, Repeat) and first.body == tuple(moving):
        made = _repeated(text, icon, first.count)
        if made is not None:
            yield made
    edits = list(_numbers(text, icon.statements, edited.statements, icon.context.control))
    if len(edits) == 1:  # more than one: the text is not the one that the edit was found for
        yield replaced(text, dict(edits))


def _numbers(
    text: str, before: Sequence[Any], after: Sequence[Any], control: str
) -> Iterator[tuple[tuple[int, int], str]]:
    """Where the numbers that differ stand in the text, and what they become."""
    for old, new in zip(before, after, strict=False):
        if old == new or type(old) is not type(new) or old.span is None:
            continue
        if isinstance(old, Repeat):
            match = _COUNT.match(text, offset_of(text, old.span))
            if match is not None and old.count != new.count:
                yield match.span(1), str(new.count)
            yield from _numbers(text, old.body, new.body, control)
            continue
        place = written(text, old.span)
        for each in fields(old):
            value = getattr(new, each.name)
            if not each.compare or value == getattr(old, each.name) or not isinstance(value, float):
                continue
            amount = place.amounts.get(keyword_of(old, each.name))
            if amount is not None:
                yield (amount.start, amount.end), amount.exactly(value, kind_of(old, each.name, control))


def _repeated(text: str, icon: Icon, count: int) -> str | None:
    """The text with a repeat around the statements of an icon; None where they are not to be found."""
    parts = [part for part in icon.statements if not isinstance(part, Total)]
    if any(part.span is None for part in parts) or isinstance(icon.statements[0], Total):
        return None
    begin = offset_of(text, parts[0].span)  # type: ignore[arg-type]
    checks = [part for part in icon.statements if isinstance(part, Total) and part.span is not None]
    stop = offset_of(text, checks[0].span) if checks else block_of(text, icon.name).brace  # type: ignore[arg-type]
    head, body, tail = text[:begin], text[begin:stop], text[stop:]
    if "\n" not in body:
        return f"{head}repeat {count} {{ {body.strip().rstrip(';')} }}{'; ' if checks else ' '}{tail}"
    indent = head[head.rfind("\n") + 1 :]
    lines = body.rstrip().splitlines(keepends=True)
    inner = "".join([f"{indent}  {lines[0]}", *(f"  {line}" if line.strip() else line for line in lines[1:])])
    between = body[len(body.rstrip()) :]
    return f"{head}repeat {count} {{\n{inner}\n{indent}}}{between}{tail}"

"""Small pictures for notebooks: an icon, a family or a set as one SVG of a few kilobytes.

Text stays text, so that it can be searched and read aloud. There are no ids, no styles for the page and no date: many
pictures fit on one page without touching one another, and equal icons give equal bytes.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING

from ..drawn import Drawn
from ..model.family import Family
from ..model.icon import Icon
from ..model.iconset import IconSet
from .curve_style import (
    COLOURS,
    STAY,
    Direction,
    Points,
    chosen,
    directions,
    envelope,
    icon_count,
    shown,
    spread,
    ticks,
)

if TYPE_CHECKING:
    from ..model.corners import Corners

MOST_MEMBERS, MOST_PICTURES = 24, 12
_COLUMNS = 3
# Axes are shared while the largest of them is no more than this often the smallest; otherwise some would be flat.
_SHARED = 5.0
_BASELINE = "#8c8c8c"
_QUIET = "#595959"


@dataclass(frozen=True, slots=True)
class Curves:
    """What one picture draws: its curves, its extremes (°C or A), the longest duration (s), its words."""

    corners: tuple[Corners, ...]
    low: float
    high: float
    duration_s: float
    name: str
    lines: tuple[str, ...]
    axis: str


def picture(drawn: Drawn) -> str:
    """Return an icon, a family (up to 24 of its members, over one another) or a set (up to 12 pictures) as SVG.

    A curve with more pieces than the picture can show is drawn as the grey band that it fills.

    >>> from thermicon.icons import read_cue
    >>> len(picture(read_cue("six-icons")["cooling-step"])) < 3000
    True
    """
    if isinstance(drawn, IconSet):
        return _grid(drawn)
    if not isinstance(drawn, Icon | Family):
        raise TypeError(f"a {type(drawn).__name__} has no picture; an Icon, a Family or an IconSet has")
    curves = _curves(drawn, MOST_MEMBERS, alone=True)
    cell = _Cell(320, 196, 13, min(4, len(curves.lines)))
    return document(cell.width, cell.height, _label(curves), [cell.draw(curves)])


def thumbnail(entry: Icon | Family, width: int = 72, height: int = 34) -> str:
    """Return the bare curve of an icon, or up to 8 curves of a family, as a tiny SVG without axes."""
    curves = _curves(entry, 8)
    frame = _Frame.of(curves, 2, 2, width - 4, height - 4)
    return document(width, height, _label(curves), [_baseline(frame, curves), _paths(frame, curves, 2.0)])


def _grid(icons: IconSet) -> str:
    entries = icons.entries[:MOST_PICTURES]
    families = sum(isinstance(entry, Family) for entry in entries)
    # Few curves a family when there are many families, so that a picture of a set stays small.
    all_curves = _alike([_curves(entry, max(3, MOST_MEMBERS // max(1, families))) for entry in entries])
    found = icons.summary()
    unit = "A" if icons.context.control == "current" else "°C"
    count = icon_count(len(icons))
    control = f"control {icons.context.control}"
    baseline = "baseline not given, 32 °C assumed" if icons.context.control != "current" else "rest 0 A"
    if icons.context.baseline_C is not None:
        baseline = f"baseline {shown(icons.context.baseline_C)} °C"
    times, levels = spread(found.shortest_s, found.longest_s, "s"), spread(found.lowest, found.highest, unit)
    facts = [icons.name if icons.title else "", count, times, levels, control, baseline]
    columns = min(_COLUMNS, len(entries))
    cell = _Cell(232, 158, 12, min(1, max(len(curves.lines) for curves in all_curves)))
    width = max(columns * cell.width, 560)
    title = icons.title or icons.name or "unnamed set"
    subtitle = " · ".join(filter(None, facts))
    parts = [words(10, 20, title, 15, width - 20, bold=True), words(10, 37, subtitle, 11, width - 20, colour=_QUIET)]
    for place, curves in enumerate(all_curves):
        row, column = divmod(place, columns)
        x, y = column * cell.width, 46 + row * cell.height
        parts.append(f'<g transform="translate({x} {y})">{cell.draw(curves)}</g>')
    height = 46 + cell.height * -(-len(entries) // columns)
    if rest := len(icons) - sum(len(entry) if isinstance(entry, Family) else 1 for entry in entries):
        parts.append(words(10, height + 13, f"and {rest:,} more", 12, width - 20))
        height += 24
    return document(width, height, f"{title}: {count}", parts)


def _alike(all_curves: list[Curves]) -> list[Curves]:
    """Give the pictures of a set the same axes, where these do not differ too much in size."""
    longest = max(curves.duration_s for curves in all_curves)
    low, high = min(curves.low for curves in all_curves), max(curves.high for curves in all_curves)
    if longest <= _SHARED * min(curves.duration_s for curves in all_curves):
        all_curves = [replace(curves, duration_s=longest) for curves in all_curves]
    if high - low <= _SHARED * min(curves.high - curves.low for curves in all_curves):
        all_curves = [replace(curves, low=low, high=high) for curves in all_curves]
    return all_curves


def _curves(entry: Icon | Family, most: int, alone: bool = False) -> Curves:
    frame, means = entry.context, entry.metadata.means
    lines = [means] if means else []
    axis = "current (A)" if frame.control == "current" else f"{frame.control} (°C)"
    if alone and frame.control != "current" and frame.baseline_C is None:
        axis += ", baseline assumed"
    if not isinstance(entry, Family):
        one = _fine(entry)
        return Curves((one,), one.lowest, one.highest, one.duration_s, entry.name, tuple(lines), axis)
    places = chosen(tuple(map(len, entry.parameters)), most)
    drawn = f"{len(places)} drawn · " if len(places) < len(entry) else ""
    found = entry.summary()
    over = drawn + "; ".join(map(str, entry.parameters))
    name = f"{entry.name}: {icon_count(len(entry))}"
    corners = tuple(_fine(entry[place]) for place in places)
    return Curves(corners, found.lowest, found.highest, found.longest_s, name, (over, *lines), axis)


def _fine(icon: Icon) -> Corners:
    """Corners that follow a sine to half a pixel."""
    rough = icon.corners(tolerance=0.5)
    size = rough.highest - rough.lowest
    return icon.corners(tolerance=size / 140) if len(rough) > 4 and size > 0 else rough


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where curves are drawn: left, top, width and height in pixels, and the values at their ends."""

    x: float
    y: float
    width: float
    height: float
    duration_s: float
    low: float
    high: float

    @classmethod
    def of(cls, curves: Curves, x: float, y: float, width: float, height: float) -> _Frame:
        least = 0.1 if curves.corners[0].quantity == "current_A" else 1.0
        room = max(0.0, least - (curves.high - curves.low)) / 2
        return cls(x, y, width, height, curves.duration_s, curves.low - room, curves.high + room)

    def at(self, time_s: float, value: float) -> tuple[float, float]:
        down = (self.high - value) / (self.high - self.low)
        return round(self.x + time_s / self.duration_s * self.width, 1), round(self.y + down * self.height, 1)

    def crowded(self, corners: Corners) -> bool:
        """Whether a curve turns more than once in 4 pixels, or has more than two corners a pixel."""
        room = max(16.0, self.width * corners.duration_s / self.duration_s)
        if len(corners) - 1 <= room / 4:
            return False
        turns = sum(a != b for a, b in pairwise(directions(corners)))
        return turns > room / 4 or len(corners) > 2 * room


@dataclass(frozen=True, slots=True)
class _Cell:
    """One picture with name, words and axes: its size in pixels, the size of its letters, how many lines of words."""

    width: int
    height: int
    size: int
    lines: int

    def draw(self, curves: Curves) -> str:
        top = 18 + 14 * self.lines
        parts = [f"<title>{escape(plain(_label(curves)))}</title>"]
        parts.append(words(10, 16, curves.name, self.size, self.width - 18, bold=True))
        for n, line in enumerate(curves.lines[: self.lines]):
            parts.append(words(10, 31 + 14 * n, line, 11, self.width - 18, colour=_QUIET))
        frame = _Frame.of(curves, 46, top + 22, self.width - 64, self.height - top - 46)
        band = ", band: too fast to draw" if any(frame.crowded(one) for one in curves.corners) else ""
        parts.append(words(10, top + 12, curves.axis + band, 10, self.width - 18, colour=_QUIET))
        parts += [_axes(frame, curves), _baseline(frame, curves), _paths(frame, curves, 2.6)]
        return "".join(parts)


def _axes(frame: _Frame, curves: Curves) -> str:
    """Axes with exact numbers where it counts: baseline and extremes, round times and the duration."""
    left, bottom = frame.x - 6, frame.y + frame.height + 6
    marks, texts = [f"M{left:g} {frame.y:g}V{bottom:g}H{frame.x + frame.width:g}"], []
    levels = [curves.corners[0].value[0]]
    for level in (curves.low, curves.high):
        if all(abs(frame.at(0, level)[1] - frame.at(0, other)[1]) >= 11 for other in levels):
            levels.append(level)
    for level in levels:
        y = frame.at(0, level)[1]
        marks.append(f"M{left:g} {y:g}h-3")
        texts.append(f'<text x="{left - 5:g}" y="{y + 3.5:g}" text-anchor="end">{shown(level)}</text>')
    end = frame.x + frame.width
    last = f"{shown(frame.duration_s)} s"
    texts.append(f'<text x="{end + 12:g}" y="{bottom + 14:g}" text-anchor="end">{last}</text>')
    for time in ticks(frame.duration_s, 5):
        x = frame.at(time, frame.low)[0]
        marks.append(f"M{x:g} {bottom:g}v3")
        if x + 3 * len(shown(time)) < end + 4 - 6 * len(last):  # labels must not meet
            texts.append(f'<text x="{x:g}" y="{bottom + 14:g}" text-anchor="middle">{shown(time)}</text>')
    lines = f'<path d="{"".join(marks)}" stroke="{_BASELINE}" fill="none"/>'
    return f'{lines}<g font-size="10" fill="#333">{"".join(texts)}</g>'


def _baseline(frame: _Frame, curves: Curves) -> str:
    x, y = frame.at(0, curves.corners[0].value[0])
    return f'<path d="M{x:g} {y:g}h{frame.width:g}" stroke="{_BASELINE}" stroke-dasharray="4 3" fill="none"/>'


def _paths(frame: _Frame, curves: Curves, thick: float) -> str:
    """One path for each direction, steps thinner; crowded curves as a grey band."""
    several = len(curves.corners) > 1
    thick = thick / 2 if several else thick
    wanted: dict[tuple[Direction, bool], list[str]] = {}
    bands = []
    for one in curves.corners:
        if frame.crowded(one):
            bands.append(_band(frame, one, max(4, int(frame.width * one.duration_s / frame.duration_s / 2))))
            continue
        points = [frame.at(*point) for point in zip(one.time_s, one.value, strict=True)]
        steps = set(one.steps)
        runs: list[tuple[tuple[Direction, bool], list[tuple[float, float]]]] = []
        for n, (way, (a, b)) in enumerate(zip(directions(one), pairwise(points), strict=True)):
            key = way, n in steps
            if not runs or runs[-1][0] != key:
                runs.append((key, [a]))
            runs[-1][1].append(b)
        for key, run in runs:
            wanted.setdefault(key, []).append(path(run))
    parts = [f'<path d="{band}" fill="{STAY}" stroke-width="1" stroke="{STAY}" opacity=".5"/>' for band in bands]
    for way, colour in COLOURS.items():
        for step in (False, True):
            if found := wanted.get((way, step)):
                width = f' stroke-width="{thick * (0.8 if several else 0.6):.2g}"' if step else ""
                parts.append(f'<path d="{"".join(found)}" stroke="{colour}"{width}/>')
    clear = ' opacity=".75"' if several else ""
    caps = 'stroke-linecap="round" stroke-linejoin="round"'
    return f'<g fill="none" stroke-width="{thick:g}" {caps}{clear}>{"".join(parts)}</g>'


def _band(frame: _Frame, corners: Corners, columns: int) -> str:
    found = envelope(corners, columns)
    upper = [frame.at(time, high) for time, _, high in found]
    lower = [frame.at(time, low) for time, low, _ in found]
    return path([*upper, *reversed(lower)]) + "z"


def _label(curves: Curves) -> str:
    return ". ".join((curves.name, *curves.lines))


def document(width: int, height: int, label: str, parts: Sequence[str]) -> str:
    """Return an SVG of this size in pixels; ``label`` is what a screen reader says of it."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        f'role="img" aria-label="{escape(plain(label))}" font-family="system-ui,sans-serif" '
        f'style="background:#fff;max-width:100%;height:auto">{"".join(parts)}</svg>'
    )


def words(x: float, y: float, text: str, size: int, room: float, bold: bool = False, colour: str = "#111") -> str:
    """Return a line of text, cut to its room at an estimate of its width; a pointer at rest on it shows all of it."""
    whole = plain(text)
    cut = _cut(whole, room / (size * (0.62 if bold else 0.55)))
    full = f"<title>{escape(whole)}</title>" if cut != whole else ""
    weight = ' font-weight="600"' if bold else ""
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}"{weight} fill="{colour}">{full}{escape(cut)}</text>'


def plain(text: str) -> str:
    """Return a text as one line, without the characters that turn the direction of what follows."""
    return "".join(char for char in " ".join(text.split()) if unicodedata.category(char) not in ("Cf", "Cc"))


def _cut(text: str, room: float) -> str:
    used = 0.0
    for place, char in enumerate(text):
        used += 1.8 if unicodedata.east_asian_width(char) in "WF" else 1.0
        if used > room:
            return text[: max(1, place - 1)].rstrip() + "…"
    return text


def path(points: Points) -> str:
    """Return a path through points, relative after the first, without what a tenth of a pixel does not show."""
    (x, y), moves = points[0], []
    for to_x, to_y in points[1:]:
        if (to_x, to_y) != (x, y):
            across, down = _short(to_x - x), _short(to_y - y)
            moves.append(across + down if down.startswith("-") else f"{across},{down}")
        x, y = to_x, to_y
    return f"M{points[0][0]:g},{points[0][1]:g}l{' '.join(moves)}" if moves else ""


def _short(number: float) -> str:
    """A number to a tenth, without a zero before its point."""
    text = f"{number:.1f}".removesuffix(".0")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else "0" if text == "-0" else text

"""The writer of figures.

Figures are drawn for a screen. For paper they are set in the width asked for, without a title, with smaller letters,
thinner lines and a letter on each panel; keys that stood beside the panels stand below where there is no room. The
bytes of a file depend on what is drawn alone: no dates, and fonts are embedded.
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Mapping
from pathlib import Path
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any, cast

from thermicon.base.files.atomic import complete_or_absent

from .style import MM, NARROW_MM, SCREEN, Look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI, PAPER_DPI = 130, 300
COLORBAR = "<colorbar>"
"""How matplotlib labels the axes of a colour bar."""
MM_PER_INCH = MM["in"]
TYPE_PT, SMALLEST_PT, LARGEST_PT = 7.5, 5.5, 9.0
"""Size in print of what is drawn at 10 pt, and the limits of all sizes: journals ask for 5 to 9 pt."""
HEIGHT_POWER = 0.6
"""Panels lose less height than width, since their labels do not shrink as much as they do."""
THINNER = 0.75
IN_BRACKETS = re.compile(r"\s*\([^()]*\)$")
WIDEST_LABEL, WIDEST_BAR_LABEL = 0.85, 0.7
"""Share of the figure's width that a label of the abscissa, or those of all colour bars, may take in one line."""
LONGEST_KEY, KEY_PT, MOST_COLUMNS = 30, 9.0, 4
"""Letters of a line in the key below the panels, their size on a screen, and columns at most."""
EMBEDDED: Any = {
    "pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "thermicon",
}  # fmt: skip
COLOURS, WIDEST_PX = 64, 1000
"""Of a picture in a notebook: lines, words and heat maps need no more colours, and a cell is hardly wider."""
INKS = re.compile(r"#(?:000000|1a1a1a|222222|262626|444444|8a8a8a)\b")
THEMED = {
    "#2166ac": "--th-cool",
    "#e08214": "--th-warm",
    "#cfe3cf": "--th-target",
    "#6a6a6a": "--th-soft",
    "#ffffff": "--th-paper",
}
"""Colours of figures, and their names in the style sheet of the page."""
SIZE = re.compile(r'<svg ([^>]*?)height="([0-9.]+)pt"([^>]*?)width="([0-9.]+)pt"')
UNDATED: Mapping[str, dict[str, None]] = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}


def write_figure(figure: Figure, path: Path, look: Look = SCREEN) -> None:
    """Write a figure, which is changed, for a screen or for print into a .png, .pdf or .svg file."""
    import matplotlib

    with matplotlib.rc_context(EMBEDDED), complete_or_absent(path) as draft:
        if look.width_mm is not None:
            restyle(figure, look.width_mm)
        kind = path.suffix.lower().removeprefix(".")
        dpi = DPI if look.width_mm is None else PAPER_DPI
        figure.savefig(draft, format=kind, dpi=dpi, metadata=UNDATED[kind])


def small_png(figure: Figure, dpi: float | None = None) -> bytes:
    """Draw a figure as PNG with a palette of its own, cut to what is drawn; without `dpi` as a notebook shows it."""
    from PIL import Image

    drawn, small = io.BytesIO(), io.BytesIO()
    usual = min(figure.dpi, WIDEST_PX / figure.get_figwidth())
    figure.savefig(drawn, format="png", dpi=dpi or usual, bbox_inches="tight", facecolor="white")
    Image.open(drawn).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(small, "PNG", optimize=True)
    return small.getvalue()


def themed_svg(figure: Figure) -> str:
    """Return a figure as SVG without background, its inks those of the text around it; letters stay letters.

    >>> from matplotlib.figure import Figure
    >>> figure = Figure(figsize=(1, 1))
    >>> _ = figure.text(0.5, 0.5, "dip", color="#1a1a1a")
    >>> "currentColor" in themed_svg(figure), themed_svg(figure)[:4]
    (True, '<svg')
    """
    import matplotlib

    held = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "thermicon"}):
        figure.savefig(held, format="svg", transparent=True, metadata={"Date": None})
    text = held.getvalue()
    text = INKS.sub("currentColor", text[text.index("<svg") :])
    for colour, name in THEMED.items():
        text = text.replace(colour, f"var({name}, {colour})")
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    # Without a colour of its own, text in a picture is black on any theme.
    text = re.sub(r'<g id="text_(\d+)">', r'<g id="text_\1" fill="currentColor">', text)
    return SIZE.sub(r"<svg \1\3", text, count=1)


def restyle(figure: Figure, width_mm: float) -> None:
    """Change a figure in place as it is printed so wide: its size, letters, lines and keys; its title goes."""
    _letter_panels(figure)
    ratio = min(1.0, width_mm / (float(figure.get_figwidth()) * MM_PER_INCH))
    even = any(ax.get_aspect() != "auto" for ax in figure.axes)
    tall = ratio if even else ratio**HEIGHT_POWER
    height, key_inches = float(figure.get_figheight()) * tall, _key_inches(figure)
    figure.set_size_inches(width_mm / MM_PER_INCH, height)
    _resize(figure)
    _break_labels(figure)
    _fit_keys(figure, gathered=width_mm < NARROW_MM)
    if key_inches:  # panels keep their height, whatever the key needs
        figure.set_figheight(height + _key_inches(figure) - tall * key_inches)


def _letter_panels(figure: Figure) -> None:
    """Take away the title of the figure, and that of a single panel; several panels get letters.

    Titles of several panels stay, since they say what each shows, without what is in brackets.
    """
    if figure.get_suptitle():
        figure.suptitle("").set_in_layout(False)
    panels: list[Any] = [ax for ax in figure.axes if ax.get_label() != COLORBAR and ax.get_visible() and ax.axison]
    for panel, letter in zip(panels, ascii_lowercase, strict=False):
        titles = {loc: IN_BRACKETS.sub("", panel.get_title(loc=loc)) for loc in ("left", "center")}
        named = next((loc for loc, title in titles.items() if title and len(panels) > 1), "left")
        lettered = rf"$\mathbf{{{letter}}}$  {titles[named]}" if titles[named] else letter
        for loc in titles:
            said = lettered if loc == named and len(panels) > 1 else ""
            panel.set_title(said, loc=loc, fontweight="normal" if titles[named] else "bold")


def _renderer(figure: Figure) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    return FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]


def _key_inches(figure: Figure) -> float:
    """Height of the keys of the whole figure, in inches."""
    renderer = _renderer(figure)
    return sum(float(legend.get_window_extent(renderer).height) for legend in figure.legends) / float(figure.dpi)


def _break_labels(figure: Figure) -> None:
    """Labels of the abscissa that are wider than the figure go on in another line."""
    held: Any = figure
    renderer = _renderer(figure)
    bars = [ax.xaxis.label for ax in figure.axes if ax.get_label() == COLORBAR and ax.get_xlabel()]
    below = [held._supxlabel] if held._supxlabel is not None else []
    for text in [*below, *(ax.xaxis.label for ax in figure.axes)]:
        share = WIDEST_BAR_LABEL / len(bars) if text in bars else WIDEST_LABEL
        most = share * float(figure.bbox.width)
        lines: list[str] = []
        for line in text.get_text().split("\n"):
            text.set_text(line)
            wide = float(text.get_window_extent(renderer).width)
            lines += textwrap.wrap(line, max(8, int(len(line) * most / wide))) if wide > most else [line]
        text.set_text("\n".join(lines))


def _resize(figure: Any) -> None:
    """Letters and lines in the sizes of print."""
    from matplotlib.lines import Line2D
    from matplotlib.text import Annotation, Text

    for text in figure.findobj(Text):
        text.set_fontsize(_printed_pt(float(text.get_fontsize())))
        if isinstance(text, Annotation) and text.anncoords == "offset points":
            text.xyann = tuple(TYPE_PT / 10.0 * part for part in text.xyann)  # type: ignore[assignment]
    for line in figure.findobj(Line2D):
        line.set_linewidth(THINNER * float(line.get_linewidth()))
        line.set_markersize(THINNER * float(line.get_markersize()))
    for ax in figure.axes:
        for spine in ax.spines.values():
            spine.set_linewidth(THINNER * float(spine.get_linewidth()))
        for name, labels in (("x", ax.get_xticklabels()), ("y", ax.get_yticklabels())):  # for ticks yet to be made
            ax.tick_params(axis=name, labelsize=labels[0].get_fontsize() if labels else TYPE_PT)


def _printed_pt(size: float) -> float:
    """Size in print of letters that are so large on the screen, pt.

    >>> _printed_pt(10.0), _printed_pt(7.0), _printed_pt(14.0)
    (7.5, 5.5, 9.0)
    """
    return min(max(size * TYPE_PT / 10.0, SMALLEST_PT), LARGEST_PT)


def _fit_keys(figure: Figure, gathered: bool) -> None:
    """Lay out keys in as many columns as the width has room for; `gathered`: those beside panels become one below."""
    keys: list[tuple[str, list[Any], list[str]]] = []
    for legend in list(figure.legends):
        side = cast("Any", legend)._outside_loc or "upper"
        keys.append((side, list(legend.legend_handles), [text.get_text() for text in legend.get_texts()]))
        legend.remove()
    entries: dict[str, Any] = {}  # what several panels name alike stands once
    for ax in figure.axes if gathered else ():
        beside = ax.get_legend()
        if beside is not None and beside.get_bbox_to_anchor().transformed(ax.transAxes.inverted()).x0 > 1.0:
            for handle, text in zip(beside.legend_handles, beside.get_texts(), strict=True):
                entries.setdefault(textwrap.fill(" ".join(text.get_text().split()), LONGEST_KEY), handle)
            beside.remove()
    if entries:
        labels = sorted(entries, key=len)
        keys.append(("lower", [entries[label] for label in labels], labels))
    whole, renderer = cast("Any", figure), _renderer(figure)
    for side, handles, labels in keys:
        for columns in range(min(MOST_COLUMNS, len(labels)), 0, -1):
            legend = whole.legend(
                handles, labels, loc=f"outside {side} center", ncols=columns, frameon=False,
                fontsize=_printed_pt(KEY_PT), handlelength=2.4, columnspacing=1.2,
            )  # fmt: skip
            if columns == 1 or legend.get_window_extent(renderer).width <= 0.98 * float(figure.bbox.width):
                break
            legend.remove()

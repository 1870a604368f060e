"""The page of a benchmark: machine, tables of medians and spreads, and curves of growth on logarithmic axes."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number

from ..pages.blocks import Grid, Heading, MarkdownBlock, Picture, Text, grid
from .result import BenchResult, Curve, Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .measure import Timing

TITLE, GROWTH, DPI = "Speed", "growth", 110
CAPTION = (
    "Processor time over the size of a problem; bars span least to most, a dotted line is proportional to the size."
)
COLUMNS = ("what", "elapsed", "least to most", "runs", "processor", "times", "against")
UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
CURVES = ("#2166ac", "#e08214", "#111111", "#6b6b6b")


def page(result: BenchResult) -> list[MarkdownBlock]:
    """Return the blocks of the page, for HTML and for Markdown."""
    lead = (
        "Written by thermicon bench. Elapsed time is what is waited for: its median, the least and the most of the "
        "runs. Processor time, of all threads and processes, is the median too; what else the machine does changes it "
        "less. The last columns compare processor times: how many times as long as the other. Ratios within one page "
        "are what to quote."
    )
    blocks: list[MarkdownBlock] = [Heading(TITLE, 1), Text(lead, "lead"), Heading("Machine and versions")]
    blocks.append(grid(("what", "value"), result.machine))
    for section in result.sections:
        blocks += [Heading(section.title), Text(section.about), section_grid(section)]
    if result.curves:
        sentence = "; ".join(f"{curve.title.lower()}: exponent {curve.growth:.2f}" for curve in result.curves)
        blocks += [
            Heading("Growth"),
            Picture(GROWTH, CAPTION),
            Text(f"Growth between the two largest sizes, 1 where time is proportional to size: {sentence}."),
            curve_grid(result.curves),
        ]
    return blocks


def section_grid(section: Section) -> Grid:
    """The table of a section."""
    rows = []
    for entry in section.entries:
        times = "" if entry.times is None else f"{number(entry.times, 1 if entry.times < 10 else 0)}"
        runs = str(len(entry.timing.seconds))
        rows.append((_named(entry.name, entry.timing), duration(entry.timing.median_s), spread(entry.timing), runs,
                     duration(entry.timing.processor_s), times, entry.against))  # fmt: skip
    return grid(COLUMNS, rows, COLUMNS[1:6])


def curve_grid(curves: tuple[Curve, ...]) -> Grid:
    """The numbers behind the curves."""
    rows = [
        (curve.title, f"{size:,} {curve.axis}", duration(timing.median_s), duration(timing.processor_s))
        for curve in curves
        for size, timing in zip(curve.sizes, curve.timings, strict=True)
    ]
    return grid(("curve", "size", "elapsed", "processor"), rows, ("size", "elapsed", "processor"))


def duration(seconds: float) -> str:
    """A time in the unit that suits it, with three digits.

    >>> duration(0.00123), duration(2.5), duration(45e-6)
    ('1.23 ms', '2.50 s', '45.0 µs')
    """
    scale, unit = next(((scale, unit) for scale, unit in UNITS if seconds >= scale), UNITS[-1])
    value = seconds / scale
    return f"{value:.{2 if value < 10 else 1 if value < 100 else 0}f} {unit}"


def spread(timing: Timing) -> str:
    """The least and the most of the times; a dash for a single run."""
    if len(timing.seconds) == 1:
        return "–"
    return f"{duration(min(timing.seconds))} to {duration(max(timing.seconds))}"


def growth_figure(curves: tuple[Curve, ...]) -> Figure:
    """Draw every curve on logarithmic axes of its own, with the least and the most as bars."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullLocator

    figure = Figure(figsize=(8.0, 2.9 * ((len(curves) + 1) // 2)), layout="constrained")
    panels = figure.subplots((len(curves) + 1) // 2, 2, squeeze=False).ravel()
    for ax, curve, colour in zip(panels, curves, CURVES, strict=False):
        middle = [timing.processor_s * 1e3 for timing in curve.timings]
        below = [m - min(t.processor) * 1e3 for m, t in zip(middle, curve.timings, strict=True)]
        above = [max(t.processor) * 1e3 - m for m, t in zip(middle, curve.timings, strict=True)]
        ax.plot(curve.sizes, [middle[0] * size / curve.sizes[0] for size in curve.sizes], ":", color="0.6", lw=1.2)
        ax.errorbar(curve.sizes, middle, yerr=(below, above), color=colour, marker="o", ms=4, lw=1.6, capsize=3)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xticks(curve.sizes, [f"{size:,}" for size in curve.sizes])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        ax.yaxis.set_minor_locator(NullLocator())
        ax.set_title(curve.title, fontsize="medium")
        ax.set_xlabel(curve.axis)
        ax.set_ylabel("processor time (ms)")
        ax.yaxis.set_major_formatter(lambda value, _: f"{value:,g}")
        ax.spines[["top", "right"]].set_visible(False)
    for ax in panels[len(curves) :]:
        ax.set_visible(False)
    return figure


def picture(figure: Figure) -> bytes:
    """A figure as PNG, without a date."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=DPI, metadata={"Software": None})
    return data.getvalue()


def _named(name: str, timing: Timing) -> str:
    return name if timing.memory_MB is None else f"{name}, {timing.memory_MB:.0f} MB"

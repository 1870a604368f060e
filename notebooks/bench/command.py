"""``thermicon bench``: how fast this machine is at circuit, perception and ranking, beside other programs."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..files.outputs import OutputError
from ..text.messages import note
from ..text.tables import show, table

if TYPE_CHECKING:
    from .result import BenchResult

HTML, MARKDOWN, FIGURES = "speed.html", "speed.md", "figures"


def bench_command(
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", readable=False, help="Write the page and its figure there."),
    ] = None,
    full: Annotated[
        bool,
        typer.Option("--full/--short", help="Ten runs and curves of growth, in minutes, or half a minute."),
    ] = False,
) -> None:
    """Measure speed on this machine: circuit, perception and ranking, beside ngspice and scipy.

    Without -o, tables are printed. With -o, speed.html and speed.md are written, with medians, spreads, machine,
    versions and curves of growth. ngspice takes part where it is installed. Close other programs first.
    """
    if output is not None and output.exists() and not output.is_dir():
        raise OutputError(f"{output} is a file; give a folder for the page and its figure")
    result = measured(short=not full)
    if output is None:
        show_result(result)
    else:
        write_page(result, output)
        note(f"wrote {output / HTML}")


def measured(short: bool) -> BenchResult:
    """Run every measurement, with a line of progress for each part."""
    from thermicon.circuit import Rig

    from . import circuit_timings, ranking_timings
    from .machine import machine_facts
    from .result import BenchResult

    rig, facts = Rig.load("thenar"), machine_facts()
    note("measuring commands")
    commands = ranking_timings.command_section(short)  # first, while this process is small
    note("measuring circuit and percepts")
    sections = [*circuit_timings.circuit_sections(rig, short), ranking_timings.percept_section(), commands]
    sections.append(ranking_timings.ranking_section(rig, short))
    note("measuring growth")
    curves = (*circuit_timings.circuit_curves(rig), *ranking_timings.ranking_curves(rig, short))
    return BenchResult((*facts, ("form", "short" if short else "full")), tuple(sections), curves)


def show_result(result: BenchResult) -> None:
    """Print the tables of a result."""
    from .page import COLUMNS, duration, section_grid

    show(*(f"{name}: {value}" for name, value in result.machine))
    for section in result.sections:
        printed = table(*COLUMNS, numbers=COLUMNS[1:6])
        for row in section_grid(section).rows:
            printed.add_row(*(cell.text for cell in row))
        show("", section.title, section.about, printed)
    grown = table("curve", "size", "elapsed", "processor", numbers=("size", "elapsed", "processor"))
    for curve in result.curves:
        for size, timing in zip(curve.sizes, curve.timings, strict=True):
            grown.add_row(curve.title, f"{size:,} {curve.axis}", *map(duration, (timing.median_s, timing.processor_s)))
    show("", "Growth", grown)


def write_page(result: BenchResult, folder: Path) -> None:
    """Write the page as HTML and Markdown with its figure; raises OutputError where the folder cannot be written."""
    from ..pages.blocks import as_html, as_markdown
    from .page import GROWTH, TITLE, growth_figure, page, picture

    blocks, drawn = page(result), {GROWTH: picture(growth_figure(result.curves))}
    files = {
        f"{FIGURES}/{GROWTH}.png": drawn[GROWTH],
        MARKDOWN: as_markdown(blocks, FIGURES).encode("utf-8"),
        HTML: as_html(blocks, TITLE, drawn).encode("utf-8"),
    }
    try:
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".speed-", dir=folder) as name:
            for k, (place, content) in enumerate(files.items()):
                draft = Path(name) / str(k)
                draft.write_bytes(content)
                draft.replace(folder / place)
    except OSError as problem:
        raise OutputError(f"cannot write into {folder}: {problem.strerror or problem}") from problem

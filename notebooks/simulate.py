"""``thermicon simulate``: icons or a drive to traces, a summary, figures."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy
import typer

from thermicon.notebooks.cues import pick, read_set
from thermicon.notebooks.door import note
from thermicon.notebooks.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, complete_or_absent
from thermicon.notebooks.wording import number, span

FELT_TAIL_S = 10.0
"""How long an overview follows sensation after the last corner, unless told."""

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace


def simulate_file(
    file: str,
    icon: str | None,
    rig: Rig,
    rate_Hz: float,
    tail_s: float | None,
    output: Path | None,
    figure: Path | None,
) -> None:
    """Play the icons of a file (or the one named) on the rig; write the traces, or print a summary of each."""
    from thermicon.circuit import simulate

    icons = pick(read_set([file]), icon)
    pictures = _figure_paths(figure, [each.name for each in icons])
    _check(output, pictures)
    _finish([simulate(each, rig, rate_Hz=rate_Hz, tail_s=tail_s or 0.0) for each in icons], rig, output)
    for each, picture in zip(icons, pictures, strict=False):
        draw_overview(simulate(each, rig, tail_s=FELT_TAIL_S if tail_s is None else tail_s), picture)
        note(f"wrote {picture}")


def simulate_drive(drive: Path, hold: bool, rig: Rig, rate_Hz: float, output: Path | None, figure: Path | None) -> None:
    """Play a drive current from a CSV file on the rig; write the trace, or print a summary."""
    from thermicon.circuit import read_drive, simulate_current

    pictures = [] if figure is None else [figure]
    _check(output, pictures)
    played = read_drive(drive, hold=hold)
    _finish([simulate_current(played, rig, rate_Hz=rate_Hz)], rig, output)
    for picture in pictures:
        draw_overview(simulate_current(played, rig), picture)
        note(f"wrote {picture}")


def _figure_paths(figure: Path | None, names: Sequence[str]) -> list[Path]:
    if figure is None:
        return []
    if len(names) == 1:
        return [figure]
    return [figure.with_name(f"{figure.stem}-{name}{figure.suffix}") for name in names]


def _check(output: Path | None, pictures: Sequence[Path]) -> None:
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a trace")
    for picture in pictures:
        check_output(picture, FIGURE_SUFFIXES, "a figure")


def _finish(traces: Sequence[Trace], rig: Rig, output: Path | None) -> None:
    for trace in traces:
        for warning in (*trace.warnings, *trace.beyond, *unsafe(trace)):
            if warning not in rig.warnings:  # those were told when the rig was loaded
                note(f"warning: {trace.icon or 'drive'}: {warning}")
    if output is None:
        for trace in traces:
            typer.echo(describe(trace))
    else:
        write_traces(traces, output)
        for trace in traces:
            note(headline(trace))


def unsafe(trace: Trace) -> list[str]:
    """Return a sentence for every shipped limit of safety that the run passes, the hard ones marked."""
    from thermicon.circuit import judge_safety

    findings = judge_safety(trace).findings
    return [f"{'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in findings]


def write_traces(traces: Sequence[Trace], output: Path) -> None:
    """Write the traces below each other, by the suffix of ``output``; ``-`` is CSV on stdout."""
    from thermicon.circuit import write_trace

    if output == STDOUT:
        with tempfile.TemporaryDirectory() as folder:
            draft = Path(folder) / "trace.csv"
            write_trace(list(traces), draft)
            typer.echo(draft.read_text(encoding="utf-8"), nl=False)
        return
    with complete_or_absent(output) as draft:
        write_trace(list(traces), draft)


def draw_overview(trace: Trace, picture: Path) -> None:
    """Write the overview figure of one trace, its percept included."""
    from thermicon.notebooks.overview import overview
    from thermicon.perception import perceive

    trace = on_one_clock(trace)
    with complete_or_absent(picture) as draft:
        overview(trace, perceive(trace)).savefig(draft, dpi=130)


def on_one_clock(trace: Trace) -> Trace:
    """Drop the last row where it comes off the beat, as when a drive ends between two rows."""
    steps = numpy.diff(trace.time_s)
    if len(steps) < 2 or abs(steps[-1] - steps[0]) < 1e-6 * steps[0]:
        return trace
    return dataclasses.replace(
        trace,
        **{
            field.name: getattr(trace, field.name)[:-1]
            for field in dataclasses.fields(trace)
            if isinstance(getattr(trace, field.name), numpy.ndarray)
        },
    )


def headline(trace: Trace) -> str:
    """One line about a run: its length, and whether it reached its target or why not."""
    start = f"{trace.icon or 'drive'}: {number(float(trace.time_s[-1]), 2)} s"
    if trace.outcome is None:
        return start
    if not trace.outcome.reached:
        return f"{start}, NOT reached: {trace.outcome.reason}"
    miss = abs(trace.outcome.largest_miss_K)
    return f"{start}, reached ({'everywhere within 1 mK' if miss < 1e-3 else f'largest miss {number(miss, 3)} K'})"


def describe(trace: Trace) -> str:
    """Say what a person wants to know of a run first: outcome, drive, extremes, changes at the receptors."""
    peaks = []
    for name, column in (("cold receptor", trace.cold_receptor_C), ("warm receptor", trace.warm_receptor_C)):
        change = column - column[0]
        low, high = float(change.min()), float(change.max())
        peaks.append(f"{name} {span(low, high, 'K', 2)}")
    lines = [
        headline(trace),
        f"  current   {span(float(trace.current_A.min()), float(trace.current_A.max()), 'A', 2)}",
        f"  display   {span(float(trace.display_C.min()), float(trace.display_C.max()), '°C')}",
        f"  skin      {span(float(trace.skin_C.min()), float(trace.skin_C.max()), '°C')}",
        f"  change    {'; '.join(peaks)}",
    ]
    return "\n".join(lines)

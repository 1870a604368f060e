"""``thermicon simulate``: icons or a drive to traces, a summary, figures."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.icons.number_text import number, signed, span

from ..figures.figure_look import SCREEN, Look
from ..figures.trace_overview import FELT_TAIL_S, draw_overview
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate, complete_or_absent
from ..messages import note, usage
from .cues import pick, read_set, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.circuit.fitting.log import Log
    from thermicon.icons import Icon


def simulate_file(
    file: str,
    icon: str | None,
    rig: Rig,
    rate_Hz: float,
    tail_s: float | None,
    output: Path | None,
    figure: Path | None,
    power: bool = False,
    measured: Path | None = None,
    look: Look = SCREEN,
) -> None:
    """Play the icons of a file (or the one named) on the rig; write the traces, or print a summary of each."""
    from thermicon.circuit import simulate

    whole = read_set([file])
    icons = pick(whole, icon)
    if measured is not None and len(icons) > 1:
        raise usage(f"belongs to one icon, {file} has {len(icons)}: name it with --icon", "--measured")
    log = None if measured is None else _log(measured)
    pictures = _figure_paths(figure, [each.name for each in icons])
    _check(file, output, pictures)
    warn_of_site(file, whole, rig)
    traces = [simulate(each, rig, rate_Hz=rate_Hz, tail_s=tail_s or 0.0) for each in icons]
    _write(traces, output, power)
    for each, picture in zip(icons, pictures, strict=False):
        played = simulate(each, rig, tail_s=FELT_TAIL_S if tail_s is None else tail_s)
        draw_overview(played, picture, rig.changes, log, look, settled=tail_s is None)
    cures = [cure(each, trace, rig) for each, trace in zip(icons, traces, strict=True)]
    _report(traces, rig, output, pictures, cures, power)
    _beside(log, traces[0], output)


def simulate_drive(
    drive: Path,
    hold: bool,
    rig: Rig,
    rate_Hz: float,
    output: Path | None,
    figure: Path | None,
    power: bool = False,
    measured: Path | None = None,
    look: Look = SCREEN,
) -> None:
    """Play a drive current from a CSV file on the rig; write the trace, or print a summary."""
    from thermicon.circuit import read_drive, simulate_current

    pictures = [] if figure is None else [figure]
    _check(drive, output, pictures)
    log = None if measured is None else _log(measured)
    played = read_drive(drive, hold=hold)
    trace = simulate_current(played, rig, rate_Hz=rate_Hz)
    _write([trace], output, power)
    for picture in pictures:
        draw_overview(simulate_current(played, rig), picture, rig.changes, log, look)
    _report([trace], rig, output, pictures, [None], power)
    _beside(log, trace, output)


def _log(path: Path) -> Log:
    from thermicon.circuit.fitting.log_files import read_log

    log = read_log(path)
    for sentence in log.notes:
        note(f"note: {sentence}")
    return log


def _beside(log: Log | None, trace: Trace, output: Path | None) -> None:
    """Report how far a log lies from the trace: on stdout, or beside a trace on stderr."""
    if log is None:
        return
    beside = log.beside(trace)
    lines = [f"measured − simulated ({log.name}, shifted by {number(beside.shift_s, 3)} s)"]
    for each in beside.columns:
        words, _, unit = each.column.rpartition("_")
        unit = "K" if unit == "C" else unit
        largest = f"{signed(each.largest, '.3g')} {unit} at {number(each.largest_s, 1)} s"
        lines.append(f"  {words.replace('_', ' '):<9} rms {each.rms:.3g} {unit}, largest {largest}")
    for line in lines:
        if output == STDOUT:
            note(line)
        else:
            typer.echo(line)


def cure(icon: Icon, trace: Trace, rig: Rig) -> str | None:
    """Return how the icon could be changed so that the rig reaches it; None where it is reached or nothing helps."""
    from thermicon.circuit import nearest_reachable

    if trace.reachable:
        return None
    near = nearest_reachable(icon, rig)
    return None if near is None else near.sentence


def _figure_paths(figure: Path | None, names: Sequence[str]) -> list[Path]:
    if figure is None:
        return []
    if len(names) == 1:
        return [figure]
    return [figure.with_name(f"{figure.stem}-{name}{figure.suffix}") for name in names]


def _check(read: str | Path, output: Path | None, pictures: Sequence[Path]) -> None:
    check_separate([read], [output, *pictures])
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a trace")
    for picture in pictures:
        check_output(picture, FIGURE_SUFFIXES, "a figure")


def _write(traces: Sequence[Trace], output: Path | None, power: bool) -> None:
    """Write the traces to their file before printing, since the reader of a pipe may not wait."""
    if output is not None and output != STDOUT:
        write_traces(traces, output, power)


def _report(
    traces: Sequence[Trace],
    rig: Rig,
    output: Path | None,
    pictures: Sequence[Path],
    cures: Sequence[str | None],
    power: bool,
) -> None:
    """Report warnings and written files on stderr, then print a summary or the traces on stdout."""
    for trace in traces:
        for warning in (*trace.warnings, *trace.beyond, *unsafe(trace)):
            if warning not in rig.warnings:  # already reported when the rig was loaded
                note(f"warning: {trace.icon or 'drive'}: {warning}")
    if output is not None:
        for trace, better in zip(traces, cures, strict=True):
            note(headline(trace) + (f"; {better}" if better else ""))
    for path in (output, *pictures):
        if path not in (None, STDOUT):
            note(f"wrote {path}")
    if output is None:
        for trace, better in zip(traces, cures, strict=True):
            typer.echo(describe(trace) + (f"\n  nearest   {better}" if better else ""))
    elif output == STDOUT:
        write_traces(traces, output, power)


def unsafe(trace: Trace) -> list[str]:
    """Return one sentence per exceeded safety limit, or the reason why the run cannot be judged."""
    from thermicon.circuit.rig.load import LOAD_SITES, without_skin
    from thermicon.circuit.safety.limits import judge_safety

    if trace.site in LOAD_SITES:
        return [without_skin(trace.site, "safety for people")]
    findings = judge_safety(trace).findings
    return [f"{'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in findings]


def write_traces(traces: Sequence[Trace], output: Path, power: bool = False) -> None:
    """Write all traces to one file in the format of its suffix; ``-`` is CSV on stdout. `power`: with `power_W`."""
    from thermicon.circuit.solver.trace import write_trace

    if output == STDOUT:
        with tempfile.TemporaryDirectory() as folder:
            draft = Path(folder) / "trace.csv"
            write_trace(list(traces), draft, power)
            typer.echo(draft.read_text(encoding="utf-8"), nl=False)
        return
    with complete_or_absent(output) as draft:
        write_trace(list(traces), draft, power)


def headline(trace: Trace) -> str:
    """One line about a run: its length, and whether it reached its target or why not."""
    start = f"{trace.icon or 'drive'}: {number(float(trace.time_s[-1]), 2)} s"
    if trace.outcome is None:
        return start
    if not trace.outcome.reached:
        return f"{start}, NOT reached: {trace.outcome.reason}"
    miss = abs(trace.outcome.largest_miss_K)
    miss_text = "everywhere within 1 mK" if miss < 1e-3 else f"largest miss {number(miss, 3)} K"
    slowest = trace.outcome.slowest_step_s
    steps = "" if slowest is None else f", slowest step {number(slowest, 2)} s"
    return f"{start}, reached ({miss_text}{steps})"


def _current(trace: Trace) -> str:
    if not trace.has_current:
        return "none: the thermode controls its temperature itself"
    return span(float(trace.current_A.min()), float(trace.current_A.max()), "A", 2)


def describe(trace: Trace) -> str:
    """Summarise a run: outcome, drive, extremes and changes at the receptors."""
    from thermicon.circuit.rig.load import LOAD_SITES

    peaks = []
    for name, column in (("cold receptor", trace.cold_receptor_C), ("warm receptor", trace.warm_receptor_C)):
        change = column - column[0]
        low, high = float(change.min()), float(change.max())
        peaks.append(f"{name} {span(low, high, 'K', 2)}")
    lines = [
        headline(trace),
        f"  current   {_current(trace)}",
        f"  display   {span(float(trace.display_C.min()), float(trace.display_C.max()), '°C')}",
        f"  skin      {span(float(trace.skin_C.min()), float(trace.skin_C.max()), '°C')}",
        f"  change    {'; '.join(peaks)}",
    ]
    if trace.site in LOAD_SITES:
        face = span(float(trace.skin_C.min()), float(trace.skin_C.max()), "°C")
        lines[3:] = [f"  load      {face} ({trace.site})"]
    return "\n".join(lines)

"""``thermicon simulate``: icons, a drive or a session, as summary, trace, figure or netlist."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from thermicon.icons.atomic import complete_or_absent
from thermicon.icons.number_text import number, signed, span

from ..figures.overview import FELT_TAIL_S, draw_overview
from ..files.outputs import STDOUT, SUBCIRCUIT_SUFFIXES, TRACE_SUFFIXES, check_output, check_separate
from ..messages import note, usage
from .cues import pick, read_set, warn_of_site
from .netlist import netlist_file, subcircuit_file
from .options import LARGEST_SEED, LONGEST_TAIL_S, FigureOptions, IconName, NoFile, RigOptions, out

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.circuit.fitting.log import Log

LONGEST_GAP_S, MOST_PLAYS = 3600.0, 5000
"""Those of `thermicon.circuit.SessionPlan`, repeated here to avoid its imports."""


def simulate_command(
    rig: RigOptions,
    figure: FigureOptions,
    file: NoFile = None,
    icon: IconName = None,
    current: Annotated[
        Path | None,
        out("DRIVE.csv", "Play this drive current (columns time_s, current_A) instead of icons.", "--current"),
    ] = None,
    hold: Annotated[
        bool,
        typer.Option("--hold", help="With --current: hold each current until the next row instead of interpolating."),
    ] = False,
    order: Annotated[
        Path | None,
        out("FILE", "Play a session: icons in the order of this file, which has one name per line.", "--order"),
    ] = None,
    random: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=MOST_PLAYS, help="Play a session: every icon N times, in random order."),
    ] = None,
    gap: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            min=0.0,
            max=LONGEST_GAP_S,
            help="In a session: seconds from the end of one icon to the start of the next.  [default: 10]",
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="SEED", min=0, max=LARGEST_SEED, help="Seed of --random.  [default: 0]")
    ] = None,
    tracking: Annotated[
        Literal["replay", "display"] | None,
        typer.Option(
            help="In a session: replay the currents open loop, or control the display temperature.  [default: replay]"
        ),
    ] = None,
    output: Annotated[
        Path | None,
        out(
            "OUT",
            "Write the trace to .csv or .parquet, or - for stdout; the circuit of one icon to .cir or .net (.sp: "
            "ngspice then writes the probes); without FILE module and skin as subcircuits to .lib; a session also to "
            ".json, its order to .txt.",
            "-o",
            "--output",
        ),
    ] = None,
    rate: Annotated[float, typer.Option(metavar="HZ", min=1e-3, max=1e6, help="Samples per second.")] = 100.0,
    tail: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            min=0.0,
            max=LONGEST_TAIL_S,
            help="Seconds simulated after the last corner.  [default: 0; 10 in figures]",
        ),
    ] = None,
    measured: Annotated[
        Path | None,
        out(
            "LOG",
            "Lay a measured log beside the trace, in the figure too: rms and largest miss of every column.",
            "--measured",
        ),
    ] = None,
) -> None:
    """Simulate icons: the current that plays them, and temperatures and heat flow down to the receptors.

    With --current, a given drive current is simulated instead; with --order or --random a session, as one run with one
    worst-case verdict (which is only reported: the exit code is 0 whatever its colour). Without -o, a short summary is
    printed.
    """
    session, suffix = order is not None or random is not None, "" if output is None else output.suffix.lower()
    circuit = suffix in SUBCIRCUIT_SUFFIXES and not session and current is None
    needs_file = {"--icon": icon, "--tail": tail}
    alone = {"--rate": rate != 100.0, "--measured": measured, **needs_file}
    in_session = {"--gap": gap is not None, "--seed": seed is not None, "--tracking": tracking}
    _refuse({"--hold": hold}, current is None, "belongs to --current, which plays a drive")
    _refuse(in_session, not session, "belongs to a session; give --order FILE or --random N")
    _refuse({"--seed": seed is not None}, random is None, "belongs to --random")
    _refuse({"--figure": figure.figure, "--measured": measured}, circuit, "belongs to a trace, not to a circuit")
    _refuse({"--current": current, "--random": random and order, **alone}, session, "does not go with a session")
    _refuse(needs_file, current is not None, "belongs to a cue FILE; a drive has no icons and ends at its last row")
    if circuit and file is None and output is not None:
        _refuse(needs_file, True, "belongs to a cue FILE; without one, the circuit of the rig is written alone")
        subcircuit_file(rig.load(), output)
        return
    if (file is None) == (current is None):
        raise usage("give either a cue FILE or --current DRIVE.csv", "FILE")
    if current is not None:
        simulate_drive(current, hold, rig.load(), rate, Wanted(output, figure, measured))
    elif file is not None and circuit and output is not None:
        netlist_file(file, icon, rig.load(), tail or 0.0, output)
    elif file is not None and session:
        from .session import session_file

        session_file(file, rig.load(), order, random, 10.0 if gap is None else gap, seed or 0, tracking, output, figure)
    elif file is not None:
        simulate_file(file, icon, rig.load(), rate, tail, Wanted(output, figure, measured))


def _refuse(options: Mapping[str, object], where: bool, why: str) -> None:
    """Fail with a usage error for the first option that is given where it has no meaning."""
    for option, value in options.items():
        if where and value is not None and value is not False:
            raise usage(why, option)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be made of a run: the trace in a file, the overview, and a measured log beside it."""

    output: Path | None
    figure: FigureOptions
    measured: Path | None

    def check(self, read: str | Path, names: Sequence[str]) -> list[Path]:
        """Fail where a file cannot be written or would replace what is read; return a picture's path for each run."""
        picture = self.figure.figure
        pictures = [] if picture is None else [picture]
        if picture is not None and len(names) > 1:
            pictures = [picture.with_name(f"{picture.stem}-{name}{picture.suffix}") for name in names]
        check_separate([read], [self.output, *pictures])
        if self.output is not None:
            check_output(self.output, TRACE_SUFFIXES, "a trace")
        return pictures

    def log(self) -> Log | None:
        """The measured log, if there is one; what is to be known of it goes to stderr."""
        if self.measured is None:
            return None
        from thermicon.circuit.fitting.log_files import read_log

        log = read_log(self.measured)
        for sentence in log.notes:
            note(f"note: {sentence}")
        return log

    def tell(self, traces: Sequence[Trace], rig: Rig, pictures: Sequence[Path], cures: Sequence[str | None]) -> None:
        """Warnings and files on stderr, then a summary or the traces on stdout, whose reader may not wait for files."""
        if self.output is not None and self.output != STDOUT:
            write_traces(traces, self.output)
        for trace in traces:
            for warning in (*trace.warnings, *trace.beyond, *unsafe(trace)):
                if warning not in rig.warnings:  # already reported when the rig was loaded
                    note(f"warning: {trace.icon or 'drive'}: {warning}")
        if self.output is not None:
            for trace, better in zip(traces, cures, strict=True):
                note(headline(trace) + (f"; {better}" if better else ""))
        for path in (self.output, *pictures):
            if path not in (None, STDOUT):
                note(f"wrote {path}")
        if self.output is None:
            for trace, better in zip(traces, cures, strict=True):
                typer.echo(describe(trace) + (f"\n  nearest   {better}" if better else ""))
        elif self.output == STDOUT:
            write_traces(traces, STDOUT)


def simulate_file(file: str, icon: str | None, rig: Rig, rate_Hz: float, tail_s: float | None, wanted: Wanted) -> None:
    """Play the icons of a file (or the one named) on the rig; write the traces, or print a summary of each."""
    from thermicon.circuit import nearest_reachable, simulate

    whole = read_set([file])
    icons = pick(whole, icon)
    if wanted.measured is not None and len(icons) > 1:
        raise usage(f"belongs to one icon, {file} has {len(icons)}: name it with --icon", "--measured")
    log, pictures = wanted.log(), wanted.check(file, [each.name for each in icons])
    warn_of_site(file, whole, rig)
    traces = [simulate(each, rig, rate_Hz=rate_Hz, tail_s=tail_s or 0.0) for each in icons]
    for each, picture in zip(icons, pictures, strict=False):
        played = simulate(each, rig, tail_s=FELT_TAIL_S if tail_s is None else tail_s)
        draw_overview(played, picture, rig.changes, log, wanted.figure.look, settled=tail_s is None)
    near = [
        None if trace.reachable else nearest_reachable(each, rig) for each, trace in zip(icons, traces, strict=True)
    ]
    wanted.tell(traces, rig, pictures, [None if found is None else found.sentence for found in near])
    _beside(log, traces[0], wanted.output)


def simulate_drive(drive: Path, hold: bool, rig: Rig, rate_Hz: float, wanted: Wanted) -> None:
    """Play a drive current from a CSV file on the rig; write the trace, or print a summary."""
    from thermicon.circuit.solver.drive import read_drive
    from thermicon.circuit.solver.simulate import simulate_current

    pictures, log = wanted.check(drive, [""]), wanted.log()
    played = read_drive(drive, hold=hold)
    trace = simulate_current(played, rig, rate_Hz=rate_Hz)
    for picture in pictures:
        draw_overview(simulate_current(played, rig), picture, rig.changes, log, wanted.figure.look)
    wanted.tell([trace], rig, pictures, [None])
    _beside(log, trace, wanted.output)


def _beside(log: Log | None, trace: Trace, output: Path | None) -> None:
    """Report how far a log lies from the trace: on stdout, or beside a trace on stderr."""
    if log is None:
        return
    from thermicon.circuit.fitting.overlay import overlay

    beside = overlay(trace, log)
    lines = [f"measured − simulated ({log.name}, shifted by {number(beside.shift_s, 3)} s)"]
    for each in beside.columns:
        words, _, unit = each.column.rpartition("_")
        unit = "K" if unit == "C" else unit
        largest = f"{signed(each.largest, '.3g')} {unit} at {number(each.largest_s, 1)} s"
        lines.append(f"  {words.replace('_', ' '):<9} rms {each.rms:.3g} {unit}, largest {largest}")
    (note if output == STDOUT else typer.echo)("\n".join(lines))


def unsafe(trace: Trace) -> list[str]:
    """Return one sentence per exceeded safety limit, or the reason why the run cannot be judged."""
    from thermicon.circuit.rig.load import LOAD_SITES, without_skin
    from thermicon.circuit.safety.verdict import judge_safety

    if trace.site in LOAD_SITES:
        return [without_skin(trace.site, "safety for people")]
    findings = judge_safety(trace).findings
    return [f"{'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in findings]


def write_traces(traces: Sequence[Trace], output: Path) -> None:
    """Write all traces to one file in the format of its suffix; ``-`` is CSV on stdout."""
    from thermicon.circuit.solver.trace import write_trace

    if output == STDOUT:
        with tempfile.TemporaryDirectory() as folder:
            draft = Path(folder) / "trace.csv"
            write_trace(list(traces), draft)
            typer.echo(draft.read_text(encoding="utf-8"), nl=False)
        return
    with complete_or_absent(output) as draft:
        write_trace(list(traces), draft)


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

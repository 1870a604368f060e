"""``thermicon simulate``: the run of icons or of a drive on a rig."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from thermicon.base.files.atomic import complete_or_absent

from ..figures.overview import FELT_TAIL_S, felt, overview
from ..figures.session_figure import session_figure
from ..files.outputs import NETLIST_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate
from ..messages import note, noted, progress_bar, usage
from ..report.following import after_simulating
from ..report.gate_words import CAUTION
from ..report.run_report import describe, headline, session_report
from ..report.terminal import show
from .on_elements import simulate_elements
from .options import (
    LARGEST_SEED,
    LONGEST_TAIL_S,
    CrowdOptions,
    FigureOptions,
    IconName,
    NoFile,
    RigOptions,
    Theirs,
    commands,
    flag,
    opt,
    out,
    pick,
    read_set,
    theirs_of,
    write_text,
)

if TYPE_CHECKING:
    from thermicon.circuit import LayoutTrace, Rig, Session, Trace
    from thermicon.icons import IconSet

LONGEST_GAP_S, MOST_PLAYS = 3600.0, 5000
"""Those of `thermicon.circuit.SessionPlan`, repeated here to avoid its imports."""
NUMBERS, ORDER = ".json", ".txt"
NGSPICE = ".sp"
"""The ending of a netlist that makes ngspice write all probes; LTspice does not read that."""


@dataclass(frozen=True)
class FilmOptions(FigureOptions):
    """The figure and the film of a run."""

    film: Annotated[Path | None, out("OUT", "Film what is felt: .svg (it moves), .gif or, with ffmpeg, .mp4.")] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.film is not None:
            from thermicon.perception.plots.film import SUFFIXES, movie_writer

            check_output(self.film, SUFFIXES, "a film")
            movie_writer(self.film)

    def named(self, icon: str) -> FilmOptions:
        """The same for one icon of several, whose name its files have at their ends."""
        figure, film = (path and path.with_stem(f"{path.stem}-{icon}") for path in (self.figure, self.film))
        return replace(self, figure=figure, film=film)

    def write_rows(self, run: LayoutTrace) -> None:
        """Write the figure of a run on several elements."""
        from ..figures.layout_figure import layout_figure

        self.write(partial(layout_figure, run))

    def write_felt(self, trace: Trace, rig: Rig) -> None:
        """Write the figure and the film of a run with what is felt of it, and say so."""
        played, percept = felt(trace)
        self.write(lambda: overview(played, percept, rig.changes))
        if self.film is not None:
            percept.film(played).save(self.film)
            note(f"wrote {self.film}: {percept.summary}")


def simulate_command(
    rig: RigOptions,
    figure: FilmOptions,
    file: NoFile = None,
    icon: IconName = None,
    current: Annotated[
        Path | None,
        out("DRIVE.csv", "Play this drive current (columns time_s, current_A) instead of icons.", "--current"),
    ] = None,
    hold: Annotated[
        bool, flag("--hold", "With --current: hold each current until the next row instead of interpolating.")
    ] = False,
    column: Theirs = None,
    order: Annotated[
        Path | None,
        out("FILE", "Play a session: icons in the order of this file, which has one name per line.", "--order"),
    ] = None,
    random: Annotated[
        int | None, opt("N", "Play a session: every icon N times, in random order.", 1, MOST_PLAYS)
    ] = None,
    gap: Annotated[
        float | None,
        opt(
            "S",
            "In a session: seconds from the end of one icon to the start of the next.  [default: 10]",
            0.0,
            LONGEST_GAP_S,
        ),
    ] = None,
    seed: Annotated[int | None, opt("SEED", "Seed of --random.  [default: 0]", 0, LARGEST_SEED)] = None,
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
            "ngspice then writes the probes); a session also to .json, its order to .txt.",
            "-o",
            "--output",
        ),
    ] = None,
    rate: Annotated[float, opt("HZ", "Samples per second.", 1e-3, 1e6)] = 100.0,
    tail: Annotated[
        float | None,
        opt("S", "Seconds simulated after the last corner.  [default: 0; 5 in figures and films]", 0.0, LONGEST_TAIL_S),
    ] = None,
) -> None:
    """Simulate icons: the current that plays them, and temperatures and heat flow down to the receptors.

    With --current, a given drive current is simulated instead; with --order or --random a session, as one run with one
    worst-case verdict (which is only reported: the exit code is 0 whatever its colour). Without -o, a short summary is
    printed.
    """
    session, suffix = order is not None or random is not None, "" if output is None else output.suffix.lower()
    circuit = suffix in NETLIST_SUFFIXES and not session and current is None
    needs_file = {"--icon": icon, "--tail": tail}
    alone = {"--rate": rate != 100.0, **needs_file}
    in_session = {"--gap": gap is not None, "--seed": seed is not None, "--tracking": tracking}
    _refuse({"--hold": hold, "--column": column}, current is None, "belongs to --current, which plays a drive")
    _refuse(in_session, not session, "belongs to a session; give --order FILE or --random N")
    _refuse({"--seed": seed is not None}, random is None, "belongs to --random")
    _refuse({"--figure": figure.figure, "--film": figure.film}, circuit, "belongs to a trace, not to a circuit")
    _refuse(
        {"--current": current, "--random": random and order, "--film": figure.film, **alone},
        session,
        "does not go with a session",
    )
    _refuse(needs_file, current is not None, "belongs to a cue FILE; a drive has no icons and ends at its last row")
    if (file is None) == (current is None):
        raise usage("give either a cue FILE or --current DRIVE.csv", "FILE")
    if current is not None:
        simulate_drive(current, hold, theirs_of(column), rig.load(), rate, output, figure)
    elif file is not None and circuit and output is not None:
        netlist_file(file, icon, rig, tail or 0.0, output)
    elif file is not None and session:
        session_file(file, rig, order, random, 10.0 if gap is None else gap, seed or 0, tracking, output, figure)
    elif file is not None:
        simulate_file(file, icon, rig, rate, tail, output, figure)


def _refuse(options: Mapping[str, object], where: bool, why: str) -> None:
    """Fail with a usage error for the first option that is given where it has no meaning."""
    for option, value in options.items():
        if where and value is not None and value is not False:
            raise usage(why, option)


def simulate_file(
    file: str,
    icon: str | None,
    asked: RigOptions,
    rate_Hz: float,
    tail_s: float | None,
    output: Path | None,
    figure: FilmOptions,
) -> None:
    """Play the icons of a file (or the one named) on the rig; write the traces, or print a summary of each."""
    from thermicon.circuit import nearest_reachable, simulate

    whole = read_set([file])
    if whole.spatial:
        _refuse({"--film": figure.film}, True, "shows one element, and this set is for several; draw a --figure")
        _check_outputs(file, output, [figure])
        runs = simulate_elements(whole, icon, asked, file, rate_Hz, tail_s or 0.0)
        played = [trace for run in runs for trace in run.named]
        tell(played, output, [None] * len(played))
        for run in runs:
            (figure.named(run.icon) if len(runs) > 1 else figure).write_rows(run)
        return
    icons, rig = pick(whole, icon), asked.load(whole, file)
    pictures = [figure.named(each.name) if len(icons) > 1 else figure for each in icons]
    _check_outputs(file, output, pictures)
    traces = [simulate(each, rig, rate_Hz=rate_Hz, tail_s=tail_s or 0.0) for each in icons]
    near = [None if one.reachable else nearest_reachable(each, rig) for each, one in zip(icons, traces, strict=True)]
    safe = tell(traces, output, [None if fit is None else fit.sentence for fit in near])
    if output is None:
        lost = [str(one.icon) for one, kept in zip(traces, safe, strict=True) if not (one.reachable and kept)]
        cured = [str(one.icon) for one, fit in zip(traces, near, strict=True) if fit is not None]
        typer.echo(f"Next: {after_simulating(cured, lost, commands([file], asked, CrowdOptions()))}")
    for each, picture in zip(icons, pictures, strict=True):
        if picture.figure or picture.film:
            picture.write_felt(simulate(each, rig, tail_s=FELT_TAIL_S if tail_s is None else tail_s), rig)


def simulate_drive(
    file: Path, hold: bool, theirs: dict[str, str], rig: Rig, rate_Hz: float, output: Path | None, figure: FilmOptions
) -> None:
    """Play a drive current from a CSV file on the rig; write the trace, or print a summary."""
    from thermicon.circuit.solver.drive import read_drive
    from thermicon.circuit.solver.simulate import simulate_current

    _check_outputs(file, output, [figure])
    with noted():
        played = read_drive(file, hold=hold, columns=theirs)
    tell([simulate_current(played, rig, rate_Hz=rate_Hz)], output, [None])
    if figure.figure or figure.film:
        figure.write_felt(simulate_current(played, rig), rig)


def _check_outputs(read: str | Path, output: Path | None, pictures: Sequence[FilmOptions]) -> None:
    """Fail where a file cannot be written or would replace what is read."""
    check_separate([read], [output, *(path for each in pictures for path in (each.figure, each.film))])
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a trace")


def tell(traces: Sequence[Trace], output: Path | None, cures: Sequence[str | None]) -> list[bool]:
    """Warn, and write the traces or print a summary of each; returns which are safe."""
    from thermicon.circuit.safety.verdict import judge_safety

    verdicts = [judge_safety(trace) for trace in traces]
    for trace, verdict in zip(traces, verdicts, strict=True):
        past = [f"{'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in verdict.findings]
        for warning in (*trace.beyond, *past):
            if warning not in trace.warnings:  # already reported when the rig was loaded
                note(f"warning: {trace.icon or 'drive'}: {warning}")
    for trace, better in zip(traces, cures, strict=True):
        if output is not None:
            note(headline(trace) + (f"; {better}" if better else ""))
        else:
            typer.echo(describe(trace) + (f"\n  nearest   {better}" if better else ""))
    if output is not None:
        write_traces(traces, output)
    return [verdict.safe for verdict in verdicts]


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
    note(f"wrote {output}")


def netlist_file(file: str, icon: str | None, asked: RigOptions, tail_s: float, output: Path) -> None:
    """Write the circuit of a rig that plays an icon; what ends with .sp makes ngspice write all probes."""
    from thermicon.circuit import netlist, simulate
    from thermicon.circuit.solver.inverse import design

    check_output(output, NETLIST_SUFFIXES, "a netlist")
    record = f"{output.stem}.txt" if output.suffix.lower() == NGSPICE else None
    check_separate([file], [output])
    icons = read_set([file])
    played, *others = pick(icons, icon)
    if others:
        names = ", ".join([each.name for each in (played, *others[:19])] + ["…"] * (len(others) > 19))
        raise usage(f"{file} has {len(others) + 1} icons; name one of {names}", "--icon")
    rig = asked.load(icons, file)
    trace = simulate(played, rig, tail_s=tail_s)
    plan = design(played, rig, float(trace.time_s[-1]))
    title = f"{played.name} of {Path(file).name}"
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, title=title, out_file=record)
    note(headline(trace))
    how = f"open it in LTspice, or run ngspice -b -r {output.stem}.raw {output.name}"
    if record is not None:
        how = f"ngspice -b {output.name} writes the probes into {record}"
    write_text(text, output, f"; {how}", "ascii")


def session_file(
    file: str,
    asked: RigOptions,
    order: Path | None,
    repeats: int | None,
    gap_s: float,
    seed: int,
    tracking: str | None,
    output: Path | None,
    figure: FigureOptions,
) -> None:
    """Simulate a session with the icons of a file, in the order of a file or shuffled; print and write the report."""
    from thermicon.circuit import SessionPlan, play_session
    from thermicon.circuit.safety.session_plan import order_text, read_order

    if output is not None:
        check_output(output, (*TRACE_SUFFIXES, NUMBERS, ORDER), "a session")
    check_separate([file] if order is None else [file, order], (output, figure.figure))
    icons = read_set([file])
    rig = asked.load(icons, file)
    if order is not None:
        plan = SessionPlan(read_order(order, icons), gap_s)
    else:
        plan = SessionPlan.shuffled([icon.name for icon in icons], repeats or 1, seed=seed, gap_s=gap_s)
    with progress_bar("worst case") as progress:
        played = [icons[name] for name in plan.names]
        session = play_session(played, plan, rig, tracking=tracking or "replay", progress=progress)
    if output is not None and output.suffix == ORDER:
        write_text(order_text(plan), output)
    elif output is not None and output.suffix == NUMBERS:
        write_text(session_text(session, icons, rig), output)
    elif output is not None:
        write_traces([session.trace], output)
    figure.write(lambda: session_figure(session))
    show(session_report(session))
    note(CAUTION)


def session_text(session: Session, icons: IconSet, rig: Rig) -> str:
    """The session as JSON text; missing values are null."""
    facts = {
        "thermicon": version("thermicon"),
        "content_hash": icons.content_hash,
        **session.to_dict(),
        "rig_changes": list(rig.changes),
        "rig_text": rig.document,
    }
    return json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

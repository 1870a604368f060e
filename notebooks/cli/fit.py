"""``thermicon fit``: rig parameters from measured logs, and what a log would identify before it is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.circuit.inputs import LONGEST_NAME, line_fault

from ..figures.figure_look import (
    SCREEN,
    FigureFile,
    FigureStyle,
    FigureWidth,
    Look,
    NoTitle,
    figure_look,
)
from ..files.outputs import FIGURE_SUFFIXES, check_output, check_separate, complete_or_absent
from ..messages import check_changes, load_rig, note, usage
from ..report.options import Changes, RigName

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.circuit.fitting.rig_fit import RigFit

OFFSET_K, MOST_OFFSET_K = 0.1, 10.0
"""As in `thermicon.circuit.fitting.fit`, repeated here to avoid its imports."""

RIG_SUFFIXES = (".toml",)


@dataclass(frozen=True, slots=True)
class Request:
    """Options of a fit."""

    free: tuple[str, ...]
    hold: bool | None = None
    fit_start: bool = False
    offset_K: float = OFFSET_K
    fixed_skin: bool = False
    output: Path | None = None
    figure: Path | None = None
    name: str | None = None
    look: Look = SCREEN


def fit_command(
    logs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="LOG",
            help="Measured logs: .csv, .tsv or .tdms. A file without a drive has a clock of its own and belongs to the "
            "file before it.",
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            "--free",
            metavar="KEY,KEY",
            help="Required: keys of the rig to fit. contact.resistance_m2K_per_W, contact.area_cm2; module. with "
            "seebeck_V_per_K, resistance_ohm, thermal_resistance_K_per_W, hot_plate_J_per_K, cold_plate_J_per_K; "
            "heat_sink. with temperature_C, resistance_K_per_W, capacity_J_per_K; driver.transconductance_A_per_V; "
            "ambient.temperature_C; skin.rest_C; load. with capacity_J_per_K, conductance_W_per_K, film_W_per_m2K; "
            "lags: controller.lag_s, probe.NAME.lag_s, thermode.lag_s; thermode.slew_K_per_s.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="NEW.toml", readable=False, help="Write the fitted rig as a rig file."),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option("--name", metavar="NAME", help="Name of the fitted rig.  [default: that of the file of -o]"),
    ] = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    plan: Annotated[
        bool, typer.Option("--plan", help="Without a log: how well each choice of sensors will identify these keys.")
    ] = False,
    hold: Annotated[
        bool | None,
        typer.Option(
            "--hold/--linear",
            help="Hold each row's drive until the next, or interpolate it.  [default: whichever fits better]",
        ),
    ] = None,
    fit_start: Annotated[
        bool, typer.Option("--fit-start", help="Fit the start as well, where the rig was not steady at the first row.")
    ] = False,
    offset: Annotated[
        float,
        typer.Option("--offset", metavar="K", help="What a temperature sensor may read off (standard deviation)."),
    ] = OFFSET_K,
    fixed_skin: Annotated[
        bool,
        typer.Option(
            "--fixed-skin",
            help="Take the skin's layers as the rig has them.  [default: fitted along, within the spread of people]",
        ),
    ] = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Fit parameters of a rig to measured logs: values with 95 % intervals, and what the logs do not identify.

    A log has time_s, a drive (current_A, voltage_V or command_V; setpoint_C on a thermode), and what was measured:
    display_C, skin_C, hot_plate_C, and voltage_V beside a current. The rig to begin with is that of --rig and --set.
    """
    check_changes(changes or [])
    keys = tuple(key for part in free or [] for key in part.split(","))
    if not any(key.strip() for key in keys):
        raise usage("name the keys to fit, such as --free contact.resistance_m2K_per_W", "--free")
    if plan and logs:
        raise usage("is for the time before there is a log; leave out LOG, or --plan", "--plan")
    if plan and (output or figure):
        raise usage("prints a table only; leave out -o and --figure", "--plan")
    if not plan and not logs:
        raise usage("give a LOG, or --plan to see what a log would identify", "LOG")
    if name is not None and output is None:
        raise usage("names the rig that -o writes; give -o NEW.toml", "--name")
    if name is not None and (fault := line_fault(name, LONGEST_NAME)):
        raise usage(fault, "--name")
    if not 0 <= offset <= MOST_OFFSET_K:
        raise usage(f"{offset:g} K is outside 0 to {MOST_OFFSET_K:g} K", "--offset")
    look = figure_look(figure, width, style, no_title)
    request = Request(keys, hold, fit_start, offset, fixed_skin, output, figure, name, look)
    if plan:
        show_plan(load_rig(rig, changes or []), request)
    else:
        fit_logs(logs or [], load_rig(rig, changes or []), request)


def fit_logs(logs: Sequence[str], rig: Rig, request: Request) -> None:
    """Fit a rig to logs, write the rig and the figure, and print the parameters."""
    from thermicon.circuit import fit

    if request.output is not None:
        check_output(request.output, RIG_SUFFIXES, "a rig")
    if request.figure is not None:
        check_output(request.figure, FIGURE_SUFFIXES, "a figure")
    check_separate(logs, [request.output, request.figure])
    fitted = fit(
        list(logs), rig, free=request.free, held=request.hold, fit_start=request.fit_start, offset_K=request.offset_K,
        fixed_skin=request.fixed_skin,
    )  # fmt: skip
    if request.output is not None:
        with complete_or_absent(request.output) as draft:
            draft.write_text(fitted.rig_text(request.name or request.output.stem[:LONGEST_NAME]), encoding="utf-8")
    if request.figure is not None:
        from thermicon.circuit.fitting.fit_figure import fit_figure

        from ..figures.print_figure import write_figure

        write_figure(fit_figure(fitted, 1 if request.look.narrow else 2), request.figure, request.look)
    show_fit(fitted, rig)
    for path in (request.output, request.figure):
        if path is not None:
            note(f"wrote {path}")


def show_fit(fitted: RigFit, before: Rig) -> None:
    """Print parameters, residuals, what was not identified, and the uncertainty that the rig gets."""
    from ..report.fit_text import doubts, parameter_table, residual_table, uncertainty_line
    from ..report.tables import show

    show(parameter_table(fitted), "", residual_table(fitted))
    for line in doubts(fitted):
        show("", line)
    if uncertain := uncertainty_line(fitted, before):
        show("", uncertain)
    for sentence in fitted.notes:
        note(f"note: {sentence}")


def show_plan(rig: Rig, request: Request) -> None:
    """Print how well each choice of sensors will identify the keys."""
    from thermicon.circuit.fitting.plan import plan

    from ..report.fit_text import PLAN_HEAD, plan_table
    from ..report.tables import show

    expected = plan(rig, request.free, offset_K=request.offset_K, fixed_skin=request.fixed_skin)
    show(PLAN_HEAD, "", plan_table(expected))

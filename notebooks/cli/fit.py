"""``thermicon fit``: rig parameters from measured logs or the plan of a log."""

from pathlib import Path
from typing import Annotated

import typer

from thermicon.base.files.inputs import LONGEST_NAME

from ..files.outputs import check_output, check_separate
from ..messages import note, usage
from ..report.fit_report import fit_report, plan_report
from ..report.terminal import show
from .options import FigureOptions, RigOptions, Theirs, flag, opt, theirs_of, write_text

OFFSET_K, MOST_OFFSET_K = 0.1, 10.0
"""As in `thermicon.circuit.fitting.fit`, repeated here to avoid its imports."""

RIG_SUFFIXES = (".toml",)


def fit_command(
    rig: RigOptions,
    figure: FigureOptions,
    logs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="LOG",
            help="Measured logs: tables or TDMS. A file without a drive has a clock of its own and belongs to the "
            "file before it.",
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        opt(
            "KEY,KEY",
            "Keys of the rig to fit. contact.resistance_m2K_per_W, contact.area_cm2; module. with "
            "seebeck_V_per_K, resistance_ohm, thermal_resistance_K_per_W, hot_plate_J_per_K, cold_plate_J_per_K; "
            "heat_sink. with temperature_C, resistance_K_per_W, capacity_J_per_K; driver.transconductance_A_per_V; "
            "ambient.temperature_C; skin.rest_C; "
            "lags: controller.lag_s, probe.NAME.lag_s.  [default: what the log can tell]",
            name="--free",
        ),
    ] = None,
    output: Annotated[
        Path | None, opt("NEW.toml", "Write the fitted rig as a rig file.", name="-o --output", readable=False)
    ] = None,
    plan: Annotated[
        bool, flag("--plan", "Without a log: how well each choice of sensors will identify these keys.")
    ] = False,
    offset: Annotated[
        float, opt("K", "What a temperature sensor may read off (standard deviation).", 0.0, MOST_OFFSET_K)
    ] = OFFSET_K,
    column: Theirs = None,
    fixed_skin: Annotated[
        bool,
        flag(
            "--fixed-skin",
            "Take the skin's layers as the rig has them.  [default: fitted along, within the spread of people]",
        ),
    ] = False,
) -> None:
    """Fit parameters of a rig to measured logs: values with 95 % intervals, and what the logs do not identify.

    A log is a table with time_s, a drive (current_A or command_V), and what was measured:
    display_C, skin_C, hot_plate_C, and voltage_V beside a current. Without a current, display_C is the drive of skin_C
    or a probe in the skin, and contact is fitted. The rig to begin with is that of --rig and --set.
    """
    keys = [key for part in free or [] for key in part.split(",")] if free else None
    if keys is not None and not any(key.strip() for key in keys):
        raise usage("names no key; name some, such as contact.resistance_m2K_per_W, or leave it out", "--free")
    if plan and logs:
        raise usage("is for the time before there is a log; leave out LOG, or --plan", "--plan")
    if plan and (output or figure.figure):
        raise usage("prints a table only; leave out -o and --figure", "--plan")
    if plan:
        from thermicon.circuit.fitting.synthetic_log import plan as expect

        show(plan_report(expect(rig.load(), keys, offset_K=offset, fixed_skin=fixed_skin)))
        return
    if not logs:
        raise usage("give a LOG, or --plan to see what a log would identify", "LOG")
    from thermicon.circuit import fit
    from thermicon.circuit.fitting.fit_figure import fit_figure
    from thermicon.circuit.fitting.log import read_logs

    where = rig.load()
    if output is not None:
        check_output(output, RIG_SUFFIXES, "a rig")
    check_separate(logs, [output, figure.figure])
    read = [each for log in logs for each in read_logs(log, theirs_of(column))]
    for name in theirs_of(column):
        if all(name in log.lost for log in read):
            raise usage("; ".join(log.lost[name] for log in read), "--column")
    early = [sentence for log in read for sentence in log.notes]
    for sentence in early:
        note(f"note: {sentence}")
    fitted = fit(read, where, free=keys, offset_K=offset, fixed_skin=fixed_skin)
    if output is not None:
        write_text(fitted.rig_text(output.stem[:LONGEST_NAME]), output)
    figure.write(lambda: fit_figure(fitted, 1 if figure.look.narrow else 2))
    show(fit_report(fitted, where))
    for sentence in fitted.notes:
        if sentence not in early:
            note(f"note: {sentence}")

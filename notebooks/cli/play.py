"""``thermicon play``: icons played and logged on a device under guard."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..loading import DEFAULT_RIG
from ..messages import REFUSED, STOPPED, MissingArgument, note, progress_bar, usage
from ..report.gate_words import CAUTION
from ..report.play_report import check_report, play_report
from ..report.terminal import show
from .export import LONGEST_PAUSE_S, refused, verify_folder
from .options import FileName, RigOptions, flag, opt, out, pick, read_set
from .stop_key import is_watched, stop_key

if TYPE_CHECKING:
    from thermicon.circuit import Export


def play_command(
    file: FileName,
    rig: RigOptions,
    icon: Annotated[list[str] | None, opt("NAME", "Only this icon; may be given several times.")] = None,
    order: Annotated[
        Path | None, out("FILE", "Play in the order of this file, which has one name per line.", "--order")
    ] = None,
    device: Annotated[
        Literal["simulated", "board"], typer.Option(help="What plays: a simulation, or a board of your own.")
    ] = "simulated",
    port: Annotated[str | None, opt("PORT", "Serial port of the board, such as /dev/ttyACM0 or COM5.")] = None,
    folder: Annotated[
        Path | None, out("DIR", "A new folder for log, prediction and settings of each play.", "-o", "--output")
    ] = None,
    pause: Annotated[
        float | None, opt("S", "Seconds between plays.  [default: 10, or more where needed]", 0.0, LONGEST_PAUSE_S)
    ] = None,
    check: Annotated[bool, flag("--check", "Only prepare: how each demand is met; then off again.")] = False,
    stated: Annotated[
        list[str] | None,
        opt("TEXT", "Who provides what the device does not hold: 'DEMAND: WHAT, WHO'; several times."),
    ] = None,
    amber: Annotated[bool, flag("--amber", "Play what the gate judges amber; red is never played.")] = False,
) -> None:
    """Play icons on a temperature controller: exported, judged, guarded and logged. FILE may be an exported folder.

    The device must switch off when its host is silent, and its polarity is tested, before it rests and plays. Space,
    Esc or Ctrl-C stop at once; the exit code is then 4, and 3 where nothing may be played. On a terminal the simulated
    controller plays in real time, elsewhere at once. Written from documents: no device was ever driven.
    """
    if folder is None and not check:
        raise MissingArgument("option '-o' / '--output'")
    if icon and order is not None:
        raise usage("names the icons itself; leave out --icon", "--order")
    if check and (folder is not None or order is not None):
        raise usage("plays nothing; leave out -o and --order", "--check")
    if (device == "board") != (port is not None):
        raise usage("belongs to --device board, which needs it", "--port")
    from thermicon.circuit.live.demanded import statements_of
    from thermicon.circuit.live.play_live import check_empty, play_export
    from thermicon.circuit.play.watch import Refused
    from thermicon.circuit.safety.playmap import UnjudgedError

    if folder is not None:
        check_empty(folder)
    statements_of(stated or [])  # a typing error is reported before all is judged
    slow = is_watched()
    try:
        made, names = exported(file, rig, icon, order, pause, whole=port is not None)
        if refused(made, may_force=False):
            note(CAUTION)
            raise Refused("nothing was put out")
        with stop_key() as pressed:
            result = play_export(
                made, names, pause_s=pause, amber=amber, stated=stated or [], folder=folder, real_time=slow,
                why_stop=pressed, tell=lambda text: note(f"{text} …") if slow else None, checks_only=check, port=port,
            )  # fmt: skip
    except (Refused, UnjudgedError) as problem:
        note(f"refused: {problem}", always=True)
        raise typer.Exit(REFUSED) from None
    show(check_report(result) if check else play_report(result))
    note("take the hand off: without power the display drifts by itself")
    if result.stopped:
        note(f"stopped: {result.stopped}; the output is off", always=True)
        raise typer.Exit(STOPPED)


def exported(
    file: str, rig: RigOptions, icon: list[str] | None, order: Path | None, pause_s: float | None, *, whole: bool
) -> tuple[Export, list[str]]:
    """The export of a set, or of a folder that was exported before, and the names to play in order.

    It has the icons that are played, or the `whole` set, from which a board was compiled.
    """
    from thermicon.circuit import Device
    from thermicon.circuit.live.ready import CONTROLLER, exported_before, judged
    from thermicon.circuit.safety.session_plan import read_order
    from thermicon.icons import IconSet
    from thermicon.icons.files.shipped import library_names

    is_folder = Path(file).is_dir() and file not in library_names()
    with progress_bar("simulating", "judging all together") as progress:
        if is_folder:
            verify_folder(Path(file))
            made = exported_before(Path(file), rig.load() if rig.given else None, pause_s, progress)
            icons = IconSet.of([each.delivery.icon for each in made.prepared])
        else:
            icons = read_set([file])
        names = list(read_order(order, icons)) if order else icon or [each.name for each in pick(icons, None)]
        if not is_folder:
            where = rig.load(icons, file)
            if rig.rig is None and where.name == DEFAULT_RIG:
                note(f"on the {where.name} rig; --rig names another")
            played = [icons[name] for name in dict.fromkeys(names)]
            chosen = pick(icons, None) if whole else played
            made = judged(chosen, where, Device.load(CONTROLLER), pause_s, progress)
    return made, names

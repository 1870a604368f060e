"""Live play on a device in one call."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thermicon.base.checks.arguments import checked
from thermicon.base.files.atomic import OutputError, check_folder, kept_text
from thermicon.base.files.inputs import InputError
from thermicon.base.numbers.program import this_program
from thermicon.icons.files.shipped import Icons, by_name

from ..delivery.delivered_drive import ModuleDrive
from ..delivery.device import Device
from ..delivery.export import Export
from ..delivery.formats.psychopy import guard_numbers
from ..delivery.pack import digest
from ..play.watch import Numbers, Refused
from ..rig.rig import AnyRig, Rig, rig_of
from ..safety.demands import Demands
from .controller import LONGEST_SILENCE_S, SimulatedController, settings_of
from .demanded import MetDemand, met_demands, refuse_missing, statements_of
from .live_player import LivePlayer, play_in_order
from .own_board import OwnBoard, board_numbers
from .play_log import MeasuredPlay, PlayLog, Seen
from .ready import CONTROLLER, judged

LOOK_EVERY_S = 0.05
SIMULATED, OWN = "a simulated controller", "a board"
NEVER_REPLACED = "give a new or empty folder, since a log is never overwritten"
USUAL_PAUSE_S = 10.0
"""As the gap of a session; a display is then back where the prediction of a play begins, within some hundredths."""


class SimulatedTime:
    """A clock in s that goes on only in `sleep`."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        """Return the time."""
        return self.now_s

    def sleep(self, seconds: float) -> None:
        """Let time pass."""
        self.now_s += seconds


@dataclass(frozen=True, slots=True, eq=False)
class LiveResult:
    """The result of live play: `plays` in order, and why it was `stopped`, empty where everything was played.

    `demands` says how each demand of the gate was met, `proofs` what was shown before the first play (s and K),
    `status` what the device says that it holds. Without a `folder` nothing was written.
    """

    plays: tuple[MeasuredPlay, ...]
    stopped: str
    demands: tuple[MetDemand, ...]
    proofs: Mapping[str, float]
    status: Mapping[str, Any]
    folder: Path | None

    def __repr__(self) -> str:
        names = ", ".join(f"{play.name} {play.told}" for play in self.plays)
        return f"LiveResult({names or 'checked'}{f'; STOPPED: {self.stopped}' if self.stopped else ''})"


@checked
def play_live(
    icons: Icons,
    rig: AnyRig = None,
    device: Device | str = CONTROLLER,
    *,
    order: Sequence[str] = (),
    pause_s: float | None = None,
    amber: bool = False,
    stated: Sequence[str] = (),
    folder: str | Path | None = None,
    real_time: bool = False,
    port: str | None = None,
) -> LiveResult:
    """Play icons on a simulated controller or a board, as `thermicon play` does, and return what it measured.

    The icons are exported as set-points, and the gate judges them; the device proves that it switches off when its
    host is silent, its polarity is tested, the rest is held, then icons are played in order under a guard. Written
    from documents: no device was ever driven.

    Parameters
    ----------
    icons
        A set, its name or file, or icons.
    rig
        The rig, or the name or file of one; None: the shipped rig of the icons' site, else thenar.
    device
        The temperature controller whose steps and rate set-points have, or the name or file of one.
    order
        Names in the order in which they are played, which may repeat; empty: each icon once.
    pause_s
        Pause in s between plays; None: 10 s, or more where the gate demands more.
    amber
        Whether to play what the gate judges amber.
    stated
        Who provides what the device does not hold, each as `demand: what, who`.
    folder
        A new or empty folder for log, predicted trace and settings of each play, and the rig; None writes nothing.
    real_time
        Whether the clock on the wall counts, not that of the simulation.
    port
        Serial port of a board that was compiled from an export of all these icons; None: the simulated controller.

    Returns
    -------
    LiveResult
        What was measured, and why it stopped if it did.

    Raises
    ------
    Refused
        Where the gate refuses, a demand is missing or a proof fails; nothing is played.
    InputError
        For icons, rigs, devices and folders that cannot be used.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> result = play_live(load_library("six-icons")["cooling-step"], "thenar")
    >>> result.stopped, result.plays[0].rms_K < 0.06
    ('', True)
    """
    chosen = tuple(by_name(icons).values())
    if not chosen:
        raise InputError("there is no icon to play; give at least one")
    on = Rig.of(rig, chosen[0].context.site)
    made = judged(chosen, on, device if isinstance(device, Device) else Device.load(device), pause_s)
    where = None if folder is None else Path(folder)
    how: dict[str, Any] = {"pause_s": pause_s, "amber": amber, "stated": stated, "folder": where}
    return play_export(made, order, **how, real_time=real_time, port=port)


def play_export(
    made: Export,
    order: Sequence[str] = (),
    *,
    pause_s: float | None = None,
    amber: bool = False,
    stated: Sequence[str] = (),
    folder: Path | None = None,
    real_time: bool = False,
    why_stop: Callable[[], str] = str,
    tell: Callable[[str], None] = lambda text: None,
    checks_only: bool = False,
    port: str | None = None,
    seen: Seen = lambda name, rows: None,
    timer: tuple[Callable[[], float], Callable[[float], None]] = (time.monotonic, time.sleep),
) -> LiveResult:
    """Play drives of an export on the board at a port, else on the simulated controller; or only prepare it.

    `seen` gets turns as they come; `timer` is clock and sleep in real time.
    """
    if made.barred:
        raise Refused("; ".join(f"{name}: {refusal}" for name, refusal in made.barred))
    cautions = [text for each in made.prepared if each.verdict.colour == "amber" for text in each.verdict.cautions]
    if cautions and not amber:
        raise Refused(f"the gate says amber: {cautions[0]}; ask for amber to play it nevertheless")
    known = {each.delivery.icon.name: each.delivery for each in made.prepared if isinstance(each.delivery, ModuleDrive)}
    unknown = [name for name in order if name not in known]
    if unknown:
        raise InputError(f"{unknown[0]} is not among the icons that were exported: {', '.join(known)}")
    drives = [known[name] for name in order or known]
    demands = Demands.strictest([each.verdict.demands for each in made.prepared])
    peak_A = max(float(abs(drive.trace.current_A).max()) for drive in drives)
    now = SimulatedTime()
    clock, sleep = timer if real_time or port else (now, now.sleep)
    line: SimulatedController | OwnBoard
    if port is None:
        line, device = SimulatedController(made.rig, settings_of(demands, peak_A), clock), SIMULATED
    else:
        line, device = OwnBoard(port, made, clock), OWN
    with closing(line):
        line.open()
        met = met_demands(demands, line.status(), statements_of(stated))
        refuse_missing(met)
        numbers = live_numbers(demands, any(row.label == "cut-off" and row.how == "held" for row in met))
        if checks_only:
            numbers = numbers._replace(rest_s=0.0, pause_s=0.0)
        if port is not None:
            numbers = board_numbers(numbers, demands)
        if folder is not None:
            _begin_folder(folder, made.rig, device)
        log = PlayLog(folder, seen)
        player = LivePlayer(line, numbers, log, clock, sleep, why_stop, tell)
        log.mark(device)
        stopped = ""
        try:
            stopped = play_in_order(
                player, drives, USUAL_PAUSE_S if pause_s is None else pause_s, plays=not checks_only
            )
        except Refused as problem:
            stopped = str(problem)
            raise
        finally:
            about = {
                "device": device,
                "thermicon": this_program(),
                "rig_sha256": digest(made.rig.document.encode()),
                "drives_sha256": {name: digest(made.form.write(drive)) for name, drive in known.items()},
                "status": line.status(),
                "demands": met,
                "proofs": player.proofs,
                "timing": {"worst_gap_s": player.worst_gap_s},
                "stopped": stopped,
            }
            plays = log.finish(about)
        why = stopped or log.unfinished
        return LiveResult(() if checks_only else plays, why, met, player.proofs, line.status(), folder)


def live_numbers(demands: Demands, device_protects: bool) -> Numbers:
    """What the guard keeps to: as in exported scripts, with more looks, since a device reports by itself.

    Where the device holds the cut-off, this computer may be late by as much as its watchdog allows.
    """
    numbers = guard_numbers(demands, closed_loop=True)
    if device_protects:
        numbers = numbers._replace(react_s=LONGEST_SILENCE_S, late_s=LONGEST_SILENCE_S)
    return numbers._replace(look_every_s=min(numbers.look_every_s, LOOK_EVERY_S))


def check_empty(folder: Path) -> None:
    """Fail now where a folder cannot be made, or holds anything: OutputError."""
    check_folder(folder)
    if folder.is_dir() and (there := sorted(path.name for path in folder.iterdir())):
        raise OutputError(f"{kept_text(folder, there)}; {NEVER_REPLACED}")


def _begin_folder(folder: Path, rig: Rig, device: str) -> None:
    """Make the folder, with the rig that its logs are of."""
    check_empty(folder)
    folder.mkdir(exist_ok=True)
    document = json.loads(rig.document)
    notes = [*document.get("notes", []), f"the logs beside this file are of {device}"]
    rig_of({**document, "notes": notes}, f"rig {rig.name}").save(folder / "rig.toml")

"""Live play on a simulated controller in one call."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from thermicon.base.checks.arguments import checked
from thermicon.base.files.atomic import OutputError, check_folder, kept_text
from thermicon.base.files.inputs import InputError
from thermicon.base.numbers.program import this_program
from thermicon.icons.files.shipped import Icons, by_name

from ..delivery.device import Device
from ..delivery.formats.psychopy import guard_numbers
from ..delivery.pack import digest
from ..play.watch import Numbers, Refused
from ..rig.rig import AnyRig, Rig, rig_of
from ..safety.demands import Demands
from .controller import LONGEST_SILENCE_S, ControllerSettings, SimulatedController
from .demanded import MetDemand, met_demands, refuse_missing, statements_of
from .live_player import LivePlayer, Proofs, play_in_order
from .play_log import MeasuredPlay, PlayLog
from .ready import CONTROLLER, ReadySet, judged

LOOK_EVERY_S = 0.05
SIMULATED = "a simulated controller"
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
    """The result of live play.

    `plays` has what was measured of each icon in order, `stopped` why it was stopped, empty where everything was
    played; `demands` how each demand of the gate was met, `proofs` what was shown before the first play, `status` what
    the device says that it holds. `rig` has the device's sensors as probes; without a `folder` nothing was written.
    """

    plays: tuple[MeasuredPlay, ...]
    stopped: str
    demands: tuple[MetDemand, ...]
    proofs: Proofs
    status: Mapping[str, Any]
    rig: Rig
    folder: Path | None

    def __repr__(self) -> str:
        names = ", ".join(f"{play.name} {1e3 * play.rms_K:.0f} mK rms" for play in self.plays)
        return f"LiveResult({names or 'checked'}{f'; STOPPED: {self.stopped}' if self.stopped else ''})"


@checked
def play_live(
    icons: Icons,
    rig: AnyRig = None,
    device: Device | str = CONTROLLER,
    *,
    order: Sequence[str] | None = None,
    pause_s: float | None = None,
    amber: bool = False,
    stated: Sequence[str] = (),
    folder: str | Path | None = None,
    real_time: bool = False,
) -> LiveResult:
    """Play icons on a simulated controller, as `thermicon play` does, and return what it measured.

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
        Names in the order in which they are played, which may repeat; None: each icon once.
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
    made = judged(chosen, on, device if isinstance(device, Device) else Device.load(device), pause_s, None)
    if made.barred:
        raise Refused("; ".join(f"{name}: {refusal}" for name, refusal in made.barred))
    ready = ReadySet.of(made)
    if ready.amber and not amber:
        raise Refused(f"amber, since {ready.amber[0]}: amber=True plays it")
    now = SimulatedTime()
    clock, sleep = (time.monotonic, time.sleep) if real_time else (now, now.sleep)
    pause_s = USUAL_PAUSE_S if pause_s is None else pause_s
    return play_ready(ready, order, clock, sleep, pause_s, stated, None if folder is None else Path(folder))


def play_ready(
    ready: ReadySet,
    order: Sequence[str] | None,
    clock: Callable[[], float],
    sleep: Callable[[float], None],
    pause_s: float = 0.0,
    stated: Sequence[str] = (),
    folder: Path | None = None,
    *,
    why_stop: Callable[[], str] = str,
    tell: Callable[[str], None] = lambda text: None,
    checks_only: bool = False,
) -> LiveResult:
    """Play drives that the gate has judged on the simulated controller, or only prepare it (`checks_only`)."""
    names = list(order or ready.drives)
    unknown = [name for name in names if name not in ready.drives]
    if unknown:
        raise InputError(f"{unknown[0]} is not among the icons that were exported: {', '.join(ready.drives)}")
    drives, said = [ready.drives[name] for name in names], statements_of(stated)
    peak_A = max(drive.peak_A for drive in drives)
    line = SimulatedController(ready.rig, ControllerSettings.of(ready.demands, peak_A), clock)
    met = met_demands(ready.demands, line.status(), said)
    refuse_missing(met)
    if folder is not None:
        _begin_folder(folder, ready.rig)
    log = PlayLog(
        folder, {"device": SIMULATED, "thermicon": this_program(), "rig_sha256": digest(ready.rig.document.encode())}
    )
    numbers = live_numbers(ready.demands, any(row.label == "cut-off" and row.how == "held" for row in met))
    player = LivePlayer(line, numbers, log, clock, sleep, why_stop, tell)

    def settings() -> dict[str, object]:
        return {
            "status": line.status(),
            "demands": [asdict(row) for row in met],
            "proofs": asdict(player.proofs),
            "timing": {"worst_gap_s": player.worst_gap_s},
        }

    log.mark(SIMULATED)
    plays: tuple[MeasuredPlay, ...] = ()
    if checks_only:
        why = player.check(drives[0].rows[0][1])
    else:
        plays, why = play_in_order(player, drives, pause_s, settings)
    return LiveResult(plays, why, met, player.proofs, line.status(), ready.rig, folder)


def live_numbers(demands: Demands, device_protects: bool) -> Numbers:
    """What the guard keeps to: as in exported scripts, with more looks, since a device reports by itself.

    Where the device holds the cut-off, this computer may be late by as much as its watchdog allows.
    """
    numbers = guard_numbers(demands, closed_loop=True)
    if device_protects:
        numbers = numbers._replace(react_s=LONGEST_SILENCE_S, late_s=LONGEST_SILENCE_S)
    return numbers._replace(look_every_s=min(numbers.look_every_s, LOOK_EVERY_S))


def check_play_folder(folder: Path) -> None:
    """Raise OutputError for a folder that is not new or empty, or cannot be made."""
    check_folder(folder)
    there = sorted(path.name for path in folder.iterdir()) if folder.exists() else []
    if there:
        raise OutputError(f"{kept_text(folder, there)}; give a new or empty folder, since a log is never overwritten")


def _begin_folder(folder: Path, rig: Rig) -> None:
    """Make the folder, with the rig that its logs are of."""
    check_play_folder(folder)
    folder.mkdir(exist_ok=True)
    document = json.loads(rig.document)
    notes = [*document.get("notes", []), f"the logs beside this file are of {SIMULATED}"]
    rig_of({**document, "notes": notes}, f"rig {rig.name}").save(folder / "rig.toml")

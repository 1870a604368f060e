"""Simulation of a session as one run.

A session is a given sequence, so the gate judges it as one play, without repetition. Single faults of the hardware are
judged by an export, not here.

A break, in which the hand is off and then lands again, brings skin and module back towards rest. With a given current
every temperature and every rate is affine in the state that a play begins from, so that a block after a break lies
between the block within one run without breaks and the block from rest: both are judged.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import quiet_blas
from thermicon.base.words.near_words import did_you_mean
from thermicon.icons import Icon
from thermicon.icons.files.shipped import Icons, by_name

from ..rig.rig import AnyRig, Rig
from ..rig.rules import Limits
from ..solver.batch_inputs import bank_of, run_follow
from ..solver.drive import Drive
from ..solver.inverse import Design, baseline_C, design, regulated, target_at
from ..solver.simulate import duration_s, simulate, simulate_current
from ..solver.trace import Trace
from .checks import Check, Judged, worst_of
from .current import CurrentPlant, CurrentPlay
from .ensemble import Ensemble
from .exposure import cem43_min, henriques
from .plant import Single
from .session import Session, SessionPlay
from .session_plan import SessionError, SessionPlan, check_length
from .tally import WATCHED, Tally
from .verdict import SafetyVerdict, checks_of

TRACKINGS = ("replay", "display")
"""The current of each icon open loop, as exported drives are played; or its display temperature, as a thermode does."""

SLOWEST_HZ = 100.0
"""Fewest rows per second: over more than 10 ms, a mean rate would hide how steep the skin's temperature was."""

MOST_ROWS = 1_500_000
"""Rows of a session, which take about 0.5 GB while they are computed."""

_Timed = tuple[str, int, int]
"""Name of an icon, the update with which it starts, and how many it takes."""


@dataclass(frozen=True, slots=True)
class SessionDrive:
    """The drive of a session, begun from `start_C` that `rest_A` has held; rows at `rate_Hz` meet all its changes."""

    drive: Drive
    rest_A: float
    start_C: Array
    starts_s: tuple[float, ...]
    ends_s: tuple[float, ...]
    rate_Hz: float


def drive_of(plan: SessionPlan, icons: Mapping[str, Icon], rig: Rig, tracking: str = "replay") -> SessionDrive:
    """The one drive of a session, by each icon's own current from rest, or by all display temperatures; icons start at
    the first update of the driver after their gap.
    """
    if tracking not in TRACKINGS:
        raise SessionError(f"tracking {tracking!r} is not known; it is one of {', '.join(TRACKINGS)}")
    lasting = {name: duration_s(icons[name], rig) for name in plan.names}
    total = check_length([lasting[name] for name in plan.order], plan.gap_s)
    update = rig.driver.update_Hz
    rate = update * max(1, math.ceil(SLOWEST_HZ / update - 1e-9))
    if total * rate > MOST_ROWS:
        raise SessionError(
            f"{total:.0f} s at the driver's {update:g} Hz are {total * rate:.0f} rows; the limit is {MOST_ROWS:,}: "
            f"play fewer icons at once, or lower driver.update_Hz"
        )
    timed, begin = list[_Timed](), 0.0
    for name in plan.order:
        start = math.ceil(begin * update - 1e-6)
        timed.append((name, start, max(1, math.ceil(lasting[name] * update - 1e-9))))
        begin = start / update + lasting[name] + plan.gap_s
    drive, first = (_replayed if tracking == "replay" else _tracked)(timed, icons, lasting, rig)
    starts = tuple(start / update for _, start, _ in timed)
    ends = tuple(start + lasting[name] for name, start in zip(plan.order, starts, strict=True))
    return SessionDrive(drive, first.rest_A, first.start_C, starts, ends, rate)


def _replayed(
    timed: Sequence[_Timed], icons: Mapping[str, Icon], lasting: Mapping[str, float], rig: Rig
) -> tuple[Drive, Design]:
    plans = {name: design(icons[name], rig, lasts_s) for name, lasts_s in lasting.items()}
    counts = {name: count for name, _, count in timed}
    currents = {name: held_A(plan.drive, counts[name], rig.driver.update_Hz) for name, plan in plans.items()}
    places, values = [], []
    following = [*(start for _, start, _ in timed[1:]), timed[-1][1] + timed[-1][2] + 1]
    for (name, start, count), after in zip(timed, following, strict=True):
        last = min(count, after - start)  # an icon that ends within an update gives way to the next one
        places.append(start + np.arange(last))
        values.append(currents[name][:last])
        if start + last < after:
            places.append(np.array([start + last]))
            values.append(np.array([plans[name].rest_A]))
    drive = Drive(np.concatenate(places) / rig.driver.update_Hz, np.concatenate(values), held=True)
    return drive, plans[timed[0][0]]


def _tracked(
    timed: Sequence[_Timed], icons: Mapping[str, Icon], lasting: Mapping[str, float], rig: Rig
) -> tuple[Drive, Design]:
    """The driver's own currents for set-points at the end of every update of the whole session."""
    update, counts = rig.driver.update_Hz, {name: count for name, _, count in timed}
    displays = {name: _setpoints(icons[name], rig, counts[name], lasts_s) for name, lasts_s in lasting.items()}
    named = timed[0][0]
    ends = timed[-1][1] + timed[-1][2]
    target = np.full(ends, displays[named][0])
    for name, start, count in timed:
        base, levels = displays[name]
        target[start : start + count] = levels
        target[start + count :] = base
    first = design(icons[named], rig, lasting[named])
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    if rig.controller is None:
        states = bank.states([first.start_C])
        current = run_follow(bank, lane, lane, 1.0 / update, target[np.newaxis], False, states)[0][0]
    else:
        setpoint = np.concatenate([[displays[named][0]], target[:-1]])
        current = regulated(rig, bank, setpoint, (first.rest_A, first.start_C))[0]
    return Drive(np.arange(ends + 1) / update, np.append(current, first.rest_A), held=True), first


def _setpoints(icon: Icon, rig: Rig, count: int, lasts_s: float) -> tuple[float, Array]:
    control, base = icon.context.control, baseline_C(icon, rig)
    if control == "current":
        raise SessionError(
            f"{icon.name} prescribes the current, so there is no display temperature to track; use tracking replay"
        )
    update = rig.driver.update_Hz
    if control == "display":
        return base, target_at(icon, base, np.arange(1, count + 1) / update)
    display = simulate(icon, rig, rate_Hz=update, tail_s=count / update - lasts_s).display_C
    return float(display[0]), display[1 : count + 1]


def held_A(drive: Drive, count: int, update_Hz: float) -> Array:
    """Currents in A held over `count` updates: a drive's own, or the means of one that is linear between its rows."""
    if drive.held:
        return drive.current_A[:count]
    edges = np.arange(count + 1) / update_Hz
    times = np.union1d(drive.time_s, edges)
    currents = np.interp(times, drive.time_s, drive.current_A)
    charge = np.concatenate([[0.0], np.cumsum(0.5 * (currents[1:] + currents[:-1]) * np.diff(times))])
    return np.asarray(np.diff(np.interp(edges, times, charge)) * update_Hz)


Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class WorstCase(Judged):
    """Every rule in its worst scenario, how many there are, and the recovery after the end in s; None: over 10 min."""

    checks: tuple[Check, ...]
    scenarios: int
    recovery_s: float | None


@checked
def play_session(
    icons: Icons,
    plan: SessionPlan,
    rig: AnyRig = None,
    *,
    tracking: str = "replay",
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> Session:
    """Simulate the icons of a plan in sequence on a rig, as one continuous run.

    Parameters
    ----------
    icons
        The icons that the plan names: a set, its name or file, or several.
    plan
        Order of play and gap.
    rig
        The rig, or the name or file of one; None: the shipped rig of the icons' site, else thenar.
    tracking
        `replay` plays the current of each icon, designed from rest, open loop, as exported drives are, and its holding
        current in the gaps; with `display` the driver follows each icon's display temperature, as a thermode does.
    limits
        Limits in place of the rig's.
    progress
        Called with the seconds of the worst case that are done, and their total.

    Returns
    -------
    Session
        One row per update of the driver, and at least 100 rows per second, with the verdict.

    Raises
    ------
    SessionError
        Where the plan names an icon that is not given, is too long, or cannot be tracked.
    RigError
        Where the rig cannot hold a baseline.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> plan = SessionPlan(("cooling-step", "warming-step"), gap_s=10.0)
    >>> play_session(load_library("six-icons"), plan, Rig.load("thenar"))
    Session(green: 2 plays in 26 s on thenar, skin 26.92 … 34.77 °C, baseline drift -0.80 K, 0 min CEM43)
    """
    planned = set(plan.names)
    known = {name: icon for name, icon in by_name(icons).items() if name in planned}
    for name in plan.names:
        if name not in known:
            raise SessionError(f"the plan names {name}, which is not among the icons; {did_you_mean(name, known)}")
    rig = Rig.of(rig, known[plan.names[0]].context.site)
    played = drive_of(plan, known, rig, tracking)
    trace = simulate_current(played.drive, rig, rate_Hz=played.rate_Hz, start_C=played.start_C)
    rules = rig.limits if limits is None else limits
    worst = worst_case_of([played], rig, rules, progress)
    power = np.append(trace.voltage_V[:-1] * trace.current_A[:-1] * np.diff(trace.time_s), 0.0)
    plays = tuple(_plays(plan, played, trace, rules, power))
    return Session(
        plan=plan,
        tracking=tracking,
        rest_A=played.rest_A,
        trace=trace,
        plays=plays,
        limits=rules,
        uncertainty=rig.uncertainty,
        scenarios=worst.scenarios,
        checks=worst.checks,
        dose_cem43_min=float(cem43_min(trace.time_s, trace.skin_C)[-1]),
        henriques=float(henriques(trace.time_s, trace.skin_C)[-1]),
        energy_J=float(power.sum()),
        recovery_s=worst.recovery_s,
    )


def _plays(
    plan: SessionPlan, played: SessionDrive, trace: Trace, limits: Limits, energy_J: Array
) -> Iterator[SessionPlay]:
    first = np.rint(np.array(played.starts_s) * played.rate_Hz).astype(np.int64)
    rest = float(trace.skin_C[0])
    for place, (begin, until) in enumerate(pairwise([*first.tolist(), len(trace.time_s) - 1])):
        rows = slice(begin, until + 1)
        times, skin, display = trace.time_s[rows], trace.skin_C[rows], trace.display_C[rows]
        columns = {name: getattr(trace, name)[np.newaxis, rows] for name in WATCHED}
        verdict = SafetyVerdict(checks_of(limits, times, columns))
        yield SessionPlay(
            icon=plan.order[place],
            start_s=played.starts_s[place],
            end_s=played.ends_s[place],
            verdict=verdict.colour,
            reason=verdict.reason or next(iter(verdict.cautions), None),
            drift_K=float(skin[0]) - rest,
            skin_min_C=float(skin.min()),
            skin_max_C=float(skin.max()),
            display_min_C=float(display.min()),
            display_max_C=float(display.max()),
            dose_cem43_min=float(cem43_min(times, skin)[-1]),
            energy_J=float(energy_J[begin:until].sum()),
        )


def worst_case_of(
    blocks: Sequence[SessionDrive], rig: Rig, limits: Limits, progress: Progress | None = None
) -> WorstCase:
    """Check blocks of a session in all corners, each from rest; doses add up over them, times run on without breaks."""
    plays = [CurrentPlay(played.drive, played.rest_A) for played in blocks]
    total_s = round(sum(play.end_s for play in plays))

    def watch(time_s: float) -> None:
        if progress is not None:
            progress(round(time_s), total_s)

    with quiet_blas():
        plant, before_s, endings = CurrentPlant.of(Ensemble.of(rig)), 0.0, list[Tally]()
        whole = Tally(limits, plant.corners)
        for play in plays:
            single = Single.of(plant, play, limits, before_s=before_s, sums=whole, watch=watch)
            before_s += play.end_s
            endings += single.tallies[1:-1]
        checks = worst_of(tally.checks() for tally in (whole, *endings, single.tallies[-1]))
        return WorstCase(checks, len(plant.corners) * len(plant.endings), single.recovery_s)

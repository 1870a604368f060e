"""The inverse problem: the current that produces a cue's prescribed temperature."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array, Index
from thermicon.icons import Icon

from ..rig.rig import AnyRig, Rig
from .batch_inputs import Bank, bank_of, cut, run_follow, run_forward, run_regulate
from .drive import Drive
from .network import network_of
from .steady import state_under_current, steady_state
from .trace import Outcome, judge

LIMITS = ("", "current limit", "lower current limit", "compliance voltage", "current of greatest cooling")
"""What limited a current, by the code of the kernel."""


@dataclass(frozen=True, slots=True, eq=False)
class Design:
    """The current designed for a cue on a rig; before it, `rest_A` holds the steady state `start_C` (°C)."""

    drive: Drive
    rest_A: float
    start_C: Array
    outcome: Outcome | None

    def __repr__(self) -> str:
        reached = "" if self.outcome is None else f", {'reached' if self.outcome.reached else 'NOT reached'}"
        return f"Design({self.drive!r}, rest {self.rest_A:.3g} A{reached})"


def periods(rig: Rig, end_s: float) -> Array:
    """Ends in s of the driver periods that cover a time."""
    count = max(1, math.ceil(end_s * rig.driver.update_Hz - 1e-9))
    return np.arange(1, count + 1) / rig.driver.update_Hz


def baseline_C(icon: Icon, rig: Rig) -> float:
    """Baseline of a cue in °C: its own, or the rig's rest."""
    return rig.skin.rest_C if icon.context.baseline_C is None else icon.context.baseline_C


def target_at(icon: Icon, start: float, times_s: Array) -> Array:
    """The prescribed level at times in s: °C, or A under current control; the last level is kept."""
    corners = icon.corners(start)
    return np.asarray(np.interp(times_s, corners.time_s, corners.value), dtype=np.float64)


def steps_at(icon: Icon, start: float) -> tuple[tuple[float, float], ...]:
    """When a cue steps, in s, and by when it must have arrived: the end of the hold behind, or the next step."""
    corners, steps = icon.corners(start), []
    times, levels = corners.time_s, corners.value
    begins = [times[place] for place in corners.steps]
    for place, begin, following in zip(corners.steps, begins, [*begins[1:], math.inf][: len(begins)], strict=True):
        followed_by_hold = place + 2 < len(levels) and levels[place + 2] == levels[place + 1]
        steps.append((begin, times[place + 2] if followed_by_hold else following))
    return tuple(steps)


@checked
def design(icon: Icon, rig: AnyRig, end_s: float) -> Design:
    """Return the current that plays a cue on a rig.

    Parameters
    ----------
    icon
        The cue.
    rig
        A rig with a module, or the name or file of one.
    end_s
        Time in s until which the current is designed; the last level is held.

    Returns
    -------
    Design
        The drive, its resting current, and whether the target is reached. Skin and display control give a current held
        over each driver period; current control gives the corners of the cue.

    Raises
    ------
    RigError
        For a baseline that the rig cannot hold.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> design(load_library("six-icons")["cooling-step"], Rig.load("thenar"), 8.0)
    Design(Drive(801 rows, 8 s, -0.477... … 1.108... A, held), rest 0.0828 A, reached)
    """
    rig = Rig.of(rig)
    plan = design_ideal(icon, rig, end_s)
    if rig.controller is None or icon.context.control == "current":
        return plan
    # The currents of the rig's own PID loop, whose set-point is the display of the cue, or that of the ideal plan.
    period, control, base = 1.0 / rig.driver.update_Hz, icon.context.control, baseline_C(icon, rig)
    target = target_at(icon, base, periods(rig, end_s))
    setpoint = _along(rig, plan, "display_C")[:-1] if control == "skin" else np.concatenate([[base], target[:-1]])
    currents, reached, why = regulated(rig, bank_of(rig), setpoint, (plan.rest_A, plan.start_C))
    loop = replace(plan, drive=Drive(plan.drive.time_s, [*currents, currents[-1]], held=True))
    controlled = _along(rig, loop, "skin_C")[1:] if control == "skin" else reached
    return replace(loop, outcome=judge(target, controlled, period, _limits(why, period), steps_at(icon, base)))


def design_ideal(icon: Icon, rig: Rig, end_s: float) -> Design:
    """As `design`, by the inverse of the module alone, without the rig's own control loop."""
    if icon.context.control != "current":
        return _designs([icon], rig, icon.context.control, end_s)[0]
    current, _ = steady_state(rig, "display", baseline_C(icon, rig))
    corners = icon.corners(current)
    times, values = list(corners.time_s), list(corners.value)
    if end_s > times[-1] + 1e-9:
        times.append(end_s)
        values.append(values[-1])
    return Design(Drive(times, values), current, state_under_current(network_of(rig), current), None)


def design_many(icons: Sequence[Icon], rig: Rig, end_s: float) -> tuple[Design, ...]:
    """Designs of many cues on one rig, as `design` gives each; side by side, but for current control and loops."""
    designs: dict[int, Design] = {}
    for control in ("skin", "display") if rig.controller is None else ():
        cues = [icon for icon in icons if icon.context.control == control]
        if cues:
            designs.update(zip(map(id, cues), _designs(cues, rig, control, end_s), strict=True))
    return tuple(designs.get(id(icon)) or design(icon, rig, end_s) for icon in icons)


def _designs(icons: Sequence[Icon], rig: Rig, control: str, end_s: float) -> list[Design]:
    bank, ends, period = bank_of(rig), periods(rig, end_s), 1.0 / rig.driver.update_Hz
    bases = [baseline_C(icon, rig) for icon in icons]
    rest = {base: steady_state(rig, control, base) for base in dict.fromkeys(bases)}
    targets = np.array([target_at(icon, base, ends) for icon, base in zip(icons, bases, strict=True)])
    lanes = np.arange(len(icons), dtype=np.int64)
    begun = bank.states([rest[base][1] for base in bases])
    results = run_follow(bank, np.zeros_like(lanes), lanes, period, targets, control == "skin", begun)
    designs = []
    for icon, base, target, start, currents, reached, why in zip(icons, bases, targets, begun, *results, strict=True):
        outcome = judge(target, reached, period, _limits(why, period), steps_at(icon, base))
        drive = Drive(np.append(0.0, ends), np.append(currents, currents[-1]), held=True)
        designs.append(Design(drive, rest[base][0], start, outcome))
    return designs


def gains_of(rig: Rig) -> tuple[float, float, float, float, float]:
    """Thermistor lag s, gains A/K, A/(K·s), A·s/K and delay s of a rig's own loop, which has none in a simulation."""
    pid = rig.controller
    assert pid is not None
    return pid.lag_s, pid.kp_A_per_K, pid.ki_A_per_Ks, pid.kd_As_per_K, 0.0


def regulated(
    rig: Rig, bank: Bank, goals_C: Array, rest: tuple[float, Array], gain: float = 1.0
) -> tuple[Array, Array, Index]:
    """Current A, display °C and code of the limit of each update, by a rig's loop on the first of `bank`.

    `rest` has current and state before; `gain` is that of the current source.
    """
    from .kernel_regulate import KD, KI, KP

    lane, gains = np.zeros(1, dtype=np.int64), np.array([gains_of(rig)])
    gains[:, [KP, KI, KD]] *= gain
    period, bias = 1.0 / rig.driver.update_Hz, np.array([rest[0]])
    found = run_regulate(bank, lane, lane, period, goals_C[np.newaxis], gains, bias, bank.states([rest[1]]))
    return found[0][0], found[1][0], found[2][0]


def _along(rig: Rig, plan: Design, probe: str) -> Array:
    """A probe at the beginning of every driver period of a design, and at its end."""
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    intervals = cut(plan.drive.time_s, plan.drive.time_s, plan.drive.current_A[np.newaxis], held=True)
    return np.asarray(run_forward(bank, lane, lane, intervals, bank.states([plan.start_C]), (probe,))[0, 0])


def _limits(why: Index, period: float) -> tuple[tuple[str, float], ...]:
    met = ((LIMITS[int(code)], float(np.argmax(why == code)) * period) for code in np.unique(why) if code)
    return tuple(sorted(met, key=lambda limit: limit[1]))

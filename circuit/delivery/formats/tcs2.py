"""TCS II: the commands of its serial line, which play any profile on all five zones, and its protocol file.

A protocol holds a baseline, a trigger, and one stimulation that ramps, holds and returns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from thermicon.icons.model.corners import Corners

from ...solver.inverse import baseline_C
from ..delivered_drive import DeliveredDrive
from ..setpoints import Setpoints
from .form import PLAYS_SETPOINTS, Column, Format, FormatError, setpoints_in

ALL_ZONES = "11111"
ABOVE_K, MOST = 1.0, 600
"""The greatest temperature of a stimulation (Om) is set this far above the highest set-point, up to the 60 °C that the
instrument reaches, in tenths of a degree."""


TICK_S, STEP_K, LARGEST = 0.01, 0.1, 999
"""Units of the commands: segments last ticks of 10 ms, levels are tenths of a degree, each in three digits."""


def serial_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """The commands, one per line."""
    return (
        Column("N", "0.1 °C", "baseline"),
        Column("Om", "0.1 °C", "greatest temperature that the C command may ask for"),
        Column("Uw", "10 ms, 0.1 °C", "zones, number of segments, then duration and level at the end of each"),
        Column("Ue", "", "zones that play the profile"),
        Column("L", "", "start; send it when the trial begins"),
    )


def serial_write(delivery: DeliveredDrive) -> bytes:
    """Return the commands; the last, L, starts the stimulation."""
    setpoints = setpoints_in(delivery)
    _check(setpoints, delivery.device.name)
    greatest = max(setpoints.baseline, *(level for _, level in setpoints.segments)) + round(ABOVE_K / setpoints.step_K)
    segments = "".join(f"{ticks:03d}{level:03d}" for ticks, level in setpoints.segments)
    commands = [
        f"N{setpoints.baseline:03d}",
        f"Om{min(greatest, MOST):03d}",
        f"Uw{ALL_ZONES}{len(setpoints.segments):03d}{segments}",
        f"Ue{ALL_ZONES}",
        "L",
    ]
    return ("\n".join(commands) + "\n").encode("ascii")


def _check(setpoints: Setpoints, device: str) -> None:
    """Raise FormatError where the commands would differ from the set-points."""
    if abs(setpoints.tick_s - TICK_S) > 1e-9 or abs(setpoints.step_K - STEP_K) > 1e-9:
        raise FormatError(
            f"tcs2-serial counts ticks of {TICK_S * 1e3:g} ms and steps of {STEP_K:g} K; {device} has "
            f"{setpoints.tick_s * 1e3:g} ms and {setpoints.step_K:g} K: use qst-tcs2"
        )
    numbers = [setpoints.baseline, len(setpoints.segments), *(n for segment in setpoints.segments for n in segment)]
    if wrong := [number for number in numbers if not 0 <= number <= LARGEST]:
        raise FormatError(
            f"tcs2-serial writes numbers of three digits, 0 to {LARGEST}; {wrong[0]} is needed for {device}: use "
            f"levels from 0 to {LARGEST * STEP_K:g} °C, and segments and ticks up to {LARGEST}"
        )


SERIAL = Format(
    name="tcs2-serial",
    title="commands for the serial line of a QST.Lab TCS II",
    suffix=".tcs2.txt",
    takes=PLAYS_SETPOINTS,
    device="qst-tcs2",
    source="pytcsii (mpcoll), list of commands in its header",
    how="115,200 baud: send each line without its line feed; wait at the baseline before L; A aborts",
    write=serial_write,
    columns=serial_columns,
)


ZONES = (1, 2, 3, 4, 5)
MOST_OFF = 0.01
"""Share by which three decimals may change a rate or a duration."""
TRIGGER_CODE, TRIGGER_S = 255, 0.3
"""Trigger out with the stimulation, as pytcsii has it."""


@dataclass(frozen=True, slots=True)
class Stimulus:
    """Baseline and target in °C, rates of the ramp and of the return in K/s, both positive, ramp and plateau in s.

    The duration counts the ramp and the plateau, not the return, for cooling as for warming.
    """

    baseline_C: float
    target_C: float
    rise_K_per_s: float
    return_K_per_s: float
    duration_s: float


def stimulus_of(corners: Corners, fastest_K_per_s: float) -> Stimulus:
    """Return a cue as ramp, plateau and return; raises FormatError for any other shape.

    >>> stimulus_of(Corners((0, 2, 4, 6), (30, 24, 24, 30), "temperature_C"), 300.0)
    Stimulus(baseline_C=30.0, target_C=24.0, rise_K_per_s=3.0, return_K_per_s=3.0, duration_s=4.0)
    """
    points = list(zip(corners.time_s, corners.value, strict=True))
    if len(points) > 3 and points[-1][1] == points[-2][1]:
        points.pop()  # a rest at the end
    levels = [level for _, level in points]
    there_and_back = len(points) in (3, 4) and levels[0] == levels[-1] != levels[1]
    plain = there_and_back and levels[1] == levels[-2]
    if not plain:
        raise FormatError(
            "tcs2-protocol-ini holds one ramp, one plateau and one return to baseline; this icon has another shape: "
            "use tcs2-serial"
        )
    (begin, base), (top, target), (back, _), (end, _) = points[0], points[1], points[-2], points[-1]
    size = abs(target - base)
    rates = [min(size / (until - start), fastest_K_per_s) for start, until in ((begin, top), (back, end))]
    return Stimulus(base, target, rates[0], rates[1], back)


def protocol_columns(delivery: DeliveredDrive) -> tuple[Column, ...]:
    """Keys of a zone."""
    return (
        Column("temperature", "°C", "target"),
        Column("speed", "K/s", "rate of the ramp, positive for cooling too"),
        Column("return", "K/s", "rate of the return, positive"),
        Column("duration", "s", "ramp and plateau together"),
        Column("baseline", "°C", "baseline"),
    )


def protocol_write(delivery: DeliveredDrive) -> bytes:
    """Return the protocol; raises FormatError for a cue that is not a ramp, plateau and return of the display."""
    icon = delivery.icon
    if icon.context.control != "display":
        raise FormatError(
            f"tcs2-protocol-ini needs an icon that prescribes the display; {icon.name} prescribes the "
            f"{icon.context.control}: use tcs2-serial"
        )
    stimulus = stimulus_of(icon.corners(baseline_C(icon, delivery.rig)), delivery.device.most("ramp rate"))
    return ("\n".join(_lines(stimulus)) + "\n").encode("ascii")


def _lines(stimulus: Stimulus) -> Iterator[str]:
    yield from ("[protocol]", "stepsNumber=3", "recordTemperatures=1", "")
    yield from ("[step1]", "stepType=6", "stepTypeText=BASELINE")
    yield from (f"baseline={stimulus.baseline_C:.3f}", "adjustToSkin=0", "")
    yield from ("[step2]", "stepType=2", "stepTypeText=WAIT", "typeWait=3", "typeWaitText=WAIT_TRIGGER", "number=1", "")
    yield from ("[step3]", "stepType=0", "stepTypeText=STIMULATE", "")
    yield from ("[step3_stimulation]", f"baseline={stimulus.baseline_C:.3f}")
    yield from (f"triggerVal={TRIGGER_CODE}", f"triggerDur={TRIGGER_S:.3f}", "")
    for zone in ZONES:
        yield from (
            f"[step3_zone{zone}]",
            "enabled=1",
            f"duration={_three('duration', stimulus.duration_s, 's')}",
            "wait=0.000",
        )
        yield from (f"temperature={stimulus.target_C:.3f}", f"speed={_three('speed', stimulus.rise_K_per_s, 'K/s')}")
        yield f"return={_three('return', stimulus.return_K_per_s, 'K/s')}"
        yield from ("pointToPointEnabled=0", "nbrPts=1", "sec1=1.000", f"deg1={stimulus.baseline_C:.3f}", "")


def _three(what: str, value: float, unit: str) -> str:
    """A number with the three decimals of the file; FormatError where these would say another number."""
    if abs(round(value, 3) - value) > MOST_OFF * abs(value):
        raise FormatError(
            f"tcs2-protocol-ini writes its {what} with three decimals; {value:.3g} {unit} would become "
            f"{value:.3f} {unit}: use tcs2-serial"
        )
    return f"{value:.3f}"


PROTOCOL = Format(
    name="tcs2-protocol-ini",
    title="protocol file of a QST.Lab TCS II",
    suffix=".protocol.ini",
    takes=PLAYS_SETPOINTS,
    device="qst-tcs2",
    source="pytcsii (mpcoll), tcsii_protocol_generator",
    how="copy it to the instrument on a USB stick; it waits for a trigger",
    write=protocol_write,
    columns=protocol_columns,
)

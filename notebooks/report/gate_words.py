"""The gate's findings in a report.

What holds for all icons of an export is said once, and of what differs the strictest, with the icon that it is of.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from thermicon.base.words.number_text import number, signed

if TYPE_CHECKING:
    from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
    from thermicon.circuit.delivery.prepare import Prepared
    from thermicon.circuit.delivery.worstcase import OpenLoopSpread
    from thermicon.circuit.safety.demands import Demands
    from thermicon.circuit.safety.gate import Gate
    from thermicon.circuit.safety.repeated import Repeated

CAUTION = (
    "safety is a calculation, not a medical or ethical clearance; hardware on skin needs a temperature cut-off that "
    "works without software"
)
MOST_NAMES = 6
NUMBER = re.compile(r"\d+(\.\d+)?")
QUICKEST_S = 0.02
"""The gate does not look for reactions quicker than this: where none is safe, it states 0."""

Named = tuple[str, "Gate"]


def gate_words(ready: Sequence[Prepared]) -> list[tuple[str, str]]:
    """Repetition and hardware of the icons that may be written: what it is about, and what is to be known.

    Of an icon that is not safe nothing is said here, since it is refused with its reason and cure.
    """
    from thermicon.circuit.safety.gate import Gate

    gates = [(one.delivery.name, one.verdict) for one in ready if isinstance(one.verdict, Gate) and one.verdict.safe]
    if not gates:
        return []
    again = "repeated plays" + (", in any order" if len(gates) > 1 else "")
    faults = [
        ("a driver stuck at its limit", stuck_text(gates)),
        ("a driver stuck at its limit", fast_text(gates, "stuck fast")),
        ("wires swapped in mid-play", fast_text(gates, "swapped fast")),
    ]
    first = [(fault, text) for fault, text in faults if text is not None]
    return [*first, (again, repeated_text(gates)), ("your hardware must provide", demands_text(gates))]


def repeated_text(gates: Sequence[Named]) -> str:
    """Colour, plays, pause and recovery of icons that were judged as a set, with one pause."""
    from thermicon.circuit.safety.plant import RECOVERED_K

    colours: dict[str, list[str]] = {}
    for name, gate in gates:
        colours.setdefault(gate.repeated.colour, []).append(name)
    said = [f"{colour}{_of(_names(names), len(colours) > 1)}" for colour, names in sorted(colours.items())]
    first, counts = gates[0][1].repeated, sorted({gate.repeated.plays for _, gate in gates})
    plays = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    shortest = "no pause is safe" if first.shortest_pause_s is None else f"{number(first.shortest_pause_s, 1)} s"
    if first.faultless_pause_s is not None and first.faultless_pause_s != first.shortest_pause_s:
        shortest += f" ({number(first.faultless_pause_s, 1)} s without faults)"
    ordered = sorted(gates, key=lambda one: (one[1].repeated.recovery_s is None, one[1].repeated.recovery_s or 0.0))
    back = [_recovery_text(gate.repeated) for _, gate in (ordered[0], ordered[-1])]
    after = back[0]
    if back[0] != back[1]:
        after = f"{back[0]} ({ordered[0][0]}) to {back[1]} ({ordered[-1][0]})"
    return (
        f"{' and '.join(said)}, {plays} plays in {first.session_s / 60:g} min with "
        f"{first.pause_s:.4g} s between them; "
        f"shortest safe pause: {shortest}; back within {RECOVERED_K:g} K of rest after {after}"
    )


def stuck_text(gates: Sequence[Named]) -> str | None:
    """The effect of a stuck driver where no cut-off is quick enough, with a cure; None where one is."""
    from thermicon.circuit.safety.words import fault_cure

    slow = [(name, gate.demands) for name, gate in gates if gate.demands.cut_off_display_C.react_within_s < QUICKEST_S]
    if not slow:
        return None
    stuck = [demands.faults[-1] for _, demands in slow]
    cures = dict.fromkeys(map(fault_cure, stuck))
    whose = _of(_names([name for name, _ in slow]), len(slow) < len(gates))
    return f"{stuck[0].to_dict()['text']}, and no cut-off is quick enough{whose}; use {'; or '.join(cures)}"


def fast_text(gates: Sequence[Named], kind: str) -> str | None:
    """The effect of a kind of fault where icons need a current that moves the skin too fast; None where none does."""
    from thermicon.circuit.safety.words import fault_cure

    faults = [fault for _, gate in gates for fault in gate.demands.faults if fault.kind == kind]
    fast = next((fault for fault in faults if not fault.values["kept"]), None)
    if fast is None:
        return None
    return f"{fast.to_dict()['text']}, and the icons need the current that does it; use {fault_cure(fast)}"


def demands_text(gates: Sequence[Named]) -> str:
    """Demands on the hardware for all icons: of each the strictest."""
    from thermicon.circuit.safety.demands import Demands

    every = [(name, gate.demands) for name, gate in gates]
    together = Demands.strictest([one for _, one in every])
    cut, held, loop = together.cut_off_display_C, together.held_cut_off_display_C, together.loop
    hangs = [name for name, one in every if not one.watchdog_s]
    parts = [f"watchdog {_strictest(every, lambda one: one.watchdog_s)}"]
    if hangs:
        whose = _of(_names(hangs), len(hangs) < len(every))
        parts = [f"a current that cannot hang{whose}, for which no watchdog is quick enough"]
    sensor = "the measured display" if loop is None else "a second sensor of the display"
    if cut.react_within_s >= QUICKEST_S:
        outside = f"{number(cut.low, 1)} … {number(cut.high, 1)} °C"
        parts.append(f"cut-off outside {outside} on {sensor} within {cut.react_within_s:g} s")
    if held is not None and cut.react_within_s >= QUICKEST_S:
        outside = f"{number(held.low, 1)} … {number(held.high, 1)} °C"
        parts.append(f"and where it is outside {outside} for longer than {held.longer_than_s:g} s with current")
    if together.current_limit_A is not None:
        least, most = together.current_limit_A
        span = f"{signed(least, 'g')} … {most:g} A"
        parts.append(f"a driver limited to {span} by itself" if loop is None else f"a controller limited to {span}")
    if loop is not None:
        (kp, most_kp), (ki, most_ki), set_to = loop.kp_A_per_K, loop.ki_A_per_Ks, loop.played
        parts.append(
            f"its loop set to {set_to[0]:.3g} A/K and {set_to[1]:.3g} A/(K·s), for which set-points are shaped (safe: "
            f"{kp:.3g} to {most_kp:.3g} and {ki:.3g} to {most_ki:.3g}), with a sensor that lags by "
            f"{loop.sensor_lag_at_most_s:g} s, is wrong by {loop.sensor_offset_at_most_K:g} K and is acted on "
            f"{loop.delay_at_most_s:g} s later at most"
        )
    if together.test is not None:
        parts.append("polarity check before the first play")
    unrested = [name for name, one in every if one.rest_before_first_play_s is None]
    if unrested:
        whose = _of(_names(unrested), len(unrested) < len(every))
        parts.append(f"a display at its baseline before it touches the skin{whose}")
    elif any(one.rest_before_first_play_s for _, one in every):
        longest = _strictest(every, lambda one: one.rest_before_first_play_s or 0.0, max)
        parts.append(f"rest held for {longest} before the first play")
    limited = [(name, one) for name, one in every if one.zero_current_at_most_s is not None]
    if limited:
        shortest = _strictest(limited, lambda one: one.zero_current_at_most_s or 0.0)
        parts.append(f"zero current in contact for {shortest} at most")
    pause_s = max(one.pause_at_least_s or 0.0 for _, one in every)
    pause = f"after a pause of {number(pause_s, 1)} s or more" if pause_s else "with any pause"
    return f"{', '.join(parts)}; this holds for every play {pause}"


def warning_lines(ready: Sequence[Prepared]) -> Iterator[str]:
    """Every warning once, for its first icon; those that differ in numbers alone follow by name."""
    alike: dict[str, tuple[str, list[str]]] = {}
    for one in ready:
        for warning in one.warnings:
            alike.setdefault(NUMBER.sub("#", warning), (warning, []))[1].append(one.delivery.name)
    for warning, names in alike.values():
        others = list(dict.fromkeys(names))[1:]
        more = f"; alike, with numbers in their sidecars: {', '.join(others)}" if others else ""
        yield f"{names[0]}: {warning}{more}"


def spread_text(spread: OpenLoopSpread) -> str:
    """The uncertainty that an open loop leaves."""
    step = " … ".join(signed(value, "+.1f") for value in spread.step_K)
    low, high = spread.baseline_C
    return (
        f"open loop: with a module that was not measured the display may rest at {low:.1f} … {high:.1f} °C and move by "
        f"{step} K; where a controller measures the display, play set-points: --device closed-loop-controller --to "
        "setpoint-csv"
    )


def steps_of(delivery: DeliveredDrive) -> tuple[str, str]:
    """Update rate of a drive, or its number of segments, behind its preposition."""
    from thermicon.circuit.delivery.setpoints import Setpoints

    played = delivery.played
    if isinstance(played, Setpoints):
        return "in", f"{len(played.segments)} segments"
    return "at", f"{number(delivery.rate_Hz, 1)} Hz"


def _recovery_text(repeated: Repeated) -> str:
    return "more than 10 min" if repeated.recovery_s is None else f"{number(repeated.recovery_s, 1)} s"


def _strictest(
    every: Sequence[tuple[str, Demands]], seconds: Callable[[Demands], float], strictest: Callable[..., float] = min
) -> str:
    wanted = [seconds(one) for _, one in every]
    most = strictest(wanted)
    return f"{most:g} s" + _of(every[wanted.index(most)][0], len(set(wanted)) > 1)


def _of(name: str, needed: bool) -> str:
    return f" ({name})" if needed else ""


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more

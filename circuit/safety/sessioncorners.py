"""A session in every corner of the rig's uncertainty at full rate, so that no peak and no rate is averaged away.

The gate samples a long drive at 10 rows a second, which takes the mean of a rate over 0.1 s. Here the same corners are
played with a row for every update of the driver, a stretch at a time, so that memory does not grow with the session.
What adds up over time (dose, time above a limit) and what counts from the beginning is left to the gate.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rules import Limits
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.safety.limits import WATCHED, Check, checks_of
from thermicon.circuit.safety.scenarios import corners_of
from thermicon.circuit.safety.sessiondrive import SessionDrive
from thermicon.circuit.solver.batch_inputs import Bank, State, cut, run_on
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.simulate import rows_until
from thermicon.circuit.solver.steady import steady_state

STRETCH_ROWS = 5_000
"""Rows played at a time: little memory, and few starts of a run."""

INSTANT = (
    *("skin surface", "cold-receptor depth", "display", "hot plate"),
    *("rate of skin temperature", "numbness", "cold pain", "heat pain"),
)
"""Quantities of rules that hold at each instant by itself."""


def fine_checks(played: SessionDrive, rig: Rig, limits: Limits) -> tuple[Check, ...]:
    """Hold a session against the rules of each instant in all corners, with `rate_Hz` rows a second."""
    instant = tuple(rule for rule in limits.rules if rule.quantity in INSTANT and not rule.relative)
    own, found = replace(limits, rules=instant), list[Check]()
    for time_s, columns, names in _stretches(played, rig):
        fresh = checks_of(own, time_s, columns, names)
        found = [farther(*pair) for pair in zip(found, fresh, strict=True)] if found else list(fresh)
    return tuple(found)


def merged(checks: Sequence[Check], fine: Sequence[Check]) -> tuple[Check, ...]:
    """The checks of a gate, each replaced by the one at full rate where that goes farther."""
    known = {_rule(check): check for check in fine}
    return tuple(farther(check, known.get(_rule(check), check)) for check in checks)


def farther(first: Check, second: Check) -> Check:
    """Of two checks of one rule the one that goes farther, first passed when the earlier one of both is."""
    since = min((each.since_s for each in (first, second) if each.since_s is not None), default=None)
    return replace(second if beyond(second) > beyond(first) else first, since_s=since)


def _rule(check: Check) -> tuple[str, str, bool, str]:
    return check.quantity, check.severity, check.upper, check.note


def beyond(check: Check) -> float:
    """How far a check is beyond its limit, in its unit; negative within."""
    return check.value - check.limit if check.upper else check.limit - check.value


def _stretches(played: SessionDrive, rig: Rig) -> Iterator[tuple[Array, dict[str, Array], tuple[str, ...]]]:
    """Times (rows,), WATCHED columns (corners, rows) and names of corners, a stretch after the other."""
    corners, drive = corners_of(rig), played.drive
    gains = np.array([1.0 + corner.gain_relative for corner in corners])
    networks = [network_of(corner.rig) for corner in corners]
    bank, every = Bank.of(networks), np.arange(len(corners), dtype=np.int64)
    try:
        starts = [steady_state(each, played.rest_A * gain) for each, gain in zip(networks, gains, strict=True)]
    except ArithmeticError:
        return  # a corner that heats without end at rest fails every limit in the gate already
    state = State.settled(bank.states(starts))
    rows, names = rows_until(float(drive.time_s[-1]), played.rate_Hz), tuple(str(corner) for corner in corners)
    for first in range(0, len(rows) - 1, STRETCH_ROWS):
        part = rows[first : first + STRETCH_ROWS + 1]
        since = max(0, int(np.searchsorted(drive.time_s, part[0] + 1e-9, side="right")) - 1)
        until = int(np.searchsorted(drive.time_s, part[-1] + 1e-9, side="right"))
        times, currents = np.maximum(drive.time_s[since:until], part[0]), drive.current_A[since:until]
        intervals = cut(part, times, gains[:, np.newaxis] * currents, held=True)
        out, state = run_on(bank, every, every, intervals, state, WATCHED)
        yield part, dict(zip(WATCHED, out, strict=True)), names

"""What follows a cue, and in which world: three endings on the corners of a rig's uncertainty, in one batch.

The endings last 60 s. *Last value held*: the driver goes on with its last current, or its last duty. *Zero current*:
the driver gives none and the heat sink works on; skin drifts to where the hot plate takes it, not to its baseline.
*Power off*: no current either, with the terminals open (the Seebeck voltage is free), and what holds the heat sink is
off too. A sink with a capacity and a controller of its own keeps its heat, loses its power and drifts with the hot
plate. An ideal sink has no capacity in the rig file: it is taken as heavy enough not to move within a minute, which
makes power off the same as zero current; later it drifts towards the room, which is no hazard.

The corners: contact resistance, ambient and gain each at either end of their uncertainty. The gain scales every
current, that of rest too; each corner starts from its own steady state. The ambient shifts room and, where deep tissue
is solved from the rest, blood, since the bare skin's rest stays as given. Nothing corrects what a corner does: a drive
is played open loop.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.safety.limits import HOTTEST_C, WATCHED
from thermicon.circuit.solver.batch_inputs import Bank, Index, Intervals, cut, run_forward
from thermicon.circuit.solver.drive import Drive, DriveError
from thermicon.circuit.solver.network import network_of, stacked
from thermicon.circuit.solver.poweroff import unpowered
from thermicon.circuit.solver.pwm import steady_of
from thermicon.circuit.solver.simulate import rows_until
from thermicon.circuit.solver.steady import check_sink, steady_state

ENDING_S = 60.0
ENDINGS = ("last value held", "zero current", "power off")

FINE_S, FINE_HZ, COARSE_HZ = 300.0, 100.0, 10.0
"""Rows a second of drives up to 5 min and of every ending, and of longer drives; the steps inside are always fine."""


@dataclass(frozen=True, slots=True)
class Corner:
    """A world that the rig may be in: shares of contact resistance and gain, K of ambient, and the rig there.

    The gain is not part of `rig`, it scales the current.
    """

    contact_relative: float
    ambient_K: float
    gain_relative: float
    rig: Rig

    def __str__(self) -> str:
        parts = (
            (self.contact_relative, f"contact resistance {100 * self.contact_relative:+g} %"),
            (self.ambient_K, f"ambient {self.ambient_K:+g} K"),
            (self.gain_relative, f"gain {100 * self.gain_relative:+g} %"),
        )
        return ", ".join(words for value, words in parts if value).replace("-", "−") or "the rig as given"


@dataclass(frozen=True, slots=True)
class Futures:
    """One drive in all scenarios: `time_s` (rows,), `values` (WATCHED, endings, corners, rows) in °C; ends at `end_s`.

    The first corner is the rig as given. What runs away is not finite.
    """

    end_s: float
    corners: tuple[Corner, ...]
    time_s: Array
    values: Array

    @property
    def names(self) -> tuple[str, ...]:
        """A few words for every scenario, in the order of `columns`."""
        return tuple(f"{corner}, then {ending}" for ending in ENDINGS for corner in self.corners)

    @property
    def columns(self) -> dict[str, Array]:
        """Each of WATCHED as (endings · corners, rows)."""
        flat = self.values.reshape(len(WATCHED), -1, len(self.time_s))
        return dict(zip(WATCHED, flat, strict=True))


@lru_cache(maxsize=64)
def corners_of(rig: Rig) -> tuple[Corner, ...]:
    """Return the rig as given and then the corners of its uncertainty; fewer than 8 where one of the three is 0.

    >>> [str(corner) for corner in corners_of(Rig.load("thenar"))][:2]
    ['the rig as given', 'contact resistance −30 %, ambient −3 K, gain −10 %']
    """
    unsure = rig.uncertainty
    spans = [
        (-most, most) if most else (0.0,)
        for most in (unsure.contact_resistance_relative, unsure.ambient_K, unsure.gain_relative)
    ]
    found = [Corner(0.0, 0.0, 0.0, rig)]
    for contact, ambient, gain in itertools.product(*spans):
        if contact or ambient or gain:
            there = rig.with_(
                **{
                    "contact.resistance_m2K_per_W": rig.contact.resistance_m2K_per_W * (1.0 + contact),
                    "ambient.temperature_C": rig.ambient.temperature_C + ambient,
                }
            )
            found.append(Corner(contact, ambient, gain, there))
    return tuple(found)


def play_out(
    drive: Drive,
    rig: Rig,
    *,
    rest_A: float | None = None,
    bridge_A: float | None = None,
    ending_s: float = ENDING_S,
) -> Futures:
    """Play a drive in every corner and follow it through every ending.

    `rest_A` has been held for ever before; None: the drive's first current. `bridge_A` says that the current comes from
    a bridge that switches between this current and none: `rest_A` and the drive's last current are then means.
    Raises RigError where the rig as given has no steady state to start from, DriveError for a rest that cannot be.
    """
    rest = _rest(drive, rest_A, bridge_A)
    corners = corners_of(rig)
    gains = np.array([1.0 + corner.gain_relative for corner in corners])
    networks = [network_of(corner.rig) for corner in corners]
    starts = [_start(corner, rest, bridge_A) for corner in corners]
    check_sink(rig, starts[0])
    end = float(drive.time_s[-1])
    before = rows_until(end, FINE_HZ if end <= FINE_S else COARSE_HZ)
    after = end + np.arange(1, round(ending_s * FINE_HZ) + 1) / FINE_HZ
    bank, every = Bank.of(networks), np.arange(len(corners), dtype=np.int64)
    states = bank.states(starts)
    cue = cut(before, drive.time_s, gains[:, np.newaxis] * drive.current_A, drive.held)
    last = gains * drive.current_A[-1]
    held = _held(last, len(after), None if bridge_A is None else bridge_A * gains)
    none = np.zeros_like(held)
    both = _then(_twice(cue), after, np.concatenate([held, none], axis=2))
    lanes = np.arange(2 * len(corners), dtype=np.int64)
    run = run_forward(bank, lanes % len(corners), lanes, both, np.concatenate([states, states]), WATCHED)
    run = run.reshape(len(WATCHED), 2, len(corners), -1)
    values = np.concatenate([run, run[:, 1:]], axis=1)
    if rig.heat_sink.controller is not None:
        hot = values[WATCHED.index("hot_plate_C"), 0, :, : len(before)]
        off = Bank.of([unpowered(corner.rig, before, trace) for corner, trace in zip(corners, hot, strict=True)])
        ends = cut(before[[0, -1]], drive.time_s, gains[:, np.newaxis] * drive.current_A, drive.held)
        begin = run_forward(bank, every, every, ends, states, WATCHED[:1], _everything(states.shape[1]))[1:, :, -1].T
        rows = np.concatenate([[end], after])
        still = Intervals(rows, np.arange(len(rows)), none[0], none[1])
        values[:, 2, :, len(before) :] = run_forward(off, every, every, still, begin, WATCHED)[:, :, 1:]
    values.setflags(write=False)
    return Futures(end, corners, np.concatenate([before, after]), values)


def _rest(drive: Drive, rest_A: float | None, bridge_A: float | None) -> float:
    if bridge_A is not None and not (0 < bridge_A < np.inf):
        raise DriveError(f"a bridge of {bridge_A:g} A is not possible; its current must be above 0 A")
    if rest_A is None:
        if bridge_A is not None:
            raise DriveError("the mean current of rest is needed where a bridge switches; give rest_A")
        return float(drive.current_A[0])
    if not np.isfinite(rest_A) or (bridge_A is not None and abs(rest_A) > bridge_A):
        most = "" if bridge_A is None else f" of at most {bridge_A:g} A"
        raise DriveError(f"a rest of {rest_A:g} A is not possible; it must be a finite current{most}")
    return rest_A


def _start(corner: Corner, rest_A: float, bridge_A: float | None) -> Array:
    """Steady state of a corner; where a corner heats without end, as hot as can be said."""
    network, gain = network_of(corner.rig), 1.0 + corner.gain_relative
    try:
        if bridge_A is not None:
            return steady_of(corner.rig, rest_A / bridge_A, bridge_A * gain)
        return steady_state(network, rest_A * gain)
    except ArithmeticError as problem:
        if not (corner.contact_relative or corner.ambient_K or corner.gain_relative):
            raise RigError(f"rig {corner.rig.name}: {problem}; begin the drive with a smaller current") from None
        hottest = np.full(len(network.capacity_J_per_K) + 3, HOTTEST_C)
        hottest[-1] = network.deep_C
        return hottest


def _held(last_A: Array, rows: int, bridge_A: Array | None) -> Array:
    """Currents at both ends of each interval of the ending, (2, rows, corners).

    A bridge of mean m and peak p heats with m·p instead of m²: a triangle about m has that mean square too.
    """
    currents = np.broadcast_to(last_A, (2, rows, len(last_A))).copy()
    if bridge_A is not None:
        swing = np.sqrt(3.0 * np.maximum(np.abs(last_A) * bridge_A - last_A**2, 0.0))
        sign = np.where(np.arange(rows) % 2 == 0, 1.0, -1.0)[:, np.newaxis]
        currents += np.stack([sign * swing, -sign * swing])
    return currents


def _twice(cue: Intervals) -> Intervals:
    return Intervals(cue.edges_s, cue.row_of, np.tile(cue.start_A, 2), np.tile(cue.end_A, 2))


def _then(cue: Intervals, after_s: Array, currents_A: Array) -> Intervals:
    """The cue's intervals, then one for each row of the ending with currents (2, rows, cues)."""
    return Intervals(
        np.concatenate([cue.edges_s, after_s]),
        np.concatenate([cue.row_of, cue.row_of.max() + 1 + np.arange(len(after_s))]),
        np.concatenate([cue.start_A, currents_A[0]]),
        np.concatenate([cue.end_A, currents_A[1]]),
    )


def _everything(states: int) -> tuple[Index, Array]:
    """Readings of every state."""
    last = states - 3
    rows = []
    for k in range(states):
        weight = [0.0, 0.0, 0.0]
        weight[k - min(k, last)] = 1.0
        rows.append((min(k, last), (weight[0], weight[1], weight[2])))
    return stacked(rows)

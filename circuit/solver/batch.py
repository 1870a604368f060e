"""Many cues on many rigs at once: the skin of each virtual person."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array, Index
from thermicon.icons import Icon
from thermicon.icons.files.shipped import Icons, icons_of

from ..rig.rig import AnyRig, Rig
from ..rig.rigfile import RigError
from .batch_inputs import Bank, Intervals, cut, run_follow, run_forward, run_regulate
from .displayed import displays_on
from .inverse import baseline_C, design, design_many, gains_of, periods, target_at
from .network import network_of
from .simulate import rows_until, simulate
from .steady import state_under_current, steady_state
from .superposed import corners_of, is_linear, superposed

TRACKINGS = ("replay", "display", "ideal")
"""What each rig plays: the nominal current open loop, the nominal display trajectory, or its own solution."""

USUAL = ("skin_C", "cold_receptor_C", "warm_receptor_C")


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Traces of many cues on many rigs: `time_s` (rows,), `values` (probes, rigs, icons, rows)."""

    time_s: Array
    probes: tuple[str, ...]
    values: Array

    def __post_init__(self) -> None:
        self.values.setflags(write=False)

    def __repr__(self) -> str:
        _, rigs, icons, rows = self.values.shape
        return f"Batch({icons} icons on {rigs} rigs, {rows} rows, {self.time_s[-1]:g} s: {', '.join(self.probes)})"

    def __getitem__(self, probe: str) -> Array:
        """Values of one probe, (rigs, icons, rows)."""
        return np.asarray(self.values[self.probes.index(probe)])

    @property
    def cold_C(self) -> Array:
        """Temperature at cold-receptor depth in °C, (rigs, icons, rows)."""
        return self["cold_receptor_C"]


def usual_tracking(icon: Icon) -> str:
    """Default tracking of a cue: `display` for display control, otherwise `replay`."""
    return "display" if icon.context.control == "display" else "replay"


@checked
def simulate_many(
    icons: Icons,
    rigs: Sequence[AnyRig],
    *,
    nominal: AnyRig,
    end_s: float,
    rate_Hz: float = 100.0,
    tracking: str | None = None,
    probes: Sequence[str] = USUAL,
) -> Batch:
    """Simulate every cue on every rig; the result does not depend on the number of cores.

    Parameters
    ----------
    icons
        The cues: a set, its name or file, or several.
    rigs
        The rigs, their names or files, such as one for each virtual person. A PID loop of a rig is simulated.
    nominal
        The rig for which the currents are designed, or its name or file.
    end_s
        Time in s until which every run continues.
    rate_Hz
        Rows per second.
    tracking
        `replay` plays the current designed on `nominal` open loop, `display` tracks the display temperature designed on
        `nominal` within each driver's limits, `ideal` designs anew for each rig; None: the default of each cue. A
        thermode shows the same display to everybody.
    probes
        Columns of a trace to record.

    Returns
    -------
    Batch
        Recorded temperatures in °C (probes, rigs, icons, rows).

    Raises
    ------
    RigError
        Where a rig cannot hold a baseline, or the rigs differ in what a batch needs in common.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> thenar = Rig.load("thenar")
    >>> rigs = [thenar, thenar.with_(**{"skin.rest_C": 33.0})]
    >>> simulate_many(tuple(load_library("six-icons"))[:2], rigs, nominal=thenar, end_s=9.0)
    Batch(2 icons on 2 rigs, 901 rows, 9 s: skin_C, cold_receptor_C, warm_receptor_C)
    """
    icons, nominal, on = icons_of(icons), Rig.of(nominal), tuple(Rig.of(rig) for rig in rigs)
    if tracking is not None and tracking not in TRACKINGS:
        raise RigError(f"tracking {tracking!r} is not known; it is one of {', '.join(TRACKINGS)}")
    if not on or not icons:
        raise RigError("a batch needs at least one cue and one rig")
    if not 0 < end_s < np.inf:
        raise RigError(f"a batch cannot end at {end_s:g} s; it must be above 0")
    if nominal.thermode is not None or any(rig.thermode is not None for rig in on):
        rows = rows_until(end_s, rate_Hz)
        return Batch(rows, tuple(probes), displays_on(icons, on, nominal, rows, tracking, probes))
    if len({rig.controller is None for rig in (*on, nominal)}) > 1:
        raise RigError("rigs of one batch must all have a controller, or none")
    if len({rig.driver.update_Hz for rig in (*on, nominal)}) > 1:
        raise RigError("rigs of one batch must share driver.update_Hz")
    rows = rows_until(end_s, rate_Hz)
    stage = _Stage(on, nominal, end_s, rows, tuple(probes), Bank.of([network_of(rig) for rig in on]))
    groups: dict[tuple[str, str], list[int]] = {}
    for place, icon in enumerate(icons):
        groups.setdefault((icon.context.control, tracking or usual_tracking(icon)), []).append(place)
    played = [(places, stage.play([icons[place] for place in places], *how)) for how, places in groups.items()]
    if len(played) == 1:  # most sets: a copy would be as large as all else
        return Batch(rows, tuple(probes), played[0][1])
    values = np.empty((len(probes), len(on), len(icons), len(rows)))
    for places, found in played:
        values[:, :, places] = found
    return Batch(rows, tuple(probes), values)


@dataclass(frozen=True, slots=True)
class _Stage:
    """The setting of a batch: the rigs, the rig that cues are designed for, and what is recorded."""

    rigs: tuple[Rig, ...]
    nominal: Rig
    end_s: float
    rows: Array
    probes: tuple[str, ...]
    bank: Bank

    def play(self, icons: Sequence[Icon], control: str, way: str) -> Array:
        """Icons of one control that are tracked alike, on every rig: (probes, rigs, icons, rows)."""
        if control == "current":
            return np.stack([self.play_corners(icon) for icon in icons], axis=2)
        return self.replay(icons) if way == "replay" else self.track(icons, control, way)

    def play_corners(self, icon: Icon) -> Array:
        """A current-controlled cue, designed on the nominal rig, on every rig: (probes, rigs, rows)."""
        plan = design(icon, self.nominal, self.end_s)
        states = [state_under_current(network_of(rig), plan.rest_A) for rig in self.rigs]
        every = np.arange(len(self.rigs), dtype=np.int64)
        intervals = cut(self.rows, plan.drive.time_s, plan.drive.current_A[np.newaxis], plan.drive.held)
        return run_forward(self.bank, every, np.zeros_like(every), intervals, self.bank.states(states), self.probes)

    def replay(self, icons: Sequence[Icon]) -> Array:
        """The currents designed on the nominal rig, on every rig: (probes, rigs, icons, rows)."""
        plans = design_many(icons, self.nominal, self.end_s)
        currents = np.array([plan.drive.current_A[:-1] for plan in plans])
        states = {
            (r, amperes): state_under_current(network_of(rig), amperes)
            for (r, rig), amperes in product(enumerate(self.rigs), {plan.rest_A for plan in plans})
        }
        return self._play(
            currents, icons, [states[r, plan.rest_A] for r, plan in product(range(len(self.rigs)), plans)]
        )

    def track(self, icons: Sequence[Icon], control: str, way: str) -> Array:
        """Each rig's own current for the nominal display trajectory, or for the cue itself: as `replay`."""
        bases = [baseline_C(icon, self.nominal) for icon in icons]
        ends = periods(self.nominal, self.end_s)
        if way == "display" and control == "skin":
            rate = self.nominal.driver.update_Hz
            displays = [simulate(icon, self.nominal, rate_Hz=rate, tail_s=self.end_s).display_C for icon in icons]
            targets, control = np.array([display[1 : len(ends) + 1] for display in displays]), "display"
            bases = [float(display[0]) for display in displays]
        else:
            targets = np.array([target_at(icon, base, ends) for icon, base in zip(icons, bases, strict=True)])
        pairs = product(enumerate(self.rigs), set(bases))
        steady = {(r, base): steady_state(rig, control, base) for (r, rig), base in pairs}
        lanes = [steady[pair] for pair in product(range(len(self.rigs)), bases)]
        states = [state for _, state in lanes]
        if control == "display" and (values := self._superposed(targets, bases, states)) is not None:
            return values
        rig_of, cue_of = self._lanes(len(icons))
        bank, period, begun = self.bank, 1.0 / self.nominal.driver.update_Hz, self.bank.states(states)
        if self.nominal.controller is None:
            currents = run_follow(bank, rig_of, cue_of, period, targets, control == "skin", begun)[0]
        elif control == "skin":
            raise RigError(
                "skin-controlled cues cannot be solved again through a PID loop, which measures only the display; "
                "use tracking display, or rigs without [controller]"
            )
        else:
            setpoint = np.concatenate([np.array(bases)[:, np.newaxis], targets[:, :-1]], axis=1)
            gains, bias_A = np.array([gains_of(rig) for rig in self.rigs]), np.array([current for current, _ in lanes])
            currents = run_regulate(bank, rig_of, cue_of, period, setpoint, gains, bias_A, begun)[0]
        return self._play(currents, icons, states)

    def _superposed(self, targets: Array, bases: Sequence[float], states: Sequence[Array]) -> Array | None:
        """As `track`, where the skin alone decides; lanes near a limit are solved in full. None: solve all in full."""
        if not is_linear(self.rigs, self.nominal, self.probes, self.rows):
            return None
        displays = np.concatenate([np.array(bases)[:, np.newaxis], targets], axis=1)
        if (corners := corners_of(displays)) is None:
            return None
        bank, update_Hz, start = self.bank, self.nominal.driver.update_Hz, self.bank.states(states)
        values, fine = superposed(bank, displays, corners, start, self.probes, 1.0 / update_Hz, self.rows)
        if (near := np.flatnonzero(~fine)).size:
            rig_of, cue_of = (places[near] for places in self._lanes(len(targets)))
            lanes = np.arange(len(near))
            currents = run_follow(bank, rig_of, cue_of, 1.0 / update_Hz, targets, False, start[near])[0]
            intervals = self._held(currents)
            values[:, near] = run_forward(bank, rig_of, lanes, intervals, start[near], self.probes)
        return values.reshape(len(self.probes), len(self.rigs), len(targets), len(self.rows))

    def _held(self, currents: Array) -> Intervals:
        times = np.concatenate([[0.0], periods(self.nominal, self.end_s)])
        return cut(self.rows, times, np.concatenate([currents, currents[:, -1:]], axis=1), held=True)

    def _lanes(self, cues: int) -> tuple[Index, Index]:
        rig_of, cue_of = (place.ravel() for place in np.indices((len(self.rigs), cues)))
        return rig_of, cue_of

    def _play(self, currents: Array, icons: Sequence[Icon], states: Sequence[Array]) -> Array:
        rig_of, cue_of = self._lanes(len(icons))
        if len(currents) == len(rig_of):
            cue_of = np.arange(len(rig_of))
        out = run_forward(self.bank, rig_of, cue_of, self._held(currents), self.bank.states(states), self.probes)
        return out.reshape(len(self.probes), len(self.rigs), len(icons), len(self.rows))

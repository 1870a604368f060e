"""The gate's interface to a plant and the result of one play.

There are two: a module that a current drives (`current.py`), a display that shows temperatures (`display.py`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..rig.rules import Limits
from .checks import Check, Scenario, worst_of
from .corners import Corner
from .demands import Demanded
from .spans import ENDING_S, LATER_S
from .tally import WATCHED, Tally

if TYPE_CHECKING:
    from .repeated import Repeating

ENDING_ROWS_S = np.concatenate([np.arange(200) * 0.01, 2.0 + np.arange(180) * 0.1, 20.0 + np.arange(41) * 1.0])
"""Times of the rows of an ending: fine after the jump of the current, coarse later."""

LATE_S = np.geomspace(ENDING_S, LATER_S, 60)
"""Rows of zero current from then on."""

Stretch = tuple[Array, Array]
"""Times in s (rows,) and WATCHED (4, lanes, rows) in °C."""


class GatePlay(Protocol):
    """A play for the gate: currents, or temperatures of a display."""

    @property
    def way(self) -> str:
        """In which way a device follows; empty for as told."""

    @property
    def end_s(self) -> float:
        """Time in s of the last row."""

    @property
    def settling_s(self) -> float:
        """How much of it is part of the pause, in s: until a display has arrived."""


Played = TypeVar("Played", bound=GatePlay)
States = TypeVar("States")
"""States of all corners, which only their plant reads."""


@dataclass(frozen=True, slots=True, eq=False)
class Future:
    """A stretch of what follows a play, at times in s after its end; a `drift` is not a stimulus."""

    stretch: Stretch
    rates: bool = True
    drift: bool = False


@dataclass(frozen=True, eq=False)
class Plant(ABC, Generic[Played, States]):
    """A plant in the corners of its uncertainty, the first of which is the rig as given.

    `endings` are the names of what may follow a play. `rates`: whether the rate of skin is judged. `quick`: plays with
    all their endings take next to no time in all corners, so that none is left out.
    """

    rig: Rig
    corners: tuple[Corner, ...]
    rates: bool
    endings: ClassVar[tuple[str, ...]]
    quick: ClassVar[bool]

    @abstractmethod
    def rest(self, play: Played) -> States:
        """Steady states before a first play; raises RigError where the rig as given has none."""

    @abstractmethod
    def now(self, play: Played, state: States) -> Array:
        """WATCHED (4, corners) before a play."""

    def begun_C(self, plays: Sequence[Played]) -> list[Array]:
        """Skin (corners,) at the rest of each of the plays, from which changes count."""
        return [self.now(play, self.rest(play))[WATCHED.index("skin_C")] for play in plays]

    @abstractmethod
    def play(self, play: Played, state: States) -> Iterator[tuple[Stretch, States]]:
        """Play from states, in stretches, each with the states at its end."""

    @abstractmethod
    def hold(self, play: Played, state: States, times_s: Array) -> Array:
        """WATCHED (4, corners, times) in the pause after a play, at times from now that begin with 0."""

    @abstractmethod
    def let_go(self, play: Played, state: States) -> Iterable[tuple[Future, ...]]:
        """Continuations of a play by each of the endings."""

    @abstractmethod
    def cycle(self, play: Played, pause_s: float) -> States:
        """States before each play of a steady cycle."""

    @abstractmethod
    def bound(self, plays: Sequence[Played], pause_s: float, steady: Sequence[States], warm: bool) -> States:
        """States that are warmer (or colder) than those before any play in any order; `steady` is before each cycle."""

    @abstractmethod
    def rested(self, play: Played, state: States, rest_s: float) -> States:
        """States after the rest before a play has been held for a time in s."""

    @abstractmethod
    def unpowered(self) -> States:
        """Steady states of a display without power."""

    @abstractmethod
    def stopped(self, plays: Sequence[Played], bounds: tuple[States, States]) -> tuple[States, States]:
        """States warmer, and colder, than after no power, or after a stop of a play between the bounds (warm, cold)."""

    @abstractmethod
    def demanded(
        self,
        singles: Sequence[Sequence[Single[Played, States]]],
        recovered_s: Sequence[float],
        repeating: Repeating[Played, States],
        tallies: Sequence[list[Tally]],
        shortest_s: float | None,
    ) -> Demanded:
        """The shortest pause with which single faults can be prevented, what prevents them, and what fails."""

    def only(self, corners: list[int]) -> Plant[Played, States]:
        """The same in some of the corners, or in all where that takes next to no time."""
        return self

    def alone(self, limits: Limits, end_s: float, begun_C: Array) -> list[Tally]:
        """What else a single play that ended at a time is judged by, of which skin began at `begun_C` (corners,)."""
        return []

    def following(
        self, plays: Sequence[Played], pause_s: float, steady: Sequence[States], begun_C: Array, limits: Limits, of: int
    ) -> list[Tally]:
        """Tallies of one of the plays right after each of them, where its bounds say nothing of rates."""
        return []

    @property
    def drift_C(self) -> float | None:
        """Steady skin temperature in °C of the rig as given, without current; None where there is no current."""
        return None


def left_s(play: GatePlay, pause_s: float) -> float:
    """Remaining time in s of a pause after the last row of a play."""
    return max(0.0, pause_s - play.settling_s)


def follow(
    plant: Plant[Played, States],
    play: Played,
    ended: States,
    end_s: float,
    tallies: Sequence[Tally],
    sums: bool = True,
) -> dict[str, Array]:
    """Add what follows a play that ended at `end_s` to the tally of each ending; the skin of each a minute later."""
    after_C = {}
    for ending, tally, futures in zip(plant.endings, tallies, plant.let_go(play, ended), strict=True):
        for future in futures:
            rows, values = future.stretch
            tally.add(end_s + rows, values, rates=future.rates, sums=sums, drift=future.drift)
        after_C[ending] = futures[0].stretch[1][0, :, -1]
    return after_C


RECOVERED_K = 0.1
"""Display and skin have recovered within 0.1 K of rest."""

OFF_ROWS_S = (0.5, 2.0, 8.0, 30.0)
"""Times after a stop at which a display without current is compared with others: heat of the hot plate comes back."""

RECOVERY_ROWS_S = np.concatenate([np.arange(1200) * 0.1, 120.0 + np.arange(481) * 1.0])
"""Times at which recovery is checked, up to the longest pause."""


@dataclass(frozen=True, slots=True, eq=False)
class Single(Generic[Played, States]):
    """A play from rest: tallies, the first of the play alone, states at both ends, and the skin 60 s later."""

    plant: Plant[Played, States]
    play: Played
    start: States
    end: States
    tallies: tuple[Tally, ...]
    after_C: dict[str, Array]

    @staticmethod
    def of(
        plant: Plant[Played, States],
        play: Played,
        limits: Limits,
        *,
        before_s: float = 0.0,
        sums: Tally | None = None,
        watch: Callable[[float], None] | None = None,
    ) -> Single[Played, States]:
        """Play from rest, after `before_s` of others with the doses of `sums`; RigError where there is no rest."""
        start = state = plant.rest(play)
        played = sums or Tally(limits, plant.corners, Scenario(way=play.way))
        for (rows, values), then in plant.play(play, start):
            played.add(before_s + rows, values, rates=plant.rates)
            state = then
            if watch is not None:
                watch(before_s + float(rows[-1]))
        endings, end_s = [played.fork(ending) for ending in plant.endings], before_s + play.end_s
        after = follow(plant, play, state, end_s, endings)
        more = plant.alone(limits, end_s, plant.now(play, start)[0])
        return Single(plant, play, start, state, (played, *endings, *more), after)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every rule in its worst scenario."""
        return worst_of(tally.checks() for tally in self.tallies)

    @property
    def safe(self) -> bool:
        """Whether one play exceeds no hard limit."""
        return all(tally.passes() for tally in self.tallies)

    @property
    def recovery_s(self) -> float | None:
        """Time in s after a play until display and skin are within 0.1 K of where they began, in every corner."""
        return recovery_s(self.plant, self.play, self.start, self.end)


def recovery_s(plant: Plant[Played, States], play: Played, start: States, ended: States) -> float | None:
    """Time in s after a play until display and skin are near a start in every corner; None: over 10 min."""
    which = [WATCHED.index("display_C"), WATCHED.index("skin_C")]
    values = plant.hold(play, ended, RECOVERY_ROWS_S)[which]
    away = np.abs(values - plant.now(play, start)[which][:, :, np.newaxis]).max(axis=(0, 1)) > RECOVERED_K
    if away[-1] or not np.isfinite(values).all():
        return None
    late = np.flatnonzero(away)
    return round(play.settling_s + (float(RECOVERY_ROWS_S[late[-1] + 1]) if len(late) else 0.0), 1)

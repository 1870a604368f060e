"""Single faults in later plays of exported files, prevented as the sidecar demands, on the independent circuit."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from tests.circuit.delivery.exported_files import Course, read_file, sidecar_in
from tests.circuit.delivery.independent import Array, Circuit, Json
from tests.circuit.delivery.replay import Held, Player, Skin, Worst

INSTANTS, PLAYS = 25, 20
TRIP_S, FOLLOWED_S = 0.005, 60.0
AFTER = ((0.01, 50), (0.05, 30), (0.5, 56))
"""Rows after a cut: step in s and how many."""


@dataclass
class Faults:
    """The worst of each fault, and how many were tried."""

    worst: dict[str, Worst] = field(default_factory=dict)
    tried: Counter[str] = field(default_factory=Counter)

    def note(self, fault: str, rows: Array) -> None:
        """Temperatures (rows, W, 4, …) of a fault."""
        self.worst.setdefault(fault, Worst()).levels(rows)
        self.tried[fault] += 1

    @property
    def unsafe(self) -> dict[str, dict[str, float]]:
        """Limits that are passed, by fault."""
        return {fault: worst.unsafe for fault, worst in self.worst.items() if worst.unsafe}


def faulted(files: Mapping[str, bytes], stems: list[str], rng: np.random.Generator, most: int = 1000) -> Faults:
    """Every demand of an export tried at instants of a play, and of its pause, after plays in any order.

    `most` worlds at most: the rig as given, and others by chance.
    """
    found, told = Faults(), [sidecar_in(files, stem) for stem in stems]
    played, rig = [read_file(files, stem) for stem in stems], told[0]["rig"]["document"]
    demands = [one["hardware_must_prevent"] for one in told]
    pause_s = max(float(one["pause_at_least_s"] or 0.0) for one in demands)
    order = [int(rng.integers(len(stems))) for _ in range(int(rng.choice([1, 5, PLAYS])))]
    currents = [one for one in played if isinstance(one, Held)]
    if len(currents) == len(played):
        player = Player(rig, rng)
        worlds = player.circuit.worlds
        if len(worlds) > most:
            few = [0, *rng.choice(np.arange(1, len(worlds)), most - 1, replace=False)]
            player.circuit = Circuit.of(rig, [worlds[k] for k in few])
        _currents(player, currents, demands, [_ends_A(one) for one in told], order, pause_s, rng, found)
    for course, demand, about in zip(played, demands, told, strict=True):
        if isinstance(course, Course) and not course.held:
            _shown(Skin(rig, rng), course, demand, about, pause_s, rng, found)
    return found


def _ends_A(told: Json) -> list[tuple[float, float]]:
    """The driver's limits, or the bridge's: mean A and mean square A²."""
    if told["device"]["driven_by"] == "duty":
        span = next(each for each in told["device"]["records"] if each["quantity"] == "output range")
        peak = min(-span["low"], span["high"])
        return [(-peak, peak**2), (peak, peak**2)]
    driver = told["rig"]["document"]["driver"]
    most = driver["current_limit_A"]
    least = driver.get("current_min_A", -most)
    return [(end, end**2) for end in (-most if least is None else least, most)]


def _currents(
    player: Player, files: list[Held], demands: list[Json], ends_A: list[list[tuple[float, float]]], order: list[int],
    pause_s: float, rng: np.random.Generator, found: Faults,
) -> None:  # fmt: skip
    state = player.rest(files[order[0]])
    for which in order:
        state = player.through(files[which], state, pause_s)
    for held, demand, ends in zip(files, demands, ends_A, strict=True):
        cut, watchdog_s = demand["cut_off_display_C"], float(demand["watchdog_s"])
        span = (cut["low"], cut["high"])
        for at, current in _instants(player, held, state, pause_s, rng):
            if watchdog_s:
                _until(player, at, current, (-300.0, 300.0), watchdog_s, found, "hangs until the watchdog")
            elif cut["react_within_s"] and "cut-off" in demand["faults"][0]["prevented_by"]:
                _until(player, at, current, span, cut["react_within_s"], found, "hangs until the cut-off")
            for end in ends if cut["react_within_s"] else ():
                _until(player, at, end, span, cut["react_within_s"], found, "stuck until the cut-off")
        if demand["rest_before_first_play_s"] is not None:  # on a display that was without power
            begun = player.hold(player.modes(0.0, 0.0).steady(), held.rest, float(demand["rest_before_first_play_s"]))
            found.note("first play after the rest", player.play(held, begun)[0])
        found.tried["no watchdog is quick enough"] += not watchdog_s
        found.tried["no cut-off is quick enough"] += not cut["react_within_s"]


def _instants(
    player: Player, held: Held, state: Array, pause_s: float, rng: np.random.Generator
) -> list[tuple[Array, tuple[float, float]]]:
    """States at instants of a play and its pause, with the current there: some just before a change."""
    edges = np.cumsum(held.length_s)
    times = [*rng.uniform(0, held.end_s, INSTANTS // 2), *rng.choice(edges, INSTANTS - INSTANTS // 2 - 3)]
    times = sorted([*times, held.end_s + pause_s, *(held.end_s + rng.uniform(0, [pause_s, 20.0]))])
    states, now = [], 0.0
    flows = [*zip(held.length_s, held.mean_A, held.square_A2, strict=True), (1e9, *held.rest)]
    for length, mean, square in flows:
        end, current = now + float(length), (float(mean), float(square))
        while times and times[0] <= end + 1e-9:
            state, now = player.hold(state, current, max(0.0, times[0] - now)), max(now, times.pop(0))
            states.append((state, current))
        if not times:
            break
        state, now = player.hold(state, current, max(0.0, end - now)), end
    return states


def _until(
    player: Player, state: Array, current: tuple[float, float], cut_C: tuple[float, float], late_s: float,
    found: Faults, fault: str,
) -> None:  # fmt: skip
    """A current held until the display has left a span in each world, and for `late_s` more, then none."""
    rows, waiting = [player.circuit.read(state)], np.ones(len(state), dtype=bool)
    if cut_C[0] > -300.0:
        move, add = player.step(*current, TRIP_S)
        for _ in range(round(FOLLOWED_S / TRIP_S)):
            shown = rows[-1][:, 2, 0]
            waiting &= (shown > cut_C[0]) & (shown < cut_C[1])
            if not waiting.any():
                break
            state = np.where(waiting[:, None, None], move @ state + add, state)
            rows.append(player.circuit.read(state))
    for part in (0.5, 0.5):
        state = player.hold(state, current, part * late_s)
        rows.append(player.circuit.read(state))
    found.note(fault, np.concatenate([np.array(rows), player.follow(state, (0.0, 0.0), AFTER)]))


def _shown(
    skin: Skin, course: Course, demand: Json, told: Json, pause_s: float, rng: np.random.Generator, found: Faults
) -> None:
    """A thermode whose set-point hangs, or whose loop is stuck at an end of its range."""
    cut, watchdog_s, step = demand["cut_off_display_C"], float(demand["watchdog_s"]), course.step_s
    modes, last = skin.steady(float(course.display_C[0])), float(course.display_C[-1])
    waiting = np.full(max(2, round(pause_s / step) + 1), last)
    for _ in range(PLAYS):
        _, modes = skin.run(course.display_C, step, modes)
        if pause_s > 0:
            _, modes = skin.run(waiting, step, modes)
    for place in sorted(int(each) for each in rng.integers(1, len(course.display_C), INSTANTS)):
        _, at = skin.run(course.display_C[: place + 1], step, modes)
        if watchdog_s:
            level = np.full(max(2, round(watchdog_s / step) + 1), float(course.display_C[place]))
            rows, ended = skin.run(level, step, at)
            found.note("set-point hangs until the watchdog", rows)
            found.note(
                "set-point hangs until the watchdog", skin.run(np.full(3001, course.display_C[0]), 0.01, ended)[0]
            )
        if cut["react_within_s"]:
            span = next(each for each in told["device"]["records"] if each["quantity"] == "set-point range")
            for end in (span["low"], span["high"]):
                count = max(1, round(cut["react_within_s"] / 1e-3))
                rows, ended = skin.run(np.full(count + 1, end), 1e-3, at)
                found.note("stuck until the cut-off", rows[:, :, :2])
    found.tried["no watchdog is quick enough"] += not watchdog_s
    found.tried["no cut-off is quick enough"] += not cut["react_within_s"]

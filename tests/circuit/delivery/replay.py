"""Files played on the independent circuit with any repetition or pause, checked against the limits.

The limits are written out as published. `Beyond` maps each rule to how far it is passed: K for temperatures, a share
for rates and doses; negative where all stays inside.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from tests.circuit.delivery.independent import KELVIN, Array, Circuit, Json, Modes, worlds_of

WATCHED = ("skin", "receptor", "display", "hot plate")
LEVELS = {"skin": (15.0, 42.0), "receptor": (15.0, 42.0), "display": (5.0, 45.0), "hot plate": (-300.0, 60.0)}
RATE_K_PER_S, DOSE_MIN, BURN, WARM_S = 10.0, 1.0, 0.01, 600.0
SESSION_S, ROW_S = 1800.0, 0.01
CLOSE_K, CLOSE_SHARE = 2e-3, 2e-3
"""Nearer to a limit than this is rounding."""

PLAYS = (2, 5, 30)
AFTER = ((0.01, 100), (0.1, 90), (1.0, 50))
"""Rows of the minute after a drive: step in s and how many."""

RETURN = "rate of return"
"""The rate of skin where a display that ends away from its baseline is played again."""
SHARES = ("rate", RETURN, "dose", "burn", "time above 43")

Beyond = dict[str, float]


@dataclass(frozen=True)
class Held:
    """A file of held commands as it flows: lengths in s, mean A and mean square A² of each; rest first and last."""

    length_s: Array
    mean_A: Array
    square_A2: Array
    rest: tuple[float, float]
    last: tuple[float, float]

    @staticmethod
    def of(time_s: Array, mean_A: Array, square_A2: Array) -> Held:
        """From rows that are held until the next; the last marks the end."""
        new = np.flatnonzero(np.append(True, (np.diff(mean_A[:-1]) != 0) | (np.diff(square_A2[:-1]) != 0)))
        lengths = np.diff(np.append(time_s[new], time_s[-1]))
        ends = (float(mean_A[0]), float(square_A2[0])), (float(mean_A[-1]), float(square_A2[-1]))
        return Held(lengths, mean_A[new], square_A2[new], *ends)

    @property
    def end_s(self) -> float:
        """Length in s."""
        return float(self.length_s.sum())


@dataclass
class Worst:
    """How far each rule is passed, and in which world."""

    beyond: Beyond = field(default_factory=dict)
    world: dict[str, int] = field(default_factory=dict)

    def note(self, rule: str, far: Array, worlds: Array | None = None) -> None:
        """Keep the greatest of `far` (W, …)."""
        by_world = far.reshape(len(far), -1).max(axis=1)
        if by_world.max() > self.beyond.get(rule, -np.inf):
            self.beyond[rule], self.world[rule] = float(by_world.max()), int(by_world.argmax())

    def levels(self, rows: Array, wider_K: float = 0.0) -> None:
        """Temperatures of rows (rows, W, 4, …), with limits of skin and receptor that are wider in a fault."""
        for k, name in enumerate(WATCHED):
            low, high = LEVELS[name]
            if name in ("skin", "receptor"):
                low, high = low - wider_K, high + wider_K
            self.note(f"{name} low", low - rows[:, :, k].min(axis=0))
            self.note(f"{name} high", rows[:, :, k].max(axis=0) - high)

    def rates(self, rows: Array, steps_s: Array, rule: str = "rate") -> None:
        """Rates of skin over rows, steps in s between them."""
        shape = (-1,) + (1,) * (rows.ndim - 2)
        rate = np.abs(np.diff(rows[:, :, 0], axis=0) / steps_s.reshape(shape)).max(axis=0)
        self.note(rule, rate / RATE_K_PER_S - 1.0)

    def doses(self, minutes: Array, burn: Array, warm_s: Array) -> None:
        """What has added up over a session, (W, …)."""
        self.note("dose", minutes / DOSE_MIN - 1.0)
        self.note("burn", burn / BURN - 1.0)
        self.note("time above 43", warm_s / WARM_S - 1.0)

    @property
    def unsafe(self) -> Beyond:
        """Rules passed by more than rounding."""
        return {k: v for k, v in self.beyond.items() if v > (CLOSE_SHARE if k in SHARES else CLOSE_K)}

    @property
    def margin(self) -> float:
        """How far the nearest limit is, in K or in tenths of a rate or dose; negative where one is passed."""
        return -max(10 * v if k in SHARES else v for k, v in self.beyond.items())


def exposure(rows: Array, steps_s: Array) -> tuple[Array, Array, Array]:
    """CEM43 in min, Henriques integral and s of display above 43 °C over rows (rows, W, 4, …)."""
    shape = (-1,) + (1,) * (rows.ndim - 2)
    step = steps_s.reshape(shape)
    skin = 0.5 * (rows[1:, :, 0] + rows[:-1, :, 0])
    shown = 0.5 * (rows[1:, :, 2] + rows[:-1, :, 2])
    minutes = np.where(skin < 37, 0.0, np.where(skin < 43, 0.25, 0.5) ** (43 - np.minimum(skin, 60))) * step / 60
    burn = np.exp(np.log(3.1) + 98 * np.log(10) - 6.28e5 / (8.314462618 * (np.minimum(skin, 80) + KELVIN))) * step
    return minutes.sum(axis=0), burn.sum(axis=0), ((shown > 43) * step).sum(axis=0)


class Player:
    """One rig in all its worlds, on which files of held currents are played."""

    def __init__(self, rig: Json, rng: np.random.Generator, extra: int = 4) -> None:
        self.circuit = Circuit.of(rig, worlds_of(rig, rng, extra))
        self._modes: dict[tuple[float, float], Modes] = {}
        self._steps: dict[tuple[float, float, float], tuple[Array, Array]] = {}

    def modes(self, mean_A: float, square_A2: float) -> Modes:
        """Modes of a current as commanded; the gain of each world comes in here."""
        key = (mean_A, square_A2)
        if key not in self._modes:
            gain = self.circuit.gain
            self._modes[key] = self.circuit.modes(mean_A * gain, square_A2 * gain**2)
        return self._modes[key]

    def step(self, mean_A: float, square_A2: float, time_s: float) -> tuple[Array, Array]:
        """The map over a time with a current held."""
        key = (mean_A, square_A2, round(time_s, 12))
        if key not in self._steps:
            self._steps[key] = self.modes(mean_A, square_A2).step(time_s)
        return self._steps[key]

    def rest(self, held: Held) -> Array:
        """State before the first play, (W, n, 1)."""
        return self.modes(*held.rest).steady()

    def through(self, held: Held, state: Array, pause_s: float) -> Array:
        """State after a play and its pause."""
        for length, mean, square in zip(held.length_s, held.mean_A, held.square_A2, strict=True):
            move, add = self.step(float(mean), float(square), float(length))
            state = move @ state + add
        return self.hold(state, held.rest, pause_s)

    def hold(self, state: Array, current: tuple[float, float], time_s: float) -> Array:
        """State after a current was held."""
        move, add = self.modes(*current).step(time_s)
        return np.asarray(move @ state + add)

    def play(self, held: Held, state: Array) -> tuple[Array, Array, Array]:
        """Rows (rows, W, 4, plays) of a play, steps in s between them, and the state at its end."""
        rows, steps = [self.circuit.read(state)], []
        for length, mean, square in zip(held.length_s, held.mean_A, held.square_A2, strict=True):
            count = max(1, int(np.ceil(length / ROW_S - 1e-6)))
            move, add = self.step(float(mean), float(square), float(length) / count)
            for _ in range(count):
                state = move @ state + add
                rows.append(self.circuit.read(state))
            steps += [float(length) / count] * count
        return np.array(rows), np.array(steps), state

    def follow(self, state: Array, current: tuple[float, float], parts: tuple[tuple[float, int], ...]) -> Array:
        """Rows of a current held, beginning with the state."""
        rows = [self.circuit.read(state)]
        for step_s, count in parts:
            move, add = self.step(*current, step_s)
            for _ in range(count):
                state = move @ state + add
                rows.append(self.circuit.read(state))
        return np.array(rows)

    def cycle(self, held: Held, pause_s: float) -> tuple[Array, Array]:
        """A play with its pause as x → Φ·x + γ."""
        worlds, nodes = self.circuit.capacity.shape
        probes = np.zeros((worlds, nodes, nodes + 1))
        probes[:, :, 1:] = np.eye(nodes)
        after = self.through(held, probes, pause_s)
        return after[:, :, 1:] - after[:, :, :1], after[:, :, :1]


def _steps(parts: tuple[tuple[float, int], ...]) -> Array:
    return np.concatenate([np.full(count, step) for step, count in parts])


def _pause(pause_s: float) -> tuple[tuple[float, int], ...]:
    """Rows of a pause: fine, then coarse, then what is left."""
    parts, left = [], pause_s
    for step, most in ((0.02, 50), (0.2, 45), (2.0, 300)):
        count = min(most, int(left / step + 1e-9))
        if count:
            parts.append((step, count))
            left -= step * count
    return (*parts, (left, 1)) if left > 1e-6 else tuple(parts)


def judged(player: Player, held: Held, pauses: list[float], chain: list[float], worst: Worst) -> Worst:
    """Play a file 1, 2, 5 and 30 times and endlessly with each pause, then with the pauses of a chain in their order.

    After each, 60 s of the last value and of zero current; zero current without end.
    """
    rest = player.rest(held)
    starts, spans = [rest], []
    for pause in pauses:
        move, add = player.cycle(held, pause)
        state, found = rest, []
        for number in range(2, max(PLAYS) + 1):
            state = move @ state + add
            if number in PLAYS:
                found.append(state)
        eye = np.eye(move.shape[1])
        growing = np.abs(np.linalg.eigvals(move)).max(axis=1) >= 1.0
        steady = np.linalg.solve(eye - move, add) if not growing.any() else np.full_like(rest, 1000.0)
        spans.append((pause, len(starts)))
        starts += [*found, steady]
    state = rest
    for pause in chain:
        state = player.through(held, state, pause)
        starts.append(state)
    rows, steps, ended = player.play(held, np.concatenate(starts, axis=2))
    worst.levels(rows)
    worst.rates(rows, steps)
    minutes, burn, warm = exposure(rows, steps)
    sums = [minutes, burn, warm]
    for current in {held.last, (0.0, 0.0)}:
        after = player.follow(ended, current, AFTER)
        worst.levels(after)
        worst.rates(after[:201], _steps(AFTER)[:200])
        if current == held.last:
            more = exposure(after, _steps(AFTER))
            worst.doses(*(one[:, 0] + other[:, 0] for one, other in zip(sums, more, strict=True)))
    worst.levels(player.circuit.read(player.modes(0.0, 0.0).steady())[np.newaxis])
    for pause, first in spans:
        columns = [0, *range(first, first + len(PLAYS) + 1)]
        per = [one[:, columns] for one in sums]
        if pause > 0:
            between = player.follow(ended[:, :, columns], held.rest, _pause(pause))
            worst.levels(between)
            per = [a + b for a, b in zip(per, exposure(between, _steps(_pause(pause))), strict=True)]
        plays = max(1, int((SESSION_S + pause) / (held.end_s + pause) + 1e-9))
        worst.doses(*(_session(one, plays) for one in per))
    return worst


def _session(per_play: Array, plays: int) -> Array:
    """What a session adds up to at least, from the 1st, 2nd, 5th, 30th and a late play (W, 5)."""
    edges, total = [1, *PLAYS, 10**9], per_play[:, 0].copy()
    for k, (begin, end) in enumerate(itertools.pairwise(edges)):
        count = min(max(plays - begin, 0), end - begin)
        total += count * np.minimum(per_play[:, k], per_play[:, k + 1])
    return total


def in_any_order(player: Player, files: list[Held], order: list[tuple[int, float]], worst: Worst) -> Worst:
    """Play files of a set one after the other, each with a pause after it."""
    state = player.rest(files[order[0][0]])
    for which, pause in order:
        rows, steps, ended = player.play(files[which], state)
        worst.levels(rows)
        worst.rates(rows, steps)
        worst.levels(player.follow(ended, (0.0, 0.0), AFTER))
        state = player.hold(ended, files[which].rest, pause)
    return worst


class Skin:
    """Skin in all its worlds under a display that is prescribed; modes are independent of each other."""

    def __init__(self, rig: Json, rng: np.random.Generator, extra: int = 4) -> None:
        worlds = worlds_of(rig, rng, extra)
        kept = {(w["contact_resistance_relative"], s * w["ambient_K"]): w for w in worlds for s in (-1, 1)}
        own = [dict.fromkeys(worlds[0], 0.0) | {"contact_resistance_relative": c, "ambient_K": a} for c, a in kept]
        self.circuit = Circuit.of(rig, own, module=False)
        rate = -self.circuit.matrix / self.circuit.capacity[:, :, None]
        self.modes = Modes.of(rate, self.circuit.heat / self.circuit.capacity, self.circuit.capacity)
        push = self.circuit.display / self.circuit.capacity
        self.constant = (self.modes.back @ self.modes.heat[:, :, None])[:, :, 0]
        self.push = (self.modes.back @ push[:, :, None])[:, :, 0]

    def steady(self, display_C: float) -> Array:
        """Modes (W, n) under a display held without end."""
        return (self.constant + self.push * display_C) / -self.modes.rates

    def run(self, display_C: Array, step_s: float, modes: Array, held: bool = False) -> tuple[Array, Array]:
        """Rows (rows, W, 4) under a display linear (or held) from row to row, and the modes at the end."""
        from scipy.signal import lfilter  # its import takes a second, which not every process of the tests need spend

        power = self.modes.rates * step_s
        keep = np.exp(power)
        whole = np.expm1(power) / self.modes.rates
        late = (whole - step_s) / power  # weight of the rise over a step
        course = np.empty((*modes.shape, len(display_C)))
        course[:, :, 0] = modes
        for w, k in np.ndindex(*modes.shape):
            rise = np.zeros(len(display_C) - 1) if held else np.diff(display_C)
            force = self.constant[w, k] * whole[w, k]
            force = force + self.push[w, k] * (whole[w, k] * display_C[:-1] + late[w, k] * rise)
            course[w, k, 1:] = lfilter([1.0], [1.0, -keep[w, k]], force, zi=[keep[w, k] * modes[w, k]])[0]
        lumps = self.modes.into @ course
        return self._rows(lumps, display_C), course[:, :, -1]

    def _rows(self, lumps: Array, display_C: Array) -> Array:
        values = self.circuit.watch @ lumps + self.circuit.offset[:, :, None]
        return np.asarray((values + self.circuit.direct[:, :, None] * display_C).transpose(2, 0, 1))

    def let_go(self, modes: Array) -> Array:
        """Rows of 10 min without any heat through the display."""
        free, state, rows = self.circuit.insulated(), self.modes.into @ modes[:, :, None], []
        for step_s, count in ((0.05, 40), (0.5, 60), (5.0, 120)):
            move, add = free.step(step_s)
            for _ in range(count):
                state = move @ state + add
                rows.append(state[:, :, 0])
        lumps = np.array(rows).transpose(1, 2, 0)
        values = self._rows(lumps, np.full(lumps.shape[2], 30.0))
        values[:, :, 0] = values[:, :, 1] = np.array([one[0] for one in lumps]).T  # face as warm as the first lump
        return values


def shown(skin: Skin, ticks: Array, step_s: float, pauses: list[float], lags: tuple[float, ...], worst: Worst,
          rates: bool = True, held: bool = False) -> Worst:  # fmt: skip
    """Play a display (rows,) in °C, once and again and again; at once, and behind each lag (first order)."""
    for pause in pauses:
        for lag in (0.0, *(lags if pause == pauses[0] else ())):
            fine = 5 if lag else 1
            step = step_s / fine
            one = np.interp(np.arange((len(ticks) - 1) * fine + 1) / fine, np.arange(len(ticks)), ticks)
            waiting = np.full(max(0, round((min(pause, 20.0) if lag else pause) / step)), one[-1])
            period = np.append(one[:-1], waiting) if len(waiting) else one[:-1]
            many = _lagged(np.concatenate([np.tile(period, 3), one]), step, lag)
            rest = skin.steady(float(one[0]))
            again = many[-len(one) - len(period) :][: len(period) + 1]
            _, moved = skin.run(again, step, rest, held)
            decay = np.exp(skin.modes.rates * step * (len(again) - 1))
            steady = (moved - decay * rest) / (1 - decay)
            late = many[-len(one) :]
            for display, start, several in ((many, rest, True), (late, steady, False), (again, steady, True)):
                rows, ended = skin.run(display, step, start, held)
                worst.levels(rows)
                if rates:
                    coarse, away = rows[::fine], several and abs(one[0] - one[-1]) > 1e-9
                    worst.rates(coarse, np.full(len(coarse) - 1, step * fine), RETURN if away else "rate")
                if display is again:
                    count = max(1, int((SESSION_S + pause) / ((len(one) - 1) * step + pause) + 1e-9))
                    worst.doses(*(count * each for each in exposure(rows, np.full(len(rows) - 1, step))))
                    continue
                worst.levels(skin.run(np.full(601, display[-1]), 0.1, ended)[0])
                worst.levels(skin.let_go(ended))
    return worst


def _lagged(display_C: Array, step_s: float, lag_s: float) -> Array:
    """First-order lag of a line that is linear from row to row."""
    from scipy.signal import lfilter

    if not lag_s:
        return display_C
    keep = np.exp(-step_s / lag_s)
    late = 1 - (1 - keep) * lag_s / step_s
    force = (1 - keep) * display_C[:-1] + late * np.diff(display_C)
    return np.append(display_C[0], lfilter([1.0], [1.0, -keep], force, zi=[keep * display_C[0]])[0])

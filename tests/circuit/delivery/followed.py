"""The module of the independent circuit under a controller that follows set-points.

At every update of the driver the controller chooses the held current that brings the display to the set-point at the
end of the update, within the driver's limits as they flow in each world. For three currents the display at that time is
computed exactly beforehand; as a function of the current it is a parabola to within rounding. The circuit itself moves
by an implicit step of second order: C·dx/dt = −K(I)·x + b(I), where the current is only in two elements of K.
"""

from collections.abc import Iterator

import numpy as np

from tests.circuit.delivery.exported_files import Course
from tests.circuit.delivery.independent import KELVIN, Array, Circuit, Json, Modes, worlds_of
from tests.circuit.delivery.replay import AFTER, ROW_S, Worst

GAMMA = 1 - np.sqrt(0.5)
"""Of an implicit Runge-Kutta step of two stages: of second order, and without ringing however long it is."""
STEPS_A_ROW = 2

LONGEST_PAUSE_S, AFTERWARDS_S = 15.0, 10.0
"""Of a pause, how much is simulated before a second play, and how long the module is followed after it."""


class Follower:
    """One rig in all its worlds, whose display follows set-points."""

    def __init__(
        self, rig: Json, rng: np.random.Generator, extra: int = 4, worlds: list[dict[str, float]] | None = None
    ) -> None:
        self.circuit = Circuit.of(rig, worlds or worlds_of(rig, rng, extra))
        driver, gain = rig["driver"], self.circuit.gain
        self.period_s = 1.0 / driver["update_Hz"]
        self.most_A = driver["current_limit_A"] * gain
        self.least_A = driver.get("current_min_A", -driver["current_limit_A"]) * gain
        self.compliance_V = float(driver["voltage_limit_V"])
        self.rows = max(1, int(np.ceil(self.period_s / ROW_S - 1e-9)))
        self.row_s = self.period_s / self.rows
        self.store = self.circuit.capacity / (GAMMA * self.row_s / STEPS_A_ROW)
        eye = np.eye(self.store.shape[1])
        self.inverse = np.linalg.inv(self.circuit.matrix + self.store[:, :, None] * eye)
        self._tried_A = np.array([self.least_A, 0.5 * (self.least_A + self.most_A), self.most_A])
        tried = [self.modes(amperes).step(self.period_s) for amperes in self._tried_A]
        self._ahead = (
            np.stack([move[:, 1] for move, _ in tried], axis=1),
            np.stack([add[:, 1, 0] for _, add in tried], 1),
        )

    def modes(self, amperes: Array) -> Modes:
        """Exact steps under currents (W,) that are held."""
        return self.circuit.modes(amperes, amperes**2)

    def allowed(self, amperes: Array, state: Array) -> Array:
        """Currents (W,) within the driver's limits of current and voltage."""
        back_V = self.circuit.alpha * (state[:, 0] - state[:, 1])
        low = np.maximum(self.least_A, (-self.compliance_V - back_V) / self.circuit.ohm)
        high = np.minimum(self.most_A, (self.compliance_V - back_V) / self.circuit.ohm)
        return np.asarray(np.clip(amperes, low, high))

    def towards(self, level_C: float, state: Array) -> Array:
        """The current (W,) after which the display is at a level one update later, or as near as it may come."""
        ends_C = (self._ahead[0] @ state[:, :, None])[:, :, 0] + self._ahead[1]
        middle, half = self._tried_A[1], 0.5 * (self._tried_A[2] - self._tried_A[0])
        bend = 0.5 * (ends_C[:, 0] + ends_C[:, 2]) - ends_C[:, 1]
        slope = 0.5 * (ends_C[:, 2] - ends_C[:, 0])
        under_root = slope**2 - 4 * bend * (ends_C[:, 1] - level_C)
        exact = 2 * (ends_C[:, 1] - level_C) / (np.sqrt(np.maximum(under_root, 0.0)) - slope)
        coldest = -slope / (2 * np.maximum(bend, 1e-12))
        return self.allowed(middle + half * np.where(under_root > 0, exact, coldest), state)

    def rest(self, level_C: float | Array) -> Array:
        """States (W, n) at rest with the display at a level, or as near to it as it may come."""
        return self._steady(self.holding(level_C))

    def holding(self, level_C: float | Array) -> Array:
        """Currents (W,) that hold the display at a level, or as near to it as it may come."""
        low, high = self.least_A.copy(), self.most_A.copy()
        for _ in range(40):  # towards the current of greatest cooling, the driver's highest in most worlds
            near, far = low + (high - low) / 3, high - (high - low) / 3
            rising = self._steady(far)[:, 1] > self._steady(near)[:, 1]
            low, high = np.where(rising, low, near), np.where(rising, far, high)
        low = self.least_A.copy()
        for _ in range(60):
            middle = 0.5 * (low + high)
            warm = self._steady(middle)[:, 1] > level_C
            low, high = np.where(warm, middle, low), np.where(warm, high, middle)
        return np.asarray(0.5 * (low + high))

    def _steady(self, amperes: Array) -> Array:
        """Steady states (W, n); above 1000 °C where the module would heat without end."""
        rate, heat = self.circuit.system(amperes, amperes**2)
        matrix = -rate * self.circuit.capacity[:, :, None]
        states = np.linalg.solve(matrix, (heat * self.circuit.capacity)[:, :, None])[:, :, 0]
        endless = np.linalg.slogdet(matrix)[0] <= 0  # a current lowers one element of K, so at most one mode grows
        states[endless] = 1000.0 + amperes[endless, None]
        return states

    def update(self, amperes: Array, state: Array) -> Iterator[Array]:
        """States (W, n) at the rows of one update with currents held."""
        circuit, pump = self.circuit, self.circuit.alpha * amperes
        joule = 0.5 * circuit.ohm * amperes**2
        heat = circuit.heat.copy()
        heat[:, 0] += joule + pump * KELVIN
        heat[:, 1] += joule - pump * KELVIN
        plates = self.inverse[:, :2, :2] * np.stack([-pump, pump], axis=1)[:, None, :]
        first, second = 1 + plates[:, 0, 0], 1 + plates[:, 1, 1]
        whole = first * second - plates[:, 0, 1] * plates[:, 1, 0]

        def stage(begun: Array) -> Array:
            free = (self.inverse @ (self.store * begun + heat)[:, :, None])[:, :, 0]
            hot = (second * free[:, 0] - plates[:, 0, 1] * free[:, 1]) / whole
            cold = (first * free[:, 1] - plates[:, 1, 0] * free[:, 0]) / whole
            moved = self.inverse[:, :, 0] * (pump * hot)[:, None] - self.inverse[:, :, 1] * (pump * cold)[:, None]
            return np.asarray(free + moved)

        for _ in range(self.rows):
            for _ in range(STEPS_A_ROW):
                inside = stage(state)
                state = stage(state + (1 - GAMMA) / GAMMA * (inside - state))
            yield state

    def follow(self, levels_C: Array, state: Array) -> tuple[Array, Array]:
        """Watched rows (rows, W, 4) while the display is sent to a level at each update, and the states at the end."""
        states = [state]
        for level in levels_C:
            states.extend(self.update(self.towards(float(level), state), state))
            state = states[-1]
        return self.circuit.read(np.array(states).transpose(1, 2, 0)).transpose(2, 0, 1), state

    def levels_of(self, course: Course, hold_s: float) -> Array:
        """The set-point in force at each update of the driver, with the last one held for longer."""
        count = int(np.ceil(((len(course.display_C) - 1) * course.step_s + hold_s) / self.period_s - 1e-9))
        place = np.floor(np.arange(count) * self.period_s / course.step_s + 1e-6).astype(int)
        return np.asarray(course.display_C[np.minimum(place, len(course.display_C) - 1)])

    def hold(self, course: Course, hold_s: float, played: Array, state: Array, worst: Worst) -> Array:
        """States (W, n) after the last set-point was held behind the rows of a play; rates across the join count."""
        levels = self.levels_of(course, hold_s)[len(played) // self.rows :]
        rows, ended = self.follow(levels, state)
        together = np.concatenate([played[-2:-1], rows])
        worst.levels(together)
        worst.rates(together, np.full(len(together) - 1, self.row_s))
        return ended


def followed(rig: Json, course: Course, pauses: list[float], rng: np.random.Generator, worst: Worst) -> Worst:
    """Play set-points twice on the rig's own module, with each pause between; and zero current after either play."""
    follower = Follower(rig, rng)
    rest = follower.rest(float(course.display_C[0]))
    rows, ended = follower.follow(follower.levels_of(course, 0.0), rest)
    _judge(follower, rows, ended, worst)
    for pause_s in {min(pause, LONGEST_PAUSE_S) for pause in pauses}:
        state = follower.hold(course, pause_s, rows, ended, worst)
        again, late = follower.follow(follower.levels_of(course, 0.0), state)
        _judge(follower, again, late, worst)
        follower.hold(course, AFTERWARDS_S, again, late, worst)
    return worst


def followed_in_order(
    rig: Json, courses: list[Course], order: list[tuple[int, float]], rng: np.random.Generator, worst: Worst
) -> Worst:
    """Play set-points of a set one after the other on the rig's own module, each with a pause after it."""
    follower = Follower(rig, rng)
    state = follower.rest(float(courses[order[0][0]].display_C[0]))
    for which, pause_s in order:
        rows, ended = follower.follow(follower.levels_of(courses[which], 0.0), state)
        _judge(follower, rows, ended, worst)
        state = follower.hold(courses[which], min(pause_s, LONGEST_PAUSE_S), rows, ended, worst)
    return worst


def _judge(follower: Follower, rows: Array, ended: Array, worst: Worst) -> None:
    """Levels and rates of a play, and of a minute of zero current after it."""
    worst.levels(rows)
    worst.rates(rows, np.full(len(rows) - 1, follower.row_s))
    off, loose = follower.modes(np.zeros(len(ended))), ended[:, :, None]
    after = [follower.circuit.read(loose)]
    for step_s, count in AFTER:
        move, add = off.step(step_s)
        for _ in range(count):
            loose = move @ loose + add
            after.append(follower.circuit.read(loose))
    worst.levels(np.array(after))
    worst.rates(np.array(after[:101]), np.full(100, AFTER[0][0]))

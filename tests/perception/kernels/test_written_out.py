"""Compiled loops beside their equations written out."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from thermicon.base.numbers.arrays import Array
from thermicon.perception import Observer
from thermicon.perception.kernels import alignment, episodes, kernels, reports
from thermicon.perception.kernels.crossing import (
    CERTAIN,
    GAP_FROM,
    GAP_STEP,
    MILLS,
    RISE,
    Z_FROM,
    Z_MIDDLE,
    Z_STEP,
)

DT, TAU, A = 0.01, 0.3, 11.0


def course(n: int, kind: int, chance: np.random.Generator) -> Array:
    """Nothing, the same all along, one sample, a plateau, the last sample alone, or a walk."""
    psi, (first, end) = np.zeros(n), sorted(chance.integers(0, n + 1, 2).tolist())
    if kind == 1:
        psi += 7.3
    elif kind == 2:
        psi[chance.integers(n)] = 6.0
    elif kind == 3:
        psi[first:end] = chance.uniform(0.0, 6.0)
    elif kind == 4:
        psi[-1] = 8.0
    elif kind == 5:
        psi += np.maximum(np.cumsum(chance.normal(0.0, 0.2, n)), 0.0)
    return psi


def looked_up(table: Array, place: float) -> float:
    return float(np.interp(place, np.arange(table.size), table))


def survived(psi: Array, raised: float, criterion: float) -> Array:
    change = A * np.log1p(raised * np.expm1(psi / A))
    change = np.abs(change - change[0])
    silent = RISE[Z_MIDDLE] / TAU * looked_up(MILLS, (criterion - GAP_FROM) / GAP_STEP)
    left = 0.0
    logs = [left]
    for before, now in zip(change[:-1].tolist(), change[1:].tolist(), strict=True):
        z = (now - before) * TAU / DT
        gap = criterion - 0.5 * (now + before)
        rise = max(looked_up(RISE, (z - Z_FROM) / Z_STEP), z)
        rate = rise / TAU * looked_up(MILLS, (gap - GAP_FROM) / GAP_STEP) if now + before > 0.0 else silent
        if left >= CERTAIN:
            left -= DT * (rate - silent)
        logs.append(left)
    return np.array(logs)


def later(values: Array, every: int, delay: float, times: int) -> Array:
    place = every * np.arange(times) - delay
    return np.where(place < 0.0, 0.0, np.interp(place, np.arange(values.size), values))


def reported(
    psi: list[Array], criterion: Array, raised: Array, late: Array, decision: Array, every: int, times: int
) -> tuple[float, Array, float]:  # fmt: skip
    """Probability of a report, of one by each time, and those by cold, of one row."""
    answered, by_cold, missed = np.zeros(times), 0.0, 0.0
    for size in raised.tolist():
        logs = [survived(psi[k], size, criterion[k]) for k in range(2)]
        missed += math.exp(logs[0][-1] + logs[1][-1]) / raised.size
        passed = [np.concatenate([[0.0], later(logs[k], every, late[k] / DT, times)]) for k in range(2)]
        left = np.exp(passed[0] + passed[1])
        left[0] = 1.0
        answered += (1.0 - left[1:]) / raised.size
        cold, warm = (np.maximum(-np.diff(each), 0.0) for each in passed)
        share = np.divide(cold, cold + warm, out=np.zeros(times), where=cold + warm > 0.0)
        by_cold += float((-np.diff(left) * share).sum()) / raised.size
    decided = np.mean([later(answered, 1, each / (every * DT), times) for each in decision.tolist()], axis=0)
    probability = min(max(1.0 - missed, 0.0), 1.0)
    decided[-1] = probability
    return probability, decided, min(max(by_cold / answered[-1], 0.0), 1.0) if answered[-1] > 0.0 else 0.0


@pytest.mark.parametrize("samples", [2, 3, 64, 65, 66, 130])
@pytest.mark.parametrize("every", [1, 3])
def test_reports(samples: int, every: int) -> None:
    chance = np.random.default_rng(samples)
    # As many times as it takes, one, and fewer than the sensations go on for.
    for times in (samples // every + 20, 1, max(2, samples // every // 2)):
        rows = 8
        cold, warm = (np.array([course(samples, k, chance) for k in chance.integers(0, 6, rows)]) for _ in range(2))
        criterion, raised = chance.uniform(1.0, 4.0, (rows, 2)), np.exp(chance.normal(0.0, 0.3, 4))
        late = chance.choice([0.0, 0.005, 0.01, 0.123, 3.0], (rows, 2))
        decision = chance.choice([0.0, 0.2, 0.333, 9.0], (rows, 3))
        probability, given, share = np.full(rows, np.nan), np.full((rows, times), np.nan), np.full(rows, np.nan)
        reports.report(cold, warm, DT, criterion, TAU, A, raised, late, decision, every, probability, given, share)
        for row in range(rows):
            expected = reported([cold[row], warm[row]], criterion[row], raised, late[row], decision[row], every, times)
            assert probability[row] == pytest.approx(expected[0], abs=1e-6)
            assert given[row] == pytest.approx(expected[1], abs=1e-6)
            if expected[1][-1] > 1e-4:
                assert share[row] == pytest.approx(expected[2], abs=1e-4)


LONGEST = 12


def sequence(chance: np.random.Generator) -> Array:
    found = chance.normal(0.0, 1.0, (LONGEST, episodes.FEATURES))
    found[:, episodes.QUALITY] = chance.integers(0, 2, LONGEST)
    found[:, episodes.CUT] = chance.integers(0, 2, LONGEST)
    found[:, episodes.NOISE] = chance.uniform(0.0, 0.5, LONGEST)
    found[:, episodes.RISE] = chance.uniform(0.0, 3.0, LONGEST)
    return found


def least_cost(one: Array, two: Array, sd: Array, timing: float) -> float:
    def alone(x: Array) -> float:
        above = max(x[episodes.INTENSITY] - x[episodes.ONSET], 0.0)
        noise = math.hypot(sd[int(x[episodes.QUALITY])], x[episodes.NOISE])
        return float(min(above / noise, x[episodes.RISE]))

    def together(x: Array, y: Array) -> float:
        if x[episodes.QUALITY] != y[episodes.QUALITY]:
            return math.inf
        noise = sd[int(x[episodes.QUALITY])] ** 2 + 0.5 * (x[episodes.NOISE] ** 2 + y[episodes.NOISE] ** 2)
        timed = [episodes.RATE, episodes.PAUSE]
        timed += [episodes.LENGTH] if x[episodes.CUT] == y[episodes.CUT] == 0.0 else []
        off = (x[episodes.INTENSITY] - y[episodes.INTENSITY]) ** 2 / noise
        return max(float(off + ((x[timed] - y[timed]) ** 2).sum() / timing**2), (alone(x) - alone(y)) ** 2)

    @cache
    def cost(i: int, j: int) -> float:
        ways = [0.0] if i == j == 0 else []
        ways += [cost(i - 1, j) + alone(one[i - 1]) ** 2] if i else []
        ways += [cost(i, j - 1) + alone(two[j - 1]) ** 2] if j else []
        ways += [cost(i - 1, j - 1) + together(one[i - 1], two[j - 1])] if i and j else []
        return min(ways)

    return cost(len(one), len(two))


def test_distances_of_sequences_of_any_length() -> None:
    chance = np.random.default_rng(2)
    one, two = (np.array([[sequence(chance) for _ in range(5)] for _ in range(3)]) for _ in range(2))
    ones, twos = (chance.integers(0, LONGEST + 1, (3, 5)) for _ in range(2))
    ones[0, 0] = twos[0, 0] = 0
    sd, timing = chance.uniform(0.3, 1.0, (3, 2)), chance.uniform(0.3, 1.0, 3)
    for same, other, others in ((False, two, twos), (True, one, ones)):
        apart = np.full((3, 5, 5), np.nan)
        alignment.distances(one, ones, other, others, same, sd, timing, apart)
        for p, i, j in np.ndindex(3, 5, 5):
            square = least_cost(one[p, i, : ones[p, i]], other[p, j, : others[p, j]], sd[p], timing[p])
            assert apart[p, i, j] == pytest.approx(math.sqrt(square), abs=1e-9)


@pytest.mark.parametrize(("icons", "draws"), [(1, 1), (3, 1), (3, 511), (3, 513), (17, 1025)])
@pytest.mark.parametrize("apart", [1.0, 10.0, 100.0])
def test_the_nearest_of_any_number_of_draws(icons: int, draws: int, apart: float) -> None:
    """Far apart, most answers are left out; whole numbers make many of them equally near."""
    chance = np.random.default_rng(draws)
    near = (apart * chance.standard_normal((icons, icons))).round().astype(np.float32)
    noise = (3.0 * chance.standard_normal((icons, draws))).round().astype(np.float32)
    counts, expected = np.zeros((icons, icons)), np.zeros((icons, icons))
    kernels.nearest(near, noise, counts)
    for presented in range(icons):
        named = (near[:, presented, np.newaxis] + noise).argmax(axis=0)
        expected[presented] = np.bincount(named, minlength=icons)
    assert np.array_equal(counts, expected)


def test_sensation_written_over_its_drive(observer: Observer) -> None:
    drive: Any = np.zeros((5, 70))
    drive[1], drive[2, 0], drive[3, -1], drive[4, 20:40] = 2.0, 3.0, 3.0, np.linspace(0.0, 4.0, 20)
    drive[4, 30] = 0.0
    scale = np.array([1.0, 0.5, 2.0, 3.0, 4.0])
    apart, b = np.full_like(drive, np.nan), observer.b
    kernels.sensation(drive, scale, observer.a, observer.p, b, apart)
    expected = observer.a * np.log1p((scale[:, np.newaxis] * drive) ** observer.p / b)
    assert apart == pytest.approx(expected, abs=1e-12)
    kernels.sensation(drive, scale, observer.a, observer.p, b, drive)
    assert np.array_equal(drive, apart)

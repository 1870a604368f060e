from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from tests.builders import messages, population_dprime
from thermicon.circuit import InputError, Rig
from thermicon.circuit.solver.simulate import duration_s, simulate_all
from thermicon.icons import Icon, IconSet, parse
from thermicon.perception import choose, draw_people, rank
from thermicon.perception.selection.appraise import appraise
from thermicon.perception.selection.request import Selection

HEAD = 'cue 1\nset pool "Pool" { site thenar; control display; baseline 32 °C }\n'
GOOD = (
    "icon a { cool by 2 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }\n"
    "icon b { cool by 5 °C at 3 °C/s; hold for 1 s; return at 3 °C/s }\n"
    "icon c { warm by 2 °C at 1 °C/s; hold for 3 s; return at 1 °C/s }\n"
    "icon d { warm by 4 °C at 3 °C/s; hold for 1 s; return at 2 °C/s }\n"
    "icon e { cool by 5 °C at 1 °C/s; return at 3 °C/s }\n"
)
TWICE = "icon twice { cool by 5 °C at 3 °C/s; hold for 0.5 s; hold for 0.5 s; return at 3 °C/s }\n"
HOT = "icon hot { warm by 20 °C at 3 °C/s; hold for 5 s; return at 3 °C/s }\n"
FAST = "icon fast { cool by 12 °C at 60 °C/s; return at 60 °C/s }\n"


CROWD = draw_people(12, 1)


class Pool:
    """Icons with what `rank` knows of them."""

    def __init__(self, text: str) -> None:
        self.icons: list[Icon] = list(parse(HEAD + text))
        self.ranking = rank(self.icons, Rig.load("thenar"), people=len(CROWD), seed=1, parameters=0)

    def choose(self, *arguments: Any, **more: Any) -> Any:
        return choose(self.ranking, Selection(*arguments, **more), parameters=0)


POOLS = {
    "pool": GOOD,
    "bad": GOOD + TWICE + HOT + FAST,
    "single": GOOD.split("\n")[0],
    "hots": HOT + HOT.replace("icon hot", "icon hotter").replace("20 °C", "19 °C"),
}


@lru_cache
def pool_of(name: str) -> Pool:
    return Pool(POOLS[name])


@pytest.fixture
def pool() -> Pool:
    return pool_of("pool")


def test_the_worst_pair_is_that_of_the_best_choice(pool: Pool, rig: Rig) -> None:
    found = pool.choose(3)
    middle = np.median(population_dprime(pool.icons, rig, CROWD), axis=0)
    values = {c: sorted(middle[a, b] for a, b in combinations(c, 2)) for c in combinations(range(5), 3)}
    best = max(values, key=lambda c: values[c])  # among equal ones that with the farther next nearest pair
    assert found.icons == tuple(pool.icons[k].name for k in best)
    assert found.value == found.bound == values[best][0]
    assert found.optimal
    a, b = ([icon.name for icon in pool.icons].index(name) for name in found.worst_pair)
    assert middle[a, b] == found.value


def test_it_is_judged_again_at_its_own_range(pool: Pool, rig: Rig) -> None:
    found = pool.choose(3, "bits")
    chosen = [icon for icon in pool.icons if icon.name in found.icons]
    assert found.at_own_range == appraise(chosen, rig, people=len(CROWD), seed=1)
    assert found.optimal
    assert found.value == found.bound
    assert found.seen == 10


def test_time_and_energy_are_those_of_the_traces_and_are_kept(pool: Pool, rig: Rig) -> None:
    free = pool.choose(2)
    chosen = [k for k, icon in enumerate(pool.icons) if icon.name in free.icons]
    lengths = [duration_s(pool.icons[k], rig) for k in chosen]
    assert free.total_s == pytest.approx(sum(lengths))
    energy, traces = 0.0, simulate_all(pool.icons, rig, end_s=30.0)
    for k, length in zip(chosen, lengths, strict=True):
        trace = traces[k]
        rows = trace.time_s < length - 1e-9
        steps = np.minimum(np.append(trace.time_s[1:], np.inf), length) - trace.time_s
        energy += float((trace.voltage_V * trace.current_A * steps)[rows].sum())
    assert free.total_J == pytest.approx(energy)
    frugal = pool.choose(2, most_J=free.total_J - 0.5)
    assert frugal.total_J <= free.total_J - 0.5 and frugal.value <= free.value
    least_s = sum(sorted(duration_s(icon, rig) for icon in pool.icons)[:2])
    assert pool.choose(2, most_s=least_s + 1e-6).total_s == pytest.approx(least_s)


@pytest.mark.parametrize("objective", ["worst", "named", "bits", "bits-per-s"])
def test_the_same_arguments_give_the_same_choice(pool: Pool, objective: str) -> None:
    one = pool.choose(3, objective, ("a",))
    assert one == pool.choose(3, objective, ("a",))
    assert "a" in one.icons
    assert list(one.to_dict()["at_own_range"]) == [
        *("worst_pair", "d_prime", "felt_and_named", "proportion_correct", "information_bits", "bits_per_s"),
        *("proportion_correct_interval_new_laboratory", "information_bits_interval_new_laboratory"),
        *("d_prime_interval_new_laboratory", "icons"),
    ]


def test_intervals_are_those_of_the_chosen(six: IconSet, rig: Rig) -> None:
    found = choose(rank(six, rig, people=8, parameters=0), Selection(3), parameters=8)
    own = found.to_dict()["at_own_range"]
    low, high = own["proportion_correct_interval_new_laboratory"]
    assert low < own["proportion_correct"] < high
    alone = rank(replace(six, entries=tuple(six[name] for name in found.icons)), rig, people=8, parameters=8)
    assert alone.new_laboratory is not None
    assert (low, high) == pytest.approx(alone.new_laboratory.proportion_correct, abs=0.02)


def test_what_cannot_be_played_or_stands_twice_is_left_out_and_named() -> None:
    bad = pool_of("bad")
    found = bad.choose(5)
    why = dict(found.excluded)
    assert set(found.icons) == {"a", "b", "c", "d", "e"}
    assert why["twice"] == "moves in the same way as b"
    assert why["hot"].startswith("is not safe: ")
    assert why["fast"].startswith(("is not reached: ", "is not safe: "))
    # Whom one asks for by name is kept, and the other of the two is left out.
    assert dict(bad.choose(3, must=("twice",)).excluded)["b"] == "moves in the same way as twice"


CHOICES = messages(__file__)["choice"]


@pytest.mark.parametrize("asked", CHOICES)
def test_what_cannot_be_chosen_is_told(asked: str) -> None:
    which, _, words = asked.partition(": ")
    with pytest.raises(InputError, match=f"^{CHOICES[asked]}"):
        pool_of(which).choose(**{"count": 3, **eval(f"dict({words})")})

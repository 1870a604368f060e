"""Observers in place of the shipped one, from draws or from records, and what of a file cannot be used."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.records import RecordError, Table, load_records
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, draw_people, frontier, rank, search
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.observer import DATA
from thermicon.perception.observer.observer_model import ObserverModel

SHIPPED = DATA / "observer.toml"
SIX, RIG = load_library("six-icons"), Rig.load("thenar")


@pytest.mark.parametrize(
    ("load", "was", "now", "said"),
    [
        (Observer.load, '"gain noise"', '"gain nois"', "no quantity 'gain noise'; .*gain nois.*Cure: begin with a"),
        (Observer.load, 'unit = "s"', 'unit = "ms"', ".*: unit 'ms', but this quantity is in '.+': convert the value"),
        (ObserverModel.load, '"correlation of cold and warm"', '"other"', "no quantity 'correlation of cold and warm'"),
    ],
)
def test_records_that_are_no_observer_are_refused(
    tmp_path: Path, load: Callable[[Path], object], was: str, now: str, said: str
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(SHIPPED.read_text(encoding="utf-8").replace(was, now, 1), encoding="utf-8")
    with pytest.raises(RecordError, match=rf"^mine\.toml: {said}"):
        load(path)


@pytest.mark.parametrize("variable", VARIABLES)
def test_whatever_is_needed_is_asked_for(variable: Variable) -> None:
    """Without a quantity that an observer is made of, there is this error and no other."""
    needed = set()
    for quantity in {record.quantity.removesuffix(" from heat flow") for record in load_records(SHIPPED)}:
        kept = tuple(r for r in load_records(SHIPPED) if r.quantity.removesuffix(" from heat flow") != quantity)
        try:
            Observer.from_table(Table("x", kept), variable=variable)
        except RecordError as wrong:
            assert f"no quantity '{quantity}'" in str(wrong).replace(" from heat flow", "")
            needed.add(quantity)
    assert len(needed) == 28 and ("limit" in needed) == (variable == "temperature")


@pytest.fixture
def draws_file(tmp_path: Path) -> Path:
    """The shipped draws, of which each needs five times the drive to feel cold."""
    lines = (DATA / "posterior.csv").read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    names = lines[len(head)].split(",")
    place = names.index("cold threshold drive")
    rows = [line.split(",") for line in lines[len(head) + 1 :]]
    for row in rows:
        row[place] = f"{5.0 * float(row[place]):.6g}"
    made = tmp_path / "numb.csv"
    made.write_text("\n".join([*head, ",".join(names), *map(",".join, rows)]) + "\n", encoding="utf-8")
    return made


def test_the_shipped_model_is_the_shipped_observer_with_its_people() -> None:
    model = ObserverModel.load()
    assert model.nominal == Observer.load()
    assert model.key == ""
    assert ObserverModel.of(model) is model
    people, shipped = model.people(5, seed=3), draw_people(5, seed=3)
    assert people.threshold_cold.tolist() == shipped.threshold_cold.tolist()


def test_records_give_the_same_people_and_observer_and_no_draws(tmp_path: Path) -> None:
    own = tmp_path / "lab.toml"
    own.write_bytes(SHIPPED.read_bytes())
    model = ObserverModel.load(own)
    assert model.nominal == Observer.load()
    assert model.posterior is None
    assert np.allclose(model.people(4, 1).criterion_cold, draw_people(4, 1).criterion_cold)
    ranking, plain = (
        rank(SIX, RIG, people=4, parameters=0 if each is None else 8, observer=each) for each in (own, None)
    )
    assert ranking.new_laboratory is None
    assert ranking.observer == "lab.toml"
    assert np.allclose(ranking.confusion, plain.confusion)


@pytest.mark.slow
def test_a_ranking_with_other_draws_follows_them_throughout(draws_file: Path) -> None:
    numb = rank(SIX, RIG, people=8, parameters=8, observer=draws_file)
    usual = rank(SIX, RIG, people=8, parameters=8)
    place = usual.labels.index("cooling-step")
    # Cold needs five times the change: the percept, the d′ to its neighbour and the interval all follow.
    assert numb.icons[place].onset_s is None or numb.icons[place].onset_s > usual.icons[place].onset_s + 0.1  # type: ignore[operator]
    neighbour = usual.labels.index("linear-cooling")
    assert abs(numb.d_prime[place, neighbour] - usual.d_prime[place, neighbour]) > 0.1
    # Six strong icons are remembered by ratios, so that one point of per cent correct is all they lose.
    assert numb.proportion_correct < usual.proportion_correct - 0.005
    assert numb.new_laboratory.proportion_correct[1] < usual.new_laboratory.proportion_correct[1]
    assert numb.content_hash != usual.content_hash
    assert numb.to_dict()["observer"] == "numb.csv"


def test_a_search_and_a_frontier_follow_another_observer(draws_file: Path) -> None:
    text = "cue 1; icon dip { cool by 3 K at 2 K/s }; icon glow(k in 1..4 step 1 K) { warm by k at 2 K/s }"
    searched = [search(parse(text), RIG, evaluations=10, people=4, observer=each) for each in (None, draws_file)]
    assert searched[1].before.d_prime < searched[0].before.d_prime
    chosen = [frontier(SIX, RIG, people=8, most=2, objective="worst", observer=each) for each in (None, draws_file)]
    assert chosen[1].points[0].at_own_range.d_prime < chosen[0].points[0].at_own_range.d_prime

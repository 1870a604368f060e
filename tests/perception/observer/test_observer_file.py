"""Observers in place of the shipped one, from draws or from records, and what of a file cannot be used."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.records import RecordError, Table, dump_records, load_records
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, draw_people, frontier, rank, search
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.observer import DATA
from thermicon.perception.observer.observer_model import ObserverModel

SHIPPED = DATA / "observer.toml"


def without(quantity: str, instead: str | None = None) -> Table:
    records = tuple(
        r if r.quantity != quantity else type(r)(instead or "x", r.unit, r.source, r.central)
        for r in load_records(SHIPPED)
        if r.quantity != quantity or instead
    )
    return Table("mine.toml", records)


def test_a_missing_number_is_named_with_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(dump_records(without("gain noise", "gain nois")), encoding="utf-8")
    with pytest.raises(RecordError, match=r"^mine.toml: no quantity 'gain noise'; .*gain nois.*Cure: begin with a"):
        Observer.load(path)


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


def test_a_quantity_in_another_unit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = SHIPPED.read_text(encoding="utf-8")
    path.write_text(text.replace('unit = "s"', 'unit = "ms"', 1), encoding="utf-8")
    with pytest.raises(
        RecordError, match=r"mine\.toml: .*: unit 'ms', but this quantity is in '.+': convert the value"
    ):
        Observer.load(path)


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
    assert repr(model) == "ObserverModel(shipped, 1000 posterior draws)"


def test_records_give_the_same_people_and_observer_and_no_draws(tmp_path: Path) -> None:
    own = tmp_path / "lab.toml"
    own.write_bytes((DATA / "observer.toml").read_bytes())
    model = ObserverModel.load(own)
    assert model.nominal == Observer.load()
    assert model.posterior is None
    assert np.allclose(model.people(4, 1).criterion_cold, draw_people(4, 1).criterion_cold)
    ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=4, parameters=8, observer=own)
    plain = rank(load_library("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    assert ranking.new_laboratory is None
    assert ranking.observer == "lab.toml"
    assert np.allclose(ranking.confusion, plain.confusion)


def test_records_without_how_people_differ_are_refused(tmp_path: Path) -> None:
    text = (DATA / "observer.toml").read_text(encoding="utf-8")
    own = tmp_path / "lab.toml"
    own.write_text(text.replace('quantity = "correlation of cold and warm"', 'quantity = "other"'), encoding="utf-8")
    with pytest.raises(RecordError, match=r"lab\.toml: no quantity 'correlation of cold and warm'"):
        ObserverModel.load(own)


@pytest.mark.slow
def test_a_ranking_with_other_draws_follows_them_throughout(draws_file: Path) -> None:
    six, rig = load_library("six-icons"), Rig.load("thenar")
    numb = rank(six, rig, people=8, parameters=8, observer=draws_file)
    usual = rank(six, rig, people=8, parameters=8)
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
    six, rig = load_library("six-icons"), Rig.load("thenar")
    searched = [search(parse(text), rig, evaluations=10, people=4, observer=each) for each in (None, draws_file)]
    assert searched[1].before.d_prime < searched[0].before.d_prime
    chosen = [frontier(six, rig, people=8, most=2, objective="worst", observer=each) for each in (None, draws_file)]
    assert chosen[1].points[0].at_own_range.d_prime < chosen[0].points[0].at_own_range.d_prime

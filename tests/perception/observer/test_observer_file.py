"""Variants of the observer, observers from draws or records, unusable files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.base.files.records import RecordError, RecordTable, load_records
from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, parse
from thermicon.perception import Observer, draw_people, frontier, perceive, rank, search
from thermicon.perception.identification.depths import rungs
from thermicon.perception.identification.population import ReceptorTemperatures
from thermicon.perception.observer.channels import VARIABLES, Variable, check_variable
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer import DATA
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.observer.people import People
from thermicon.perception.sensation.bench import Bench, ramp
from thermicon.perception.sensation.percept import perceive_many

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


def test_of_few_draws_all_are_used_and_one_has_no_interval() -> None:
    shipped = ObserverModel.of(None)

    def few(count: int) -> ObserverModel:
        held = shipped.drawn
        return replace(shipped, posterior=replace(held, draws=held.draws[:count], memory=held.memory[:count]))

    assert [each.draw_count(None, 8) for each in (few(3), shipped)] == [3, 8]
    with pytest.raises(ValueError, match="at least two draws of the constants, not 1"):
        rank(list(SIX)[:2], RIG, people=2, observer=few(1))


@pytest.mark.parametrize("variable", VARIABLES)
def test_whatever_is_needed_is_asked_for(variable: Variable) -> None:
    """Without a quantity that an observer is made of, there is this error and no other."""
    needed = set()
    for quantity in {record.quantity.removesuffix(" from heat flow") for record in load_records(SHIPPED)}:
        kept = tuple(r for r in load_records(SHIPPED) if r.quantity.removesuffix(" from heat flow") != quantity)
        try:
            Observer.from_table(RecordTable("x", kept), variable=variable)
        except RecordError as wrong:
            assert f"no quantity '{quantity}'" in str(wrong).replace(" from heat flow", "")
            needed.add(quantity)
    assert len(needed) == 36 and ("limit" in needed) == (variable == "temperature")


@pytest.fixture
def draws_file(tmp_path: Path) -> Path:
    """The shipped draws, of which each needs five times the drive to feel cold."""
    lines = (DATA / "posterior.csv").read_text(encoding="utf-8").splitlines()
    lines = [line for line in lines if "sha256" not in line]
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
    assert abs(numb.d_prime[place, neighbour] - usual.d_prime[place, neighbour]) > 0.01
    # Six strong icons are remembered by ratios, so that one point of per cent correct is all they lose.
    assert numb.proportion_correct < usual.proportion_correct - 0.005
    assert numb.new_laboratory.proportion_correct[1] < usual.new_laboratory.proportion_correct[1]
    assert numb.content_hash != usual.content_hash
    assert numb.to_dict()["observer"] == "numb.csv"


@pytest.mark.slow
def test_a_search_and_a_frontier_follow_another_observer(draws_file: Path) -> None:
    text = "cue 1; icon dip { cool by 3 K at 2 K/s }; icon glow(k in 1..4 step 1 K) { warm by k at 2 K/s }"
    searched = [search(parse(text), RIG, evaluations=10, people=4, observer=each) for each in (None, draws_file)]
    assert searched[1].before.d_prime < searched[0].before.d_prime
    chosen = [frontier(SIX, RIG, people=8, most=2, objective="worst", observer=each) for each in (None, draws_file)]
    assert chosen[1].points[0].at_own_range.d_prime < chosen[0].points[0].at_own_range.d_prime


@pytest.mark.parametrize("variable", VARIABLES)
def test_every_variant_loads_and_is_near_the_thresholds_it_was_inferred_from(variable: Variable) -> None:
    """Published for 0.11 and 0.20 K on the thenar; laboratories differ by 20 to 40 %."""
    person = Observer.load(variable=variable)
    assert person.variable == variable
    felt = [perceive(simulate(SIX[name], RIG, tail_s=2.0), person) for name in ("cooling-step", "warming-step")]
    assert [percept.channel for percept in felt] == ["cold", "warm"]
    bench = Bench(RIG)
    for channel, published in (("cold", 0.11), ("warm", 0.20)):
        half, twice = (bench.play([ramp(channel, share * published, 1.0)], 4.0) for share in (0.5, 2.0))
        assert max(psi.max() for psi in half.felt(person)) < 1.0 < max(psi.max() for psi in twice.felt(person))


@pytest.mark.parametrize("variable", ["temperature", "heat flow"])
def test_an_observer_places_its_receptors_and_a_rig_overrides(variable: Variable) -> None:
    """Deeper receptors are felt later and less; the same depths written in a rig are felt alike, whoever asks."""
    person, icon = Observer.load(variable=variable), SIX["cooling-step"]
    felt = [perceive(simulate(icon, RIG, tail_s=3.0), replace(person, corneum_share=w)) for w in (0.0, 0.5, 1.0)]
    onsets = [each.onset_s for each in felt]
    assert onsets[0] < onsets[1] < onsets[2] and onsets[0] < 0.75 * onsets[2]
    peaks = [each.psi_cold.max() for each in felt]
    assert peaks[0] > peaks[1] > peaks[2]
    for w, own in zip((0.0, 0.5, 1.0), felt, strict=True):
        cold, warm = replace(person, corneum_share=w).depths_m(RIG.skin.corneum_m)
        written = RIG.with_(**{"skin.cold_receptor_mm": 1e3 * cold, "skin.warm_receptor_mm": 1e3 * warm})
        for other in (person, replace(person, corneum_share=0.3)):
            assert perceive(simulate(icon, written, tail_s=3.0), other).onset_s == pytest.approx(own.onset_s, abs=0.02)
        assert sum("places its receptors itself" in each for each in written.warnings) == 1
    assert not any("places its receptors itself" in each for each in RIG.warnings)


@pytest.mark.parametrize("site", ["thenar", "fingertip", "forearm"])
def test_a_crowd_and_draws_have_their_receptors_where_one_person_has(site: str) -> None:
    """Depths between those that were simulated are felt as their own simulation: within 0.05 d′ of 10 and more."""
    rig, crowd, icons = Rig.load(site), People.nominal(2), list(SIX)[:2]
    draws = PosteriorDraws.load()
    several = [draws.observer(k) for k in range(0, len(draws), 25)]
    how = 12.0, 25.0, None
    ladder = ReceptorTemperatures.at_depths(icons, crowd, rig, rungs(several, crowd.corneum_m(rig)), *how)
    for one in several[:8]:
        alone = ReceptorTemperatures.simulated(icons, crowd, rig, one, *how)
        area = rig.contact.area_m2
        for mine, theirs in zip(
            *(perceive_many(*each.felt_by(one), 0.04, one, area_m2=area, site=site) for each in (ladder, alone)),
            strict=True,
        ):
            assert np.abs(mine - theirs).max() < 0.05 + 0.01 * theirs.max()


def test_heat_flow_fades_in_a_hold_where_temperature_does_not() -> None:
    played = Bench(RIG).play([ramp("cold", 1.0, 1.0, 5.0)], 6.0)
    left = []
    for variable in ("temperature", "heat flow"):
        cold = played.felt(Observer.load(variable=variable))[0][0]  # type: ignore[arg-type]
        left.append(cold[-1] / cold.max())
    assert left[1] < 0.7 * left[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"adaptation_s": 0.0}, r"slow adaptation time = 0 must be above 0"),
        ({"softness_K": 0.0}, r"softness of the limits = 0 must be above 0"),
        ({"forearm_factor": Both(1.0, 0.0)}, r"warm threshold on the forearm = 0 must be above 0"),
        ({"neutral_flux": Both((3.0, 3.0), (1.0, 2.0))}, r"cold neutral heat flow: 3 to 3 is empty"),
        ({"a": 0.0}, r"slope of sensation = 0 must be above 0"),
        ({"neutral_C": (36.0, 36.0)}, r"neutral zone: 36 to 36 is empty"),
        ({"lapse": 1.2}, r"lapse rate = 1.2 must lie in 0 to 1"),
        ({"rated_share": 1.5}, r"share of the scatter of ratings = 1.5 must lie in 0 to 1"),
        ({"timing_noise": 0.0}, r"memory noise \(episodes\) = 0 must be above 0"),
        ({"missing_cost": -1.0}, r"cost of a missing episode = -1 must be 0 or more"),
        ({"episode_bar": 0.0}, r"bar of an episode = 0 must be above 0"),
    ],
)
def test_an_observer_proves_itself(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(Observer.load(), **change)


def test_messages(observer: Observer) -> None:
    with pytest.raises(ValueError, match=r"no sensory variable 'flux': choose one of temperature, heat flow"):
        check_variable("flux")
    with pytest.raises(ValueError, match=r"observer of heat flow needs the neutral heat flow of both channels"):
        replace(observer, variable="heat flow")

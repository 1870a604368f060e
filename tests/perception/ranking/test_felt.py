"""One probability of detection in a percept, a ranking or an export for the same people."""

import pytest

from thermicon.circuit import Device, Rig, simulate
from thermicon.circuit.delivery.deliver import traces_until
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.solver.simulate import duration_s, simulate_all
from thermicon.icons import parse
from thermicon.perception import Observer, Ranking, draw_people, perceive, rank
from thermicon.perception.identification.delivered import detected_as_delivered
from thermicon.perception.identification.population import ReceptorTemperatures, population_detection, run_end_s
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.observer.people import People
from thermicon.perception.ranking import batches

RIG = Rig.load("thenar")
ICONS = parse(
    "cue 1; icon faint { cool by 0.4 K at 0.3 K/s; return at 1 K/s };"
    "icon dip { cool by 1.2 K at 1 K/s; return at 1 K/s }"
)
END_S = run_end_s(duration_s(icon, RIG) for icon in ICONS)
PEOPLE = 24


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(ICONS, RIG, people=PEOPLE, parameters=0)


def test_one_nominal_person_is_the_percept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ObserverModel, "people", lambda model, people, seed: People.nominal(people))
    found = rank(ICONS, RIG, people=1, parameters=0, tracking="replay")
    traces = {trace.icon: trace for trace in simulate_all(list(ICONS), RIG, end_s=END_S)}
    assert {icon.name for icon in found.icons} == set(traces)
    for icon in found.icons:
        trace = traces[icon.name]
        percept = perceive(trace)
        # People have lumps at their receptors; a percept is read between those of its trace.
        assert icon.detected_probability == pytest.approx(percept.detected_probability, abs=2e-3)
        assert icon.onset_s == (None if percept.onset_s is None else pytest.approx(percept.onset_s, abs=2e-3))
        assert icon.channel == percept.channel


def test_of_many_it_is_the_mean_over_them(ranking: Ranking) -> None:
    crowd = draw_people(PEOPLE, 0)
    met = ReceptorTemperatures.simulated(list(ICONS), crowd, RIG, Observer.load(), END_S, 100.0, None)
    each = population_detection(met, crowd, Observer.load()).probability
    assert each.shape == (PEOPLE, 2)
    assert [icon.detected_probability for icon in ranking.icons] == pytest.approx(each.mean(axis=0), rel=1e-9)


def test_onset_is_shown_from_one_half_on(ranking: Ranking) -> None:
    faint, dip = ranking.icons
    assert faint.detected_probability < 0.5 <= dip.detected_probability
    assert (faint.onset_s, faint.channel) == (None, None)
    assert dip.onset_s is not None
    assert dip.channel == "cold"
    assert ranking.to_dict()["icons"][0]["onset_s"] is None


def test_an_export_has_the_number_of_the_ranking(ranking: Ranking) -> None:
    for icon, score in zip(ICONS, ranking.icons, strict=True):
        made = deliver(icon, RIG, Device.load("dac-16"))
        found = detected_as_delivered(made, *traces_until(made, made.end_s + 10.0), end_s=END_S, people=PEOPLE)
        assert found.designed == pytest.approx(score.detected_probability, abs=1e-6)
        assert found.delivered == pytest.approx(found.designed, abs=2e-3)


def test_what_a_device_loses_is_lost_for_people_too() -> None:
    made = deliver(ICONS["dip"], RIG, Device.load("dac-16"))
    designed, _ = traces_until(made, made.end_s + 10.0)
    still = simulate(parse("cue 1; icon still { hold for 3 s }")["still"], RIG, tail_s=10.0)
    found = detected_as_delivered(made, designed, still, people=PEOPLE)
    # Their skins differ in lag too, which the scaled change leaves: a tenth of the icon.
    assert found.drop > 0.3 and found.delivered < 0.55 * found.designed


def test_the_same_people_whatever_the_batches(ranking: Ranking, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "SAMPLES_AT_ONCE", 15_000)  # the last batch is smaller
    found = rank(ICONS, RIG, people=PEOPLE, parameters=0)
    for icon, other in zip(ranking.icons, found.icons, strict=True):
        assert icon.detected_probability == pytest.approx(other.detected_probability, rel=1e-12)
        assert icon.onset_s == (None if other.onset_s is None else pytest.approx(other.onset_s, rel=1e-12))

import json
from typing import Any

import numpy as np
import pytest

from tests.builders import steps
from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import Ranking, rank
from thermicon.perception.identification.confusion import NAMED_SAMPLES as NAMED
from thermicon.perception.identification.confusion import sampling_error
from thermicon.perception.observer.channels import MEMORY_FORMS
from thermicon.perception.plots.draw_heat import plot_distance
from thermicon.perception.ranking import batches, by_element

TOP = (
    "thermicon rig rig_changes rig_text observer warnings seed people tracking by memory content_hash sha256 task "
    "icons pairs confusion set persons assumptions goal chosen map"
)
ICON = (
    "name detected_probability onset_s channel peak_change_K attack_K_per_s delay_s felt_and_named proportion_correct "
    "reachable safe reason cautions rules rules_score rules_margin outside_data detected_interval_new_laboratory "
    "onset_interval_new_laboratory_s proportion_correct_interval_new_laboratory "
    "felt_and_named_interval_new_laboratory carry_over"
)
PAIR = (
    "a b d_prime d_prime_interval_new_laboratory confused_probability confused_interval_new_laboratory why rules edit "
    "distinguishable_by_rules rules_margin no_edit parts"
)
SET = (
    "felt_and_named felt_and_named_interval proportion_correct proportion_correct_interval information_bits "
    "information_bits_interval bits_per_s information_bits_plugin trials total_s total_J worst_pair rules_disagree "
    "proportion_correct_by_memory memory_changes felt_and_named_interval_new_laboratory "
    "proportion_correct_interval_new_laboratory information_bits_interval_new_laboratory posterior_draws posterior "
    "new_laboratory_people new_laboratory_covers pair_spread own_laboratory doubt rules_score rules"
)


RIG, SIX = Rig.load("thenar"), load_library("six-icons")


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(SIX, RIG, people=12, seed=7, parameters=4)


@pytest.fixture(scope="module")
def held(ranking: Ranking) -> Any:
    return json.loads(ranking.to_json())


def test_keys_are_those_of_the_contract(held: Any) -> None:
    assert list(held) == TOP.split()
    assert list(held["set"]) == SET.split()
    assert list(held["confusion"]) == ["labels", "probability", "standard_error", "person_standard_error"]
    for icon in held["icons"]:
        assert list(icon) == ICON.split()
        assert list(icon["peak_change_K"]) == ["cold_receptor", "warm_receptor"]
        assert {"rule", "pass", "value", "threshold", "threshold_low", "unit", "source"} <= set(icon["rules"][0])
    for pair in held["pairs"]:
        assert list(pair) == PAIR.split()
        assert pair["edit"] is None
    assert held["chosen"] is None
    assert held["by"] == "model"


def test_numbers_hang_together(held: Any) -> None:
    matrix = np.array(held["confusion"]["probability"])
    assert matrix.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert [icon["name"] for icon in held["icons"]] == held["confusion"]["labels"]
    assert [icon["proportion_correct"] for icon in held["icons"]] == pytest.approx(np.diag(matrix))
    whole, persons = held["set"], held["persons"]
    assert whole["felt_and_named"] == pytest.approx(np.mean(persons["felt_and_named"]))
    assert whole["felt_and_named"] == pytest.approx(np.mean([icon["felt_and_named"] for icon in held["icons"]]))
    for icon in held["icons"]:
        assert (
            icon["felt_and_named"] <= icon["detected_probability"]
            and icon["felt_and_named"] <= icon["proportion_correct"]
        )
    assert whole["proportion_correct"] == pytest.approx(np.trace(matrix) / 6)
    low, high = whole["proportion_correct_interval"]
    assert low <= whole["proportion_correct"] <= high
    assert whole["bits_per_s"] == pytest.approx(whole["information_bits"] / 8.0, rel=0.01)
    forms = whole["proportion_correct_by_memory"]
    assert forms["episodes"] > forms["naming"] + 0.02, "each form is predicted, and the set is the mean of both"
    assert whole["proportion_correct"] == pytest.approx(np.mean([forms["episodes"], forms["naming"]]))
    assert len(held["pairs"]) == 15
    worst = max(held["pairs"], key=lambda pair: pair["confused_probability"])
    assert whole["worst_pair"] == [worst["a"], worst["b"]]
    for pair in held["pairs"]:
        i, j = (held["confusion"]["labels"].index(pair[k]) for k in "ab")
        assert pair["confused_probability"] == pytest.approx((matrix[i, j] + matrix[j, i]) / 2)


def test_same_arguments_same_bytes(ranking: Ranking) -> None:
    calls: list[tuple[int, int]] = []
    again = rank(SIX, RIG, people=12, seed=7, parameters=4, progress=lambda *steps: calls.append(steps))
    assert again.to_json() == ranking.to_json()
    assert calls == [(k, 7) for k in range(1, 8)]
    assert "NaN" not in ranking.to_json()


def test_batches_hold_everyone_once_and_give_the_same_bytes_whatever_the_number_of_workers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = rank(SIX, RIG, people=10, parameters=0)
    monkeypatch.setattr(batches, "SAMPLES_AT_ONCE", 36_000)  # three people of the six icons
    one, three = (rank(SIX, RIG, people=10, parameters=0, workers=workers) for workers in (1, 3))
    assert one.to_json() == three.to_json()
    assert np.array_equal(one.felt.pairs, whole.felt.pairs)


def test_rows_are_ranked_and_pictures_drawn(ranking: Ranking) -> None:
    rows = ranking.rows()
    correct = [row["proportion_correct"] for row in rows]
    assert correct == sorted(correct, reverse=True)
    assert ranking.to_frame().shape == (6, len(rows[0]))
    axes = ranking.plot()
    assert axes.get_title().startswith("Predicted answers, % (diagonal named: ")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("answered", "presented")
    assert ranking._repr_html_().startswith("<svg")
    apart = plot_distance(ranking)
    assert apart.get_title() == "Predicted d′ between icons (memory: episodes)"
    assert (apart.get_xlabel(), apart.get_ylabel()) == ("… and", "d′ between …")


def test_what_was_changed_on_the_rig_is_told() -> None:
    other = RIG.with_(**{"contact.area_cm2": 4}).with_set(["driver.current_limit_A=1.2"])
    ranking = rank(parse(BY_CURRENT % "to 0.5 A at 0.4 A/s"), other, people=1, parameters=0)
    assert ranking.to_dict()["rig_changes"] == ["contact.area_cm2=4", "driver.current_limit_A=1.2"]
    assert " on thenar with contact.area_cm2=4, driver.current_limit_A=1.2, 1 person, " in repr(ranking)


BY_CURRENT = "cue 1\nset s { control current; baseline 32 °C }\nicon a { %s }"


@pytest.mark.parametrize(
    ("course", "safe", "said"),
    [
        ("to 1.6 A at 0.4 A/s; hold for 0.1 s; to 0.1 A at 0.4 A/s", True, ["1.6 A", "-1.5 … 1.5 A"]),
        ("to -3 A at 20 A/s; hold for 20 s", False, ["hard", "-1.5 … 1.5 A", "; "]),
    ],
)
def test_why_an_icon_cannot_be_played(course: str, safe: bool, said: list[str]) -> None:
    icon = rank(parse(BY_CURRENT % course), RIG, people=1, parameters=0).icons[0]
    assert (icon.reachable, icon.safe) == (False, safe)
    assert icon.reason is not None and all(words in icon.reason for words in said)


def test_soft_limits_are_cautions() -> None:
    text = "cue 1\nset s { control display; baseline 32 °C }\nicon a { cool by 12 °C at 2 °C/s; hold for 9 s }"
    ranking = rank(parse(text), RIG, people=1, parameters=0)
    assert ranking.icons[0].safe
    assert ranking.icons[0].reason is None
    assert any("soft" in caution for caution in ranking.icons[0].cautions)
    assert ranking.to_dict()["icons"][0]["cautions"] == list(ranking.icons[0].cautions)


def test_what_rules_and_model_disagree_on_says_by_how_much() -> None:
    (found,) = rank(steps(a=-3, b=-3.3), RIG, people=2, parameters=0).rules_disagree
    assert (found["a"], found["b"], found["rules"], found["model"]) == ("a", "b", True, False)
    assert found["text"].startswith("a and b: rules: distinguishable; model: d′ ")
    assert float(found["text"].split("d′ ")[1].split(",")[0]) < 2.563
    assert found["text"].endswith(", below the 2.563 criterion")


def test_nobody_waits_for_reasons_and_rules_of_pairs_that_nobody_reads(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []
    for name in ("pair_reasons", "pair_rules", "components_of"):
        each = getattr(by_element, name)
        monkeypatch.setattr(by_element, name, lambda *given, name=name, each=each: made.append(name) or each(*given))
    ranking = rank(steps(a=-3, b=-3.3, c=2), RIG, people=2, parameters=0)
    assert (repr(ranking)[:7], made) == ("Ranking", [])
    assert ranking.pairs[0].why
    assert made == ["pair_reasons"]
    ranking.to_json()
    assert set(made) == {"pair_reasons", "pair_rules", "components_of"}


def test_what_does_not_exist_is_null() -> None:
    text = "cue 1\nset s { control skin; baseline 32 °C }\nicon faint { cool by 0.01 °C at 0.1 °C/s; hold for 1 s }"
    ranking = rank(parse(text), RIG, people=2, parameters=0)
    held = json.loads(ranking.to_json())
    icon, whole = held["icons"][0], held["set"]
    assert icon["onset_s"] is icon["channel"] is whole["information_bits"] is whole["worst_pair"] is None
    assert held["pairs"] == whole["rules_disagree"] == []
    assert held["confusion"]["probability"] == [[1.0]]


@pytest.mark.slow
def test_changes_of_order_between_forms_of_memory_are_reported() -> None:
    icons = load_library("wave-confusions")
    by = {form: rank(icons, RIG, people=10, parameters=0, memory=form) for form in MEMORY_FORMS}
    both = rank(icons, RIG, people=10, parameters=0)
    assert both.form_changes and not by["naming"].form_changes, "one form alone has nothing to be compared with"
    places = {form: {icon.name: icon.proportion_correct for icon in ranking.icons} for form, ranking in by.items()}
    for better, worse in both.form_changes:
        assert places["episodes"][better] > places["episodes"][worse] + 0.01
        # Where both count, naming is judged by fewer presentations.
        assert places["naming"][worse] > places["naming"][better] - 0.03
    for form, ranking in by.items():
        assert both.by_form[form] == pytest.approx(ranking.proportion_correct, abs=0.02)
    assert np.allclose(both.d_prime, by["episodes"].d_prime), "distances are those of the first form"


def test_identical_icons_are_guessed() -> None:
    ranking = rank(steps(a=-3, b=-3), RIG, people=3, parameters=0)
    assert ranking.proportion_correct == pytest.approx(0.5)
    assert ranking.information_bits == pytest.approx(0.0, abs=1e-9)
    assert ranking.pairs[0].d_prime == pytest.approx(0.0)
    assert not ranking.pairs[0].rules_pass
    assert ranking.tracking == "display"


def test_rules_use_no_number_of_the_model() -> None:
    """The score of an icon is the share of its rules and of its pairs that pass; the nearest pair has no margin."""
    ranking = rank(steps(a=-3, b=-3.05, c=-3.4), RIG, people=2, parameters=0)
    for row in ranking.rows():
        assert row["rules_score"] == (row["rules_passed"] + row["pairs_distinguishable_by_rules"]) / (row["rules"] + 2)
    held = ranking.to_dict()
    assert held["set"]["rules_score"] == ranking.rules_score == pytest.approx(2 / 3)
    assert [rule["rule"] for rule in held["set"]["rules"]] == ["depth (cold)", "depth (warm)"]
    assert [(pair["distinguishable_by_rules"], pair["rules_margin"] < 0) for pair in held["pairs"]] == [
        (False, True), (True, False), (True, False),
    ]  # fmt: skip
    assert all(pair["distinguishable_by_rules"] == pair["rules"][-1]["pass"] for pair in held["pairs"])


def test_messages() -> None:
    for told, said in (
        ({"intervals": 8}, "rank: intervals is called parameters in Python"),
        ({"workers": 0}, "at least one worker is needed, not 0"),
        ({"people": 0}, "at least one person is needed, not 0"),
    ):
        with pytest.raises(ValueError, match=said):
            rank(SIX, RIG, parameters=0, **told)


def test_direct_naming_states_the_error_of_its_own_trials() -> None:
    pair = parse("cue 1; icon dip { cool by 3 K at 2 K/s }; icon glow { warm by 3 K at 2 K/s }")
    named = rank(pair, RIG, people=4, parameters=0, memory="naming")
    assert named.felt.standard_error == pytest.approx(sampling_error(named.confusion, 4 * NAMED), rel=1e-12)
    assert named.felt.person_standard_error > named.felt.standard_error > 0.0
    assert rank(pair, RIG, people=4, parameters=0, memory="episodes").felt.standard_error == 0.0
    both = rank(pair, RIG, people=4, parameters=0).felt
    assert 0.0 < both.standard_error < named.felt.standard_error, "half of the mean is exact"

"""The evidence behind the constants is shown as the shipped tables have it, with a reason for every miss."""

import json
import math

import pytest

from thermicon.perception import Observer
from thermicon.perception.evidence.conditioning import experiment_title, load_conditioning, suspected
from thermicon.perception.evidence.results import EDGE, load_predictions
from thermicon.perception.evidence.rows import load_evidence
from thermicon.perception.evidence.validate import ValidationReport
from thermicon.perception.evidence.validate_file import conditioning_file, report_file
from thermicon.perception.observer.observer import TURNED_OFF
from thermicon.perception.observer.parts import conduction_s
from thermicon.perception.observer.priors import WIDTH_95


def test_every_row_is_there_and_every_miss_has_a_suspect() -> None:
    known = load_conditioning()
    assert known.rows == load_predictions()
    for each in known.rows:
        inside = each.left_out_low <= each.published <= each.left_out_high
        assert each.covered == inside
        assert bool(suspected(each)) == (not each.covered)
    missed = {(r.experiment, r.statistic, r.channel) for r in known.missed}
    assert missed == set(load_evidence().suspected)
    scores = [abs(each.score) for each in known.missed]
    assert scores == sorted(scores, reverse=True)


def test_widths_are_factors_or_shares() -> None:
    known = load_conditioning()
    limits = next(each for each in known.rows if each.label == "limits, cold")
    assert limits.log
    assert limits.left_out * limits.half_width == pytest.approx(limits.left_out_high, rel=1e-4)
    widths = sorted(each.half_width for each in known.rows if each.log)
    assert known.median_half_width(log=True) == pytest.approx(widths[len(widths) // 2])
    linear = next(each for each in known.rows if not each.log)
    assert linear.half_width * abs(linear.published) == pytest.approx(linear.left_out_high - linear.left_out, rel=1e-3)


def test_an_edge_is_an_outer_tenth_of_the_prior() -> None:
    for each in load_conditioning().constants:
        constant = each
        if constant.prior_low > 0.0 and constant.name.endswith(("time", "between people")):
            middle = math.sqrt(constant.prior_low * constant.prior_high)
            z = math.log(constant.value / middle) / (math.log(constant.prior_high / constant.prior_low) / WIDTH_95)
            assert each.at_edge == (abs(z) > 1.2815516)
            assert each.at_edge == (min(each.quantile, 1.0 - each.quantile) < EDGE)


def test_every_mechanism_has_its_sources() -> None:
    known = load_conditioning()
    runs = {each.without: each for each in known.ablation}
    assert {each.variable for each in known.ablation if not each.without} == {"temperature", "heat flow"}
    assert runs["all of them"].difference < -10.0
    for mechanism in TURNED_OFF:
        assert runs[mechanism].replaced_by and runs[mechanism].sources
    losses = [each.difference for each in known.ablation]
    assert losses == sorted(losses)


def test_the_file_has_the_same_facts(validation_report: ValidationReport) -> None:
    file = json.loads(json.dumps(report_file(validation_report), allow_nan=False))["conditioning"]
    known = validation_report.conditioning
    assert file == json.loads(json.dumps(conditioning_file(known)))
    assert file["summary"]["covered"] == sum(each["left_out"]["covered"] for each in file["rows"]) == 49
    assert sum(each["mechanism_suspected"] is not None for each in file["rows"]) == len(known.missed)
    assert [each["name"] for each in file["constants"] if each["at_edge"]] == [c.name for c in known.at_edge]
    assert len(file["onset_stages"]) == 6
    person = Observer.load()
    for each in file["onset_stages"]:
        parts = [each[f"{part}_s"] for part in ("receptor", "nerve", "cord", "decision")]
        assert sum(parts) == pytest.approx(each["onset_s"])
        delay_s = conduction_s(
            each["channel"], person.receptor(each["channel"]).velocity_m_per_s, person.path_m("thenar")
        )
        assert each["nerve_s"] + each["cord_s"] == pytest.approx(delay_s)
        assert each["decision_s"] == person.decision_s
    assert file["summary"]["expected"] == pytest.approx(0.95 * 54)
    assert (file["not_moved_above"], file["edge_below"]) == (0.9, 0.1)
    assert experiment_title("E1") == "Choice reaction time by area"

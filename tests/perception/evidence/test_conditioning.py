"""The evidence behind the constants as the shipped tables have it."""

import json

import numpy as np
import pytest

from thermicon.perception.evidence.results import (
    judging_predictions,
    load_ablation,
    load_missed,
    load_predictions,
    median_half_width,
)
from thermicon.perception.evidence.rows import load_evidence
from thermicon.perception.evidence.validate_file import conditioning_file


def test_every_miss_has_a_suspect() -> None:
    for each in load_predictions():
        inside = each.left_out_low <= each.published <= each.left_out_high
        assert each.covered == inside
        assert bool(each.suspected) == (not each.covered)
    missed = load_missed()
    assert {(r.experiment, r.statistic, r.channel) for r in missed} == set(load_evidence().suspected)
    scores = [abs(each.score) for each in missed]
    assert scores == sorted(scores, reverse=True)


def test_widths_are_factors_or_shares() -> None:
    rows = load_predictions()
    limits = next(each for each in rows if each.label == "limits, cold")
    assert limits.log
    assert limits.left_out * limits.half_width == pytest.approx(limits.left_out_high, rel=1e-4)
    widths = [each.half_width for each in judging_predictions() if each.log]
    assert median_half_width(log=True) == pytest.approx(float(np.median(widths)))
    linear = next(each for each in rows if not each.log)
    assert linear.half_width * abs(linear.published) == pytest.approx(linear.left_out_high - linear.left_out, rel=1e-3)


def test_every_mechanism_has_its_sources() -> None:
    runs = {each.without: each for each in load_ablation()}
    assert {each.variable for each in load_ablation() if not each.without} == {"temperature", "heat flow"}
    assert runs["all of them"].difference < -10.0
    assert all(each.replaced_by and each.sources for name, each in runs.items() if name not in ("", "all of them"))


def test_the_file_has_the_same_facts() -> None:
    file = json.loads(json.dumps(conditioning_file(), allow_nan=False))
    assert file["summary"]["covered"] == sum(each.covered for each in judging_predictions()) == 34
    assert file["summary"]["expected"] == pytest.approx(0.95 * 36) and len(file["rows"]) == 67
    assert sum(each["mechanism_suspected"] is not None for each in file["rows"]) == len(load_missed())
    assert next(each["title"] for each in file["rows"] if each["experiment"] == "E1") == "Choice reaction time by area"

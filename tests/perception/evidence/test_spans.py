"""Spans of the evidence come from what the experiments play, and move with them."""

from collections.abc import Iterator

import pytest

from thermicon.perception.evidence.results import SPANS, inputs_digest
from thermicon.perception.evidence.spans import spans_of
from thermicon.perception.experiments.abstracts import cool_skin, warm_skin
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.published import EXPERIMENTS
from thermicon.perception.experiments.tasks import Key
from thermicon.perception.observer.draws_file import current_inputs
from thermicon.perception.observer.observer import DATA
from thermicon.perception.sensation.coverage import RESPECTS, EvidenceSpan, load_spans


@pytest.fixture(scope="module")
def shipped() -> dict[str, EvidenceSpan]:
    return {span.respect: span for span in spans_of()}


def test_the_table_is_that_of_the_shipped_experiments(shipped: dict[str, EvidenceSpan]) -> None:
    cure = "run python -m thermicon.perception.evidence observer"
    assert load_spans().keys() == shipped.keys() == RESPECTS.keys(), cure
    for respect, span in load_spans().items():
        assert (span.low, span.high) == pytest.approx((shipped[respect].low, shipped[respect].high), rel=1e-5), cure
        assert (span.low_of, span.high_of) == (shipped[respect].low_of, shipped[respect].high_of), cure
    assert current_inputs(DATA / SPANS) == inputs_digest(), cure


@pytest.mark.parametrize("end", ["low", "high"])
def test_another_experiment_moves_every_span_to_its_conditions(shipped: dict[str, EvidenceSpan], end: str) -> None:
    """Somebody rests, touches, moves and lives beyond the others: each span ends there, and says with whom."""
    low = end == "low"
    rest_C, area_cm2, size_K, duration_s, age = (20.0, 0.3, 0.01, 0.5, 18.0) if low else (38.0, 40.0, 30.0, 60.0, 90.0)
    rate_K_per_s = 0.02 if low else 75.0

    def another(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
        corner = size_K / rate_K_per_s, -size_K
        laboratory.drive("forearm", "cold", rest_C, (corner,), duration_s)
        laboratory.gain("cold", area_cm2, "E3", "forearm", age)
        yield ("E99", "threshold", "cold"), 0.0

    for respect, value in zip(RESPECTS, (rest_C, area_cm2, size_K, rate_K_per_s, duration_s, age), strict=True):
        moved = {span.respect: span for span in spans_of((*EXPERIMENTS, another))}[respect]
        there, kept = ("low", "high") if low else ("high", "low")
        assert getattr(moved, there) == pytest.approx(value)
        assert getattr(moved, f"{there}_of") == "E99"
        assert getattr(moved, kept) == getattr(shipped[respect], kept)


def test_a_sign_moves_no_span_but_a_number_from_the_same_skin_does(shipped: dict[str, EvidenceSpan]) -> None:
    def measured(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
        for experiment in (cool_skin, warm_skin):
            for _, value in experiment(laboratory):
                yield ("E99", "threshold", "warm"), value

    rest, wider = shipped["rest"], {span.respect: span for span in spans_of((*EXPERIMENTS, measured))}["rest"]
    assert cool_skin in EXPERIMENTS and warm_skin in EXPERIMENTS
    assert (rest.low, rest.high) == (30.0, 34.0)
    assert (wider.low, wider.high) == (27.0, 40.0)

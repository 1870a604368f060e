"""How long the validation report takes on the machine at hand, with its usual people and draws."""

import time

import pytest

from thermicon.perception.evidence.validate import validate

LIMIT_S = 180.0


@pytest.mark.benchmark
def test_the_report_takes_less_than_three_minutes() -> None:
    start = time.perf_counter()
    validate()
    assert time.perf_counter() - start < LIMIT_S

"""Priors: scales, intervals, and that every parameter has a source or says that it has none."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thermicon.perception.observer.priors import Prior, Priors, load_priors

ALL = load_priors().each


@given(st.sampled_from(ALL), st.floats(-3.0, 3.0))
def test_places_and_values_go_both_ways(prior: Prior, sds: float) -> None:
    place = prior.middle + sds * prior.sd
    assert prior.to_place(prior.to_value(place)) == pytest.approx(place, abs=1e-6)


def test_every_parameter_has_a_source_or_says_that_it_has_none() -> None:
    assert all(prior.source and prior.mechanism for prior in ALL)
    assert {prior.name for prior in ALL if "no source" in prior.source} >= {"softness of the limits", "gain noise"}


def test_two_parameters_of_one_name_and_one_without_width_are_refused() -> None:
    with pytest.raises(ValueError, match="one name"):
        Priors((ALL[0], ALL[0]))
    with pytest.raises(ValueError, match="cold limit: a prior needs"):
        Prior("cold limit", "degC", "linear", 33.0, 0.0, "quality", "none")

import numpy as np
import pytest

from thermicon.circuit.records import Record
from thermicon.perception.sensation.parameters import (
    ObserverParameter,
    latin,
    observer_parameters,
    parameter_name,
)


def test_what_is_uncertain_is_what_the_file_says() -> None:
    names = [p.name for p in observer_parameters("naming")]
    assert len(names) == len(set(names))
    assert {"slope of sensation", "memory noise (episodes)", "cost of a missing episode", "reference area"} <= set(
        names
    )
    assert "cost of a missing episode" not in [p.name for p in observer_parameters("episodes")]
    # What differs between people is their spread; a neutral zone is a range, not an uncertain number.
    for left in (
        "path length",
        "decision time (",
        "lapse rate",
        "neutral zone",
        "threshold drive",
        "neutral heat flow",
    ):
        assert not [name for name in names if name.startswith(left)]
    assert all(p.source and p.use in ("calibrate", "assumed") for p in observer_parameters())


def test_other_sites_bring_other_parameters() -> None:
    here, there = ({p.name for p in observer_parameters("episodes", site)} for site in ("thenar", "forearm"))
    assert here < there
    assert there - here == {"threshold on the forearm (cold)", "threshold on the forearm (warm)"}


def test_a_parameter_needs_an_interval() -> None:
    with pytest.raises(ValueError, match=r"t: 1, 1, 1 is not an interval about a value"):
        ObserverParameter("t", 1.0, 1.0, 1.0, "s", "x", "assumed")


def test_wide_intervals_are_drawn_in_logarithms() -> None:
    assert ObserverParameter("t", 1.0, 5.0, 100.0, "s", "x", "assumed").at(0.5) == pytest.approx(10.0)
    assert ObserverParameter("t", 1.0, 1.2, 1.4, "s", "x", "assumed").at(0.5) == pytest.approx(1.2)
    assert (
        repr(ObserverParameter("t", 1.0, 1.2, 1.4, "s", "Me 1999", "assumed"))
        == "ObserverParameter(t: 1.2 [1, 1.4] s; Me 1999)"
    )


def test_a_latin_hypercube_has_one_draw_a_stratum() -> None:
    shares = latin(3, 8, seed=4)
    assert shares.shape == (8, 3)
    assert (np.sort((shares * 8).astype(int), axis=0) == np.arange(8)[:, None]).all()
    assert (shares == latin(3, 8, seed=4)).all()
    assert (shares != latin(3, 8, seed=5)).any()


def test_names_tell_channels_and_norms_apart() -> None:
    record = Record("area exponent", "1", "x", value=1.0, channel="cold")
    assert parameter_name(record) == "area exponent (cold)"
    assert parameter_name(Record("path length to the cord", "m", "x", value=1.0, site="hand")).endswith("(hand)")

"""The rig file of a fit."""

from pathlib import Path

import pandas as pd
import pytest

from thermicon.base.numbers.program import own_version
from thermicon.circuit import Rig, fit
from thermicon.circuit.fitting.identify import FittedParameter
from thermicon.circuit.fitting.keys import FitError, free_keys, value_of
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.fitting.rig_fit import RigFit, uncertainties
from thermicon.circuit.fitting.synthetic_log import synthetic_log, write_log
from thermicon.circuit.safety.corners import corners_of

from .conftest import TRUTH


@pytest.fixture(scope="module")
def fitted(log: Log, thenar: Rig, tmp_path_factory: pytest.TempPathFactory) -> RigFit:
    path = tmp_path_factory.mktemp("logs") / "rig.csv"
    write_log(log, path)
    return fit(str(path), thenar, free=[*TRUTH, "ambient.temperature_C", "skin.rest_C"], fixed_skin=True)


@pytest.mark.slow
def test_the_file_reads_back_with_values_uncertainty_and_provenance(fitted: RigFit, tmp_path: Path) -> None:
    fitted.save(tmp_path / "mine.toml")
    back = Rig.load(tmp_path / "mine.toml")
    for item in fitted.parameters:
        table, _, name = item.key.partition(".")
        value = item.value if item.identified else item.start
        assert getattr(getattr(back, table), name) == pytest.approx(value, rel=1e-12)
    assert {item.key for item in fitted.unidentified} == {"ambient.temperature_C", "skin.rest_C"}
    assert back.uncertainty == fitted.rig.uncertainty
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    name, digest = fitted.sources[0]
    assert name == "rig.csv" and digest in text and f"thermicon {own_version()}" in text
    assert "95 % " in back.uncertainty.reason and "rig.csv (sha256 " in back.uncertainty.reason
    assert "not identified by these logs" in text.partition('"ambient.temperature_C" = ')[2].partition("\n")[0]
    assert any(note.startswith("fitted: contact.resistance_m2K_per_W, module.") for note in back.notes)


def test_intervals_become_what_the_gate_varies(fitted: RigFit, thenar: Rig) -> None:
    uncertainty = fitted.rig.uncertainty
    half_width = fitted["contact.resistance_m2K_per_W"].half_width
    assert half_width < 0.15
    assert uncertainty.contact_resistance_relative == 0.15  # half of the shipped one: the least that is written
    assert uncertainty.seebeck_relative == 0.025
    assert uncertainty.ambient_K == thenar.uncertainty.ambient_K  # not identified
    assert uncertainty.plates_relative == thenar.uncertainty.plates_relative
    assert {abs(corner.seebeck_relative) for corner in corners_of(fitted.rig)} == {0.0, 0.025}


def test_a_fit_that_misses_the_log_never_narrows_what_the_gate_varies(log: Log, thenar: Rig, tmp_path: Path) -> None:
    key = "contact.resistance_m2K_per_W"
    found = fit(log, thenar, free=[key], fixed_skin=True)
    before, after = thenar.uncertainty.contact_resistance_relative, found.rig.uncertainty.contact_resistance_relative
    value, start = found[key].value, thenar.contact.resistance_m2K_per_W
    assert found.misfit and value < 0.8 * TRUTH[key]  # contact makes up for the wrong Seebeck coefficient
    assert after > before
    assert value * (1 - after) <= start * (1 - before) and value * (1 + after) >= start * (1 + before) > TRUTH[key]
    assert found.rig.uncertainty.reason == ""
    assert any("exceed the log's own noise" in note for note in found.notes)
    assert any("is not narrowed by this fit" in note for note in found.notes)
    (offset,) = (note for note in found.notes if "display_C is fitted with an offset" in note)
    assert "may stand for what the rig has wrong" in offset
    assert not any("calibrate it" in note for note in found.notes)
    found.save(tmp_path / "monday.toml")
    assert any("is as wide as before the fit, or wider" in note for note in Rig.load(tmp_path / "monday.toml").notes)


@pytest.mark.parametrize(
    ("key", "ends", "known", "width"),
    [
        ("ambient.temperature_C", (25.0, 26.0, 27.0), True, 2.0 + 3.0),
        ("ambient.temperature_C", (25.0, 26.0, 40.0), True, 14.0),
        ("ambient.temperature_C", (10.0, 20.0, 30.0), False, 4.0),
        ("contact.resistance_m2K_per_W", (5e-4, 6e-4, 7e-4), True, 0.37),  # from 0.7 of 5.4e-4 to 6e-4
        ("contact.resistance_m2K_per_W", (1e-4, 9e-4, 9e-3), False, 0.67),
    ],
)
def test_after_a_misfit_the_rig_holds_all_that_it_held_before(
    key: str, ends: tuple[float, float, float], known: bool, width: float, thenar: Rig
) -> None:
    low, value, high = ends
    item = FittedParameter(key, "", "", value_of(thenar, key), value, low, high, key.startswith("contact"), known)
    stated = uncertainties(free_keys([key], thenar), [item], before=thenar.uncertainty, misfit=True)
    assert list(stated.values()) == [width]


def test_a_log_of_another_site_leaves_what_it_cannot_say(log: Log, thenar: Rig) -> None:
    fingertip = Rig.load("fingertip").with_(**{"driver.update_Hz": 20})
    free = ["contact.resistance_m2K_per_W", "module.seebeck_V_per_K"]
    found = fit(log, fingertip, free=free, fixed_skin=True)
    assert "contact.resistance_m2K_per_W" in {item.key for item in found.unidentified}
    assert found.rig.contact == fingertip.contact
    assert found.misfit
    for name in ("contact_resistance_relative", "heat_sink_K", "seebeck_relative"):
        assert getattr(found.rig.uncertainty, name) >= getattr(fingertip.uncertainty, name)
    assert any("not identified, so that the fitted rig keeps" in note and "0.00054" in note for note in found.notes)


@pytest.mark.slow
def test_a_combination_that_only_unknown_keys_explain_is_a_misfit(thenar: Rig) -> None:
    warm = synthetic_log(thenar.with_(**{"skin.rest_C": 34.0}), seed=3, rate_Hz=20.0)
    found = fit(warm, thenar, free=["contact.resistance_m2K_per_W", "ambient.temperature_C", "skin.rest_C"])
    assert found.rig.skin.rest_C == 32.0 and found.misfit
    assert any("another combination of the keys that are not identified" in note for note in found.notes)
    assert found.rig.uncertainty.contact_resistance_relative >= thenar.uncertainty.contact_resistance_relative


def test_a_second_fit_replaces_the_note_of_the_first(fitted: RigFit, thenar: Rig, log: Log, tmp_path: Path) -> None:
    fitted.save(tmp_path / "mine.toml")
    again = fit(log, Rig.load(tmp_path / "mine.toml"), free=["contact.resistance_m2K_per_W"])
    again.save(tmp_path / "again.toml")
    notes = [note for note in Rig.load(tmp_path / "again.toml").notes if note.startswith("fitted:")]
    assert len(notes) == 1 and notes[0].startswith("fitted: contact.resistance_m2K_per_W;")
    with pytest.raises(FitError, match=r"mine.txt: the name of a rig file ends in .toml; call it mine.txt.toml"):
        fitted.save(tmp_path / "mine.txt")


def test_a_voltage_alone_leaves_the_uncertainty_as_it_was(log: Log, thenar: Rig, tmp_path: Path) -> None:
    columns = {name: log.column(name) for name in ("current_A", "voltage_V")}
    pd.DataFrame({"time_s": log.time_s, **columns}).to_csv(tmp_path / "volts.csv", index=False)
    free = ["contact.resistance_m2K_per_W", "module.resistance_ohm"]
    found = fit(str(tmp_path / "volts.csv"), thenar, free=free, fixed_skin=True)
    assert found.rig.uncertainty == thenar.uncertainty
    assert any("no temperature was logged" in note for note in found.notes)


def test_both_plates_must_be_fitted_to_claim_less(log: Log, thenar: Rig, true_rig: Rig) -> None:
    one = fit(log, true_rig, free=["module.cold_plate_J_per_K"], fixed_skin=True)
    both = fit(log, true_rig, free=["module.cold_plate_J_per_K", "module.hot_plate_J_per_K"], fixed_skin=True)
    assert one.rig.uncertainty.plates_relative == thenar.uncertainty.plates_relative
    assert both.rig.uncertainty.plates_relative < thenar.uncertainty.plates_relative

"""The rig file of a fit: equal to the fitted rig, with logs, program and intervals, and the gate uses these."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from thermicon.circuit import Rig, RigFit, fit
from thermicon.circuit.fitting.keys import FitError
from thermicon.circuit.fitting.laboratory import write_log
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.program import own_version
from thermicon.circuit.safety.corners import corners_of

from .conftest import TRUTH


@pytest.fixture(scope="module")
def fitted(log: Log, thenar: Rig, tmp_path_factory: pytest.TempPathFactory) -> RigFit:
    path = tmp_path_factory.mktemp("logs") / "rig.csv"
    write_log(log, path)
    return fit(str(path), thenar, free=[*TRUTH, "ambient.temperature_C", "skin.rest_C"])


@pytest.mark.slow
def test_the_file_reads_back_with_values_uncertainty_and_provenance(fitted: RigFit, tmp_path: Path) -> None:
    fitted.save(tmp_path / "mine.toml")
    back = Rig.load(tmp_path / "mine.toml")
    for key, value in fitted.values.items():
        table, _, name = key.partition(".")
        assert getattr(getattr(back, table), name) == pytest.approx(value, rel=1e-12)
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


def test_a_second_fit_replaces_the_note_of_the_first(fitted: RigFit, thenar: Rig, log: Log, tmp_path: Path) -> None:
    fitted.save(tmp_path / "mine.toml")
    again = fit(log, Rig.load(tmp_path / "mine.toml"), free=["contact.resistance_m2K_per_W"])
    again.save(tmp_path / "again.toml")
    notes = [note for note in Rig.load(tmp_path / "again.toml").notes if note.startswith("fitted:")]
    assert len(notes) == 1 and notes[0].startswith("fitted: contact.resistance_m2K_per_W;")


def test_a_voltage_alone_leaves_the_uncertainty_as_it_was(log: Log, thenar: Rig, tmp_path: Path) -> None:
    drive = {"current_A": log.column("current_A"), "voltage_V": log.column("voltage_V")}
    frame = pd.DataFrame({"time_s": log.time_s, **drive})
    frame.to_csv(tmp_path / "volts.csv", index=False)
    found = fit(str(tmp_path / "volts.csv"), thenar, free=["contact.resistance_m2K_per_W", "module.resistance_ohm"])
    assert found.rig.uncertainty == thenar.uncertainty
    assert any("no temperature was logged" in note for note in found.notes)


def test_both_plates_must_be_fitted_to_claim_less(log: Log, thenar: Rig, true_rig: Rig) -> None:
    one = fit(log, true_rig, free=["module.cold_plate_J_per_K"])
    both = fit(log, true_rig, free=["module.cold_plate_J_per_K", "module.hot_plate_J_per_K"])
    assert one.rig.uncertainty.plates_relative == thenar.uncertainty.plates_relative
    assert both.rig.uncertainty.plates_relative < thenar.uncertainty.plates_relative


def test_a_rig_file_ends_in_toml(fitted: RigFit, tmp_path: Path) -> None:
    with pytest.raises(FitError, match=r"mine.txt: the name of a rig file ends in .toml; call it mine.txt.toml"):
        fitted.save(tmp_path / "mine.txt")

"""Limits of safety as a rig file may change them."""

from pathlib import Path

import pytest

from tests.builders import missing
from tests.circuit.surerig import CERTAIN, WHY
from thermicon.circuit import Drive, Limits, Rig, gate, simulate_current
from thermicon.circuit.rig.rigfile import RigError, SafetyTable
from thermicon.circuit.rig.rules import is_reason, limit_table, safety_keys
from thermicon.circuit.safety.verdict import judge_safety

THENAR = Rig.load("thenar")
REASON = "heat-pain study 12/2025, approved by the ethics board"
PLAIN = (Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8")


def with_table(tmp_path: Path, table: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(PLAIN.replace("[source]", f"{table}\n\n[source]"), "utf-8")
    return path


def test_the_table_of_a_rig_file_has_the_keys_of_the_limits() -> None:
    assert set(SafetyTable.model_fields) == {*safety_keys(), "session_min", "reason"}


def test_every_bound_has_a_source_and_lies_outside_the_limit() -> None:
    for rule in Limits.shipped().rules:
        assert rule.source
        if rule.bound is not None:
            assert rule.bound_source
            assert rule.bound >= rule.limit if rule.upper else rule.bound <= rule.limit
    assert all(record.get("severity") in ("hard", "soft") for record in limit_table())


def test_limits_are_tightened_freely(tmp_path: Path) -> None:
    table = "[safety]\nskin_highest_C = 38\nskin_highest_soft_C = 37\nskin_rate_K_per_s = 4"
    rig = Rig.load(with_table(tmp_path, table))
    assert rig.limits.changed == (
        "skin_highest_C 38 °C instead of 42 °C",
        "skin_highest_soft_C 37 °C instead of 40 °C",
        "skin_rate_K_per_s 4 K/s instead of 10 K/s",
    )
    assert rig.limits.loosened == ()
    assert rig.warnings == ()
    rates = [rule.limit for rule in rig.limits.rules if rule.key == "skin_rate_K_per_s"]
    assert rates == [4.0, -4.0]


def test_a_tightened_limit_holds_for_simulate_too() -> None:
    drive = Drive([0, 20], [0.02, 0.02])
    assert judge_safety(simulate_current(drive, THENAR)).colour == "green"
    verdict = judge_safety(simulate_current(drive, THENAR.with_(**{"safety.skin_highest_C": 35})))
    assert verdict.colour == "red"
    words = ["above the hard limit of 35 °C", "(the rig's [safety]; shipped 42, thermicon, a choice of this project"]
    assert not missing(words, str(verdict.reason))


def test_a_loosened_limit_carries_its_reason_everywhere(tmp_path: Path) -> None:
    rig = Rig.load(with_table(tmp_path, f'[safety]\nskin_highest_C = 42.8\nreason = "{REASON}"'))
    assert rig.warnings == (
        f"limits of safety are loosened: skin_highest_C 42.8 °C instead of 42 °C. Reason given: {REASON}",
    )
    said = gate(Drive([0, 1], [0.08, 0.08]), rig.with_(**CERTAIN)).to_dict()["limits"]
    assert isinstance(said, dict)
    assert said["loosened"] == ["skin_highest_C 42.8 °C instead of 42 °C"]
    assert said["reason"] == REASON


def test_limits_from_python() -> None:
    assert Limits.of({"hot_plate_highest_C": 50.0}).changed == ("hot_plate_highest_C 50 °C instead of 60 °C",)
    with pytest.raises(ValueError, match=r"safety\.hot_plate: no such limit; there is skin_highest_C, skin_lowest_C"):
        Limits.of({"hot_plate": 50.0})
    with pytest.raises(ValueError, match="hot_plate_highest_C = 70 °C: cannot be loosened beyond 60 °C"):
        Limits.of({"hot_plate_highest_C": 70.0}, REASON)


@pytest.mark.parametrize("reason", ["", 'reason = "I know"'])
def test_who_claims_to_be_surer_gives_a_reason(tmp_path: Path, reason: str) -> None:
    path = with_table(tmp_path, f"[uncertainty]\ngain_relative = 0\nambient_K = 1.5\n{reason}")
    more = THENAR.with_(**{"uncertainty.gain_relative": 0.2}).uncertainty
    assert (more.gain_relative, more.ambient_K, more.contact_resistance_relative) == (0.2, 3.0, 0.3), "more needs none"
    with pytest.raises(RigError) as caught:
        Rig.load(path)
    first, second = str(caught.value).splitlines()
    assert "mine.toml: uncertainty.ambient_K = 1.5 K: is smaller than the shipped 3 K, which loosens the gate" in first
    assert not missing(["give uncertainty.reason, a sentence", "20 char", "4 different", "or use 3 K or more"], first)
    assert "uncertainty.gain_relative = 0: is smaller than the shipped 0.1, " in second


@pytest.mark.slow
def test_a_smaller_uncertainty_carries_its_reason_everywhere() -> None:
    rig = THENAR.with_set(["uncertainty.gain_relative=0.02", f'uncertainty.reason="{WHY}"'])
    assert rig.warnings == (f"the worst case of safety is milder: gain ±2 % instead of ±10 %. Reason given: {WHY}",)
    said = gate(Drive([0, 1], [0.08, 0.08]), rig).to_dict()["uncertainty"]
    assert isinstance(said, dict)
    assert (said["reason"], said["smaller_than_shipped"]) == (WHY, ["gain ±2 % instead of ±10 %"])


def test_a_reason_is_a_sentence_of_twenty_letters_and_four_words() -> None:
    assert is_reason("we all know shunts ok")
    assert not is_reason("we all know shunts!")  # 19 characters
    assert not is_reason("measured measured shunts here") and not is_reason("x" * 20)

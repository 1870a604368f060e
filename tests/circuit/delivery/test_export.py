"""Export without a disk."""

import hashlib
import json
import re
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.delivery.one_drive import changed, icon_of, prepare
from tests.circuit.surerig import sure_rig
from tests.circuit.verdicts import GreenVerdict
from thermicon.base.numbers.program import code_digest
from thermicon.circuit import Device, InputError, Rig, export
from thermicon.circuit.delivery.export import ExportError
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import NO_CLEARANCE, pack, sidecar_text
from thermicon.circuit.delivery.prepare import Prepared, Refusal, refusals_of
from thermicon.icons import load_library, parse

RIG, SURE = Rig.load("thenar"), sure_rig()
SIX = load_library("six-icons")
CSV = load_format("csv")
DAC = Device.load("dac-16")
FROST = icon_of("cool by 20 °C at 2 °C/s; hold for 8 s; return at 2 °C/s", "skin", name="frost")
COARSE = changed(Device.load("pwm-h-bridge-10"), "resolution", "bit", value=8)
"""The bridge with 8 bits, the sign included: too coarse to hold a baseline."""


@cache
def ready(name: str = "cooling-step", device: str = "dac-16", form: str = "csv", rig: Rig = RIG) -> Prepared:
    return prepare(SIX[name], rig, Device.load(device), load_format(form))


@cache
def passed(name: str = "cooling-step", device: str = "dac-16", form: str = "csv", rig: Rig = RIG) -> Prepared:
    """The same, with a made-up verdict where what is refused or written does not depend on it."""
    return prepare(SIX[name], rig, Device.load(device), load_format(form), gate=GreenVerdict)


def sidecar_of(one: Prepared, form: str = "csv", **more: Any) -> dict[str, Any]:
    files = pack([one], load_format(form), **more)
    found: dict[str, Any] = json.loads(next(text for name, text in files.items() if name.endswith(".json")))
    return found


def test_what_is_safe_reached_and_faithful_is_not_refused() -> None:
    one = ready()
    assert (one.verdict.colour, one.refusals) == ("green", ())
    assert list(pack([one], CSV)) == ["cooling-step.json", "cooling-step.csv"]


def test_what_is_unsafe_is_refused_and_cannot_be_packed() -> None:
    driver = {"current_limit_A": 4.0, "voltage_limit_V": 40.0, "transconductance_A_per_V": 1}
    rig = sure_rig("thenar", "contact_resistance_relative").with_(**{f"driver.{key}": driver[key] for key in driver})
    one = prepare(FROST, rig, DAC, CSV)
    refusal = one.refusals[0]
    assert (refusal.kind, refusal.forcible) == ("unsafe", False)
    assert str(refusal).startswith("NOT SAFE: skin surface reaches 11.35 °C at 10.26 s, with contact −30 %")
    with pytest.raises(FormatError, match=r"frost: NOT SAFE: skin surface reaches .* below the hard limit of 15 °C"):
        pack([one], CSV)


def test_what_is_not_reached_is_refused_with_the_reason_and_the_cure() -> None:
    rig = RIG.with_(**{"driver.current_limit_A": 0.5})
    (refusal,) = passed(rig=rig).refusals
    assert str(refusal).startswith("NOT reached: misses its target by ")
    assert refusal.forcible
    assert "; driver.current_limit_A is 0.5 A: use a slower or smaller change, or raise the limit" in str(refusal)


def test_a_range_too_small_is_the_one_cause_and_what_it_misses_or_loses_is_no_other() -> None:
    weak = RIG.with_(**{"driver.transconductance_A_per_V": 0.05})
    one = passed(rig=weak)
    (refusal,) = one.refusals
    assert re.match(
        r"NOT reached: dac-16 plays −0.5 … 0.5 A \(−10 … 10 V through driver.transconductance_A_per_V = 0.05\), the "
        r"design needs up to 1.11 A; raise that to 0.12 if .* With that it misses its target by ",
        str(refusal),
    )
    assert one.warnings == ()
    dull = replace(one.delivery, narrowed=replace(one.delivery.narrowed, outcome=None))  # type: ignore[type-var]
    (lossy,) = refusals_of(dull, one.verdict, one.deviation)
    assert re.search(r"^loses too much: dac-16 plays .* With that the \w+ receptor differs by ", str(lossy))


def test_where_rig_and_device_are_too_weak_one_sentence_names_both() -> None:
    rig = RIG.with_(**{"driver.current_limit_A": 0.5, "driver.transconductance_A_per_V": 0.02})
    one = passed(rig=rig)
    (refusal,) = one.refusals
    assert "driver.current_limit_A is 0.5 A and dac-16 plays at most 0.2 A: use " in str(refusal)
    assert not any("dac-16" in text for text in one.warnings)


def test_what_loses_too_much_is_refused_once_with_limit_cause_and_cure() -> None:
    (refusal,) = prepare(SIX["cooling-step"], RIG, COARSE, CSV, gate=GreenVerdict).refusals
    assert re.match(
        r"loses too much: the \w+ receptor differs by 0.\d+ K \(rms\) from the design \(the \w+ receptor by 0.\d+ K\), "
        r"over the stated 0.05 K; pwm-h-bridge-10: its steps are 0.00781 of full duty; use a device that is finer",
        str(refusal),
    )


class Red(GreenVerdict):
    """A gate that gives no reason."""

    colour = "red"


def test_the_gate_is_given_and_its_word_is_final() -> None:
    one = prepare(SIX["double-dip"], RIG, DAC, CSV, gate=Red)
    assert isinstance(one.verdict, Red)
    assert one.refusals == (Refusal("unsafe", "the gate says red"),)


@pytest.mark.parametrize(
    ("form_name", "names", "words"),
    [
        ("csv", ("a-b", "A-B"), "a-b and A-B: differ only in capitals, so that one's files would"),
        ("c-array", ("ab", "Ab"), "ab and Ab: differ only in capitals, so that one's files would"),
        ("c-array", ("é", "è"), "é and è: the files of both would be called icon__ in the format c-array; rename one"),
        ("psychopy", ("a", "Conditions"), "Conditions: its drive Conditions.csv would be taken for the set's own"),
    ],
)
def test_two_files_of_one_name_are_told(form_name: str, names: tuple[str, str], words: str) -> None:
    text = "cue 1\n" + "".join(f"icon {name} {{ hold for 1 s }}\n" for name in names)
    form = load_format(form_name)
    made = [prepare(icon, RIG, DAC, form, gate=GreenVerdict) for icon in parse(text)]
    with pytest.raises(FormatError, match=re.escape(words)):
        pack(made, form)


def test_a_bridge_takes_the_place_of_the_driver_whose_limits_then_say_nothing() -> None:
    delivery = passed("warming-step", "pwm-h-bridge-10", rig=RIG.with_(**{"driver.current_limit_A": 1.0})).delivery
    assert delivery.trace.beyond
    assert delivery.warnings == delivery.device_warnings == ()


class TestSidecar:
    """What stands beside every drive."""

    def test_it_names_everything_that_made_the_drive(self) -> None:
        one = passed(rig=RIG.with_set(["contact.area_cm2=8"]))
        told = sidecar_of(one)
        assert told["thermicon"] == version("thermicon")
        assert told["icon"]["content_hash"] == SIX["cooling-step"].content_hash
        (icon,) = parse(told["icon"]["text"])
        assert icon == replace(SIX["cooling-step"], context=icon.context)
        rig = one.delivery.rig
        assert told["rig"]["content_hash"] == hashlib.sha256(rig.document.encode()).hexdigest()
        assert told["rig"]["changes"] == ["contact.area_cm2=8"]
        assert told["rig"]["document"] == json.loads(rig.document)
        assert told["device"]["name"] == "dac-16"
        assert all(record["source"] for record in told["device"]["records"])
        assert told["update_rate_Hz"] == {"requested": 100.0, "realised": 100.0}
        assert told["seed"] is None
        assert told["what_it_is_not"] == NO_CLEARANCE

    def test_a_device_slower_than_the_rig_is_asked_for_one_rate_and_plays_at_another(self) -> None:
        slow = changed(DAC, "update rate", "Hz", high=40.0)
        files = pack([prepare(SIX["cooling-step"], RIG, slow, CSV, gate=GreenVerdict)], CSV)
        told = json.loads(files["cooling-step.json"])
        times = [float(row.split(",")[0]) for row in files["cooling-step.csv"].decode().splitlines()[1:]]
        assert told["update_rate_Hz"]["requested"] == told["rig"]["document"]["driver"]["update_Hz"] == 100.0
        assert told["update_rate_Hz"]["realised"] == pytest.approx(1.0 / (times[1] - times[0]), rel=1e-6)
        assert told["update_rate_Hz"]["realised"] == pytest.approx(100.0 / 3.0), "every third update"

    def test_it_is_bound_to_its_drive_rig_device_and_program(self) -> None:
        one = ready(device="ni-analogue-output", form="psychopy", rig=sure_rig())
        files = pack([one], load_format("psychopy"))
        told = json.loads(files["cooling-step.json"])
        sha256 = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
        assert told["drive_sha256"] == sha256["cooling-step.csv"]
        assert told["set_files"] == {name: sha256[name] for name in ("conditions.csv", "play_icons.py")}
        assert told["rig_sha256"] == told["rig"]["content_hash"]
        device = json.dumps(told["device"], sort_keys=True, ensure_ascii=False)
        assert told["device_sha256"] == hashlib.sha256(device.encode()).hexdigest()
        assert told["device"]["streams"] is one.delivery.device.streams
        assert told["program"] == {"version": version("thermicon"), "code_sha256": code_digest()}
        extremes = told["played"]["greatest_command_V"], told["played"]["least_command_V"]
        command = one.delivery.played.command  # type: ignore[union-attr]
        assert extremes == pytest.approx((command.max(), command.min()))
        known = told.pop("sidecar_sha256")
        bare = json.dumps(told, ensure_ascii=False, indent=2) + "\n"
        assert known == hashlib.sha256(bare.encode()).hexdigest()

    def test_a_missing_number_is_null(self) -> None:
        assert json.loads(sidecar_text({1: (float("nan"), float("inf"), 2.5)})) == {"1": [None, None, 2.5]}

    def test_every_column_has_a_unit_and_a_meaning(self) -> None:
        columns = {column["name"]: column["unit"] for column in sidecar_of(ready())["columns"]}
        assert columns == {"time_s": "s", "current_A": "A", "command_V": "V", "code": "", "event": ""}

    def test_events_are_on_the_clock_of_the_file(self) -> None:
        events = {event["name"]: (event["time_s"], event["level_C"]) for event in sidecar_of(ready())["events"]}
        assert events["ramp start"] == (0.01, 32.0)
        assert events["target reached"] == (2.01, 26.0)
        assert events["return start"] == (6.01, 26.0)
        assert events["end"] == (8.01, 32.0)
        thermode = sidecar_of(ready(device="qst-tcs2", form="tcs2-serial"), "tcs2-serial")
        assert thermode["events"][0]["time_s"] == 0.0
        assert thermode["played"]["segments"] == 3

    def test_events_say_whose_level_they_have(self) -> None:
        kinds = {
            "display": "warm by 3 °C at 1 °C/s; return at 1 °C/s",
            "skin": "warm by 2 °C at 0.5 °C/s; return at 0.5 °C/s",
            "current": "to 0.4 A at 0.5 A/s; return at 0.5 A/s",
        }
        for control, statements in kinds.items():
            told = sidecar_of(prepare(icon_of(statements, control), RIG, DAC, CSV, gate=GreenVerdict))
            unit = "level_A" if control == "current" else "level_C"
            assert {event["level_of"] for event in told["events"]} == {control}
            assert all(list(event) == ["name", "time_s", unit, "level_of"] for event in told["events"])
            assert told["reached"] is (None if control == "current" else True)

    @pytest.mark.parametrize(
        ("device", "form"),
        [("dac-16", "csv"), ("closed-loop-controller", "setpoint-csv"), ("qst-tcs2", "tcs2-serial")],
    )
    def test_whether_the_target_is_reached_stands_once(self, device: str, form: str) -> None:
        told = sidecar_of(ready(device=device, form=form, rig=SURE), form)
        assert told["reached"] is True
        assert not {key for key in told["predicted"] if "reached" in key or "miss" in key}
        assert told["predicted"]["skin_min_C"] < 27.0

    def test_a_thermode_is_predicted_on_the_clock_of_its_commands_and_without_a_module_of_the_rig(self) -> None:
        told = sidecar_of(ready(device="qst-tcs2", form="tcs2-serial"), "tcs2-serial")
        assert told["played"]["icon_begins_at_s"] == told["events"][0]["time_s"] == 0.0
        assert told["played"]["duration_s"] == told["predicted"]["duration_s"] == told["events"][-1]["time_s"] == 8.0
        assert "times count from the start command; the display follows with the lag" in told["played"]["clock"]
        assert told["played"]["lag_s"] == 0.21
        ends = {
            what.format(end) for what in ("current_{}_A", "voltage_{}_V", "hot_plate_{}_C") for end in ("min", "max")
        }
        assert {"energy_J", *ends} <= {key for key, value in told["predicted"].items() if value is None}
        assert told["predicted"]["display_min_C"] == pytest.approx(26.0, abs=0.06)
        volts = sidecar_of(ready())["predicted"]
        assert volts["energy_J"] > 0
        assert volts["duration_s"] == 8.01

    def test_prediction_differences_limits_and_verdict_are_there(self) -> None:
        told = sidecar_of(ready(), felt={"cooling-step": {"observer": "nominal"}})
        assert told["predicted"]["skin_min_C"] == pytest.approx(26.92, abs=0.01)
        assert set(told["delivered_minus_designed"]) == {"skin", "cold receptor", "warm receptor"}
        assert (told["safety"]["colour"], told["safety"]["findings"]) == ("green", [])
        assert (told["safety"]["scenarios"], len(told["safety"]["checks"])) == (195, len(RIG.limits.rules))
        losses = ["receptor difference", "detection drop", "relative d′ drop", "least d′ drop"]
        assert [record["quantity"] for record in told["stated_losses"]] == losses
        assert told["perception"] == {"observer": "nominal"}
        assert (told["reached"], told["forced"], told["forced_over"]) == (True, False, [])
        assert "dac-16: no such device was ever driven by thermicon" in told["warnings"]

    def test_what_was_forced_says_so_and_why(self) -> None:
        one = prepare(SIX["cooling-step"], RIG, COARSE, CSV, gate=GreenVerdict)
        told = sidecar_of(one, losses={"cooling-step": ["d′ to x falls"]})
        assert told["forced"] is True
        assert told["forced_over"][-1] == "loses too much: d′ to x falls"
        assert len(told["forced_over"]) == 2

    def test_the_whole_gate_is_in_it_with_the_reason_for_looser_limits(self) -> None:
        why = "approved by our own board for this one study"
        rig = RIG.with_(**{"safety.skin_highest_C": 42.5, "safety.reason": why})
        one = ready("warming-step", "qst-tcs2", "tcs2-serial", rig)
        told = sidecar_of(one, "tcs2-serial")["safety"]
        assert told == json.loads(json.dumps(one.verdict.to_dict()))
        assert told["limits"]["reason"] == why
        assert told["limits"]["loosened"] == ["skin_highest_C 42.5 °C instead of 42 °C"]
        assert "not a medical or ethical clearance" in told["what_it_is_not"]

    @pytest.mark.slow
    def test_a_smaller_uncertainty_is_in_it_with_its_reason(self) -> None:
        why = "gain measured against a shunt, 2026-05-12"
        rig = RIG.with_(**{"uncertainty.gain_relative": 0.02, "uncertainty.reason": why})
        told = sidecar_of(ready("warming-step", rig=rig))
        assert told["safety"]["uncertainty"]["smaller_than_shipped"] == ["gain ±2 % instead of ±10 %"]
        assert told["safety"]["uncertainty"]["reason"] == why
        assert any(text.endswith(f"instead of ±10 %. Reason given: {why}") for text in told["warnings"])
        plain = sidecar_of(ready("warming-step", "qst-tcs2", "tcs2-serial"), "tcs2-serial")["safety"]["uncertainty"]
        assert (plain["smaller_than_shipped"], plain["reason"]) == ([], "")
        thermode = sidecar_of(ready("warming-step", "qst-tcs2", "tcs2-serial", rig), "tcs2-serial")
        assert thermode["safety"]["uncertainty"]["smaller_than_shipped"] == ["gain ±2 % instead of ±10 %"]
        assert thermode["safety"]["uncertainty"]["reason"] == why

    @pytest.mark.slow
    def test_soft_limits_are_in_it_word_for_word(self) -> None:
        one = prepare(icon_of("cool by 8 °C at 3 °C/s; hold for 3 s; return at 3 °C/s"), RIG, DAC, CSV)
        assert one.verdict.colour == "amber"
        finding = sidecar_of(one)["safety"]["findings"][0]
        assert finding["text"] == one.verdict.cautions[0]
        assert {"quantity", "severity", "value", "limit", "unit", "time_s", "source"} <= set(finding)


HOT = icon_of("warm by 16 °C at 3 °C/s; hold for 30 s; return at 3 °C/s", name="hot")


class TestCall:
    """Export in one call: files as bytes, refusals as data, and a folder that gets all files or none."""

    def test_a_set_is_exported_for_the_usual_device_of_a_format(self, tmp_path: Path) -> None:
        folder = tmp_path / "new" / "run"
        result = export(list(SIX)[:2], sure_rig(), format="setpoint-csv", pause_s=60.0, folder=folder)
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == dict(result.files)
        assert list((tmp_path / "new").iterdir()) == [folder]
        assert result.device.name == load_format("setpoint-csv").device
        assert repr(result).startswith("Export(2 icons on thenar for closed-loop-controller as setpoint-csv: 6 files, ")

    def test_refusals_are_data_and_nothing_is_written(self, tmp_path: Path) -> None:
        result = export([SIX["warming-step"], HOT], sure_rig(), "dac-16")
        assert result.files == {}
        assert ("hot", "unsafe") in {(name, cause.kind) for name, cause in result.refused}
        assert re.search(r": REFUSED: \d causes?\)$", repr(result))
        with pytest.raises(ExportError, match="hot: NOT SAFE"):
            export([SIX["warming-step"], HOT], sure_rig(), "dac-16", folder=tmp_path / "run")
        assert list(tmp_path.iterdir()) == []

    def test_force_packs_what_misses_its_target_but_never_what_is_unsafe(self) -> None:
        fast = icon_of("cool by 6 °C at 30 °C/s; return at 3 °C/s", "skin", name="fast")
        assert export(fast, sure_rig(), "dac-16").files == {}
        forced = export(fast, sure_rig(), "dac-16", force=True)
        assert {cause.kind for _, cause in forced.refused} == {"unreachable"}
        assert b'"forced": true' in forced.files["fast.json"]
        assert export(HOT, sure_rig(), "dac-16", force=True).files == {}

    def test_a_folder_with_files_in_it_stays_as_it_is(self, tmp_path: Path) -> None:
        (tmp_path / "notes.txt").write_text("mine")
        for folder, words in ((tmp_path, r"notes\.txt was not written by thermicon, .* is kept; move it away"),
                              (tmp_path / "notes.txt" / "run", "cannot write")):  # fmt: skip
            with pytest.raises(ExportError, match=words):
                export(SIX["warming-step"], sure_rig(), "dac-16", folder=folder)
        assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"icons": []}, "no icon to export"),
            ({"format": "cvs"}, "cvs: no such format; did you mean csv"),
            ({"device": "dac-61"}, "dac-61: no such device; did you mean dac-16"),
        ],
    )
    def test_what_cannot_be_played_is_an_input_error(self, changes: dict[str, object], words: str) -> None:
        with pytest.raises(InputError, match=words):
            export(**{"icons": SIX["warming-step"], "rig": "thenar", **changes})  # type: ignore[arg-type]

"""Sets as JSON: what is written has the published schema, whose limits are those of the language."""

import json
from importlib import resources

import pytest
from jsonschema import Draft202012Validator

from tests.icons.model.test_roundtrip import sets
from tests.properties import for_any
from thermicon.icons import Icon, IconSet, load_library, parse
from thermicon.icons.files.exchange import to_json
from thermicon.icons.files.shipped import library_names
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.statements import (
    Current,
    Pulse,
    Return,
    Step,
)
from thermicon.icons.model.units import Kind, fault

SCHEMA = json.loads(resources.files("thermicon.icons").joinpath("data/cue.schema.json").read_text(encoding="utf-8"))
VALID = Draft202012Validator(SCHEMA)

EVERYTHING = """cue 1
set all "Every kind of statement, \\"quoted\\"" {
  site thenar; control display; baseline 32.5 °C; by "A. Person"; doi "10.1234/x"; licence "MIT"; tags "a, b c"
}
icon ramps means "é\\n" tags "x" {
  warm by 1 °C at 1 °C/min; cool to 31 °C over 1 min; change by 1.5 K at 3 K/s; change to 32 °C over 20 ms
  hold for 1e-3 s; return at 0.1 °C/s; rest for 2 s; total at most 200 s
}
icon shapes {
  step cool by 3 °C; hold for 1 s; step to 33 °C; hold for 1 s; step by -1.5 °C; hold for 1 s; return over 1 s
  pulse warm by 1 °C for 200 ms; pulse by -1 °C for 1 s
  repeat 2 {
    sine by 1 °C every 2 s for 4 s
    repeat 3 { square by 1 °C every 1 s for 1.5 s starting cool cut; return at 9 K/s }
  }
  triangle by 1 °C every 2 s for 2 s; sawtooth by 1 °C every 2 s for 2 s starting cool
}
icon later { play ramp_amount=-3_rate=1.5_pause=200_times=2; play shapes; total at least 3 s }
icon ramp(amount in [-3, 3] K, rate in 1..3 step 0.5 °C/s, pause in [200, 400] ms, times in [1, 2]) means "{amount}" {
  repeat times { change by amount at rate; hold for pause; repeat 2 { pulse by amount for pause }; return at rate }
  total at least 1 s
}
icon sizes(size in [0.5, 1] °C, level in [33, 34] °C, pause in [0.5, 1] s) {
  cool by size over pause; step warm by size; rest for 1 s; change to level at 1 °C/s; hold for pause
  pulse cool by size for pause; sine by size every pause for pause starting cool
  return over pause; step to level; hold for pause
}
"""
AMPS = """cue 1
set { control current }
icon a {
  to 0.5 A at 1 A/s; hold for 1 s; step by -100 mA; hold for 1 s; step to 1 A; pulse by 0.2 A for 1 s
  sine by 0.1 A every 1 s for 2 s starting down; to 0 A over 1 s; to 0.2 A over 1 s; return at 0.5 A/s
}
icon b(size in [100, 200] mA, rate in [1, 2] A/s) {
  to size at rate; sawtooth by size every 1 s for 1 s; return at rate
}
"""


@pytest.mark.parametrize("name", library_names())
def test_shipped_sets_are_valid(name: str) -> None:
    assert not list(VALID.iter_errors(json.loads(to_json(load_library(name)))))


@pytest.mark.parametrize("text", [EVERYTHING, AMPS], ids=["temperature", "current"])
def test_every_kind_of_statement_is_valid(text: str) -> None:
    assert not list(VALID.iter_errors(json.loads(to_json(parse(text)))))


def test_a_statement_has_its_fields_with_their_units() -> None:
    made = json.loads(to_json(parse(EVERYTHING)))
    assert made["set"]["baseline_C"] == 32.5
    listed = [part for icon in made["icons"] for part in icon["statements"]]
    listed += [part for each in listed if each["do"] == "repeat" for part in each["statements"]]
    listed += [part for each in listed if each["do"] == "repeat" for part in each["statements"]]
    for statement in (
        {"do": "warm", "by_K": 1, "rate_K_per_s": 1 / 60},
        {"do": "cool", "to_C": 31, "duration_s": 60},
        {"do": "step", "direction": "cool", "by_K": 3},
        {"do": "square", "by_K": 1, "period_s": 1, "duration_s": 1.5, "start": "cool", "cut": True},
        {"do": "play", "icon": "ramp_amount=-3_rate=1.5_pause=200_times=2"},
        {"do": "total", "duration_s": 200, "bound": "at most"},
        {"do": "change", "by_K": {"parameter": "amount"}, "rate_K_per_s": {"parameter": "rate"}},
    ):
        assert statement in listed
    assert {"name": "rate", "unit": "°C/s", "low": 1, "high": 3, "step": 0.5} in made["icons"][3]["parameters"]


def test_the_schema_is_a_schema() -> None:
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize(
    ("table", "key", "kind"),
    [
        ("ChangeTable", "by_K", "change"),
        ("ChangeTable", "to_C", "absolute"),
        ("ChangeTable", "rate_K_per_s", "rate"),
        ("ChangeTable", "duration_s", "time"),
        ("WaveTable", "by_K", "difference"),
        ("DriveTable", "to_A", "current"),
        ("DriveTable", "rate_A_per_s", "current_rate"),
        ("RepeatTable", "count", "count"),
    ],
)
def test_the_schema_has_the_limits_of_the_language(table: str, key: str, kind: Kind) -> None:
    one = Draft202012Validator(SCHEMA["$defs"][table]["properties"][key]["oneOf"][0])
    for value in (-1e10, -71.0, -70.0, -21.0, -20.0, -11.0, -10.0, -1.0, 0.0, 1e-7, 1e-6, 1.0, 20.0, 21.0, 60.0):
        assert one.is_valid(value) == (fault(value, kind) is None), value
    for value in (61.0, 70.0, 71.0, 3600.0, 3601.0, 1e9, 2e9):
        assert one.is_valid(value) == (fault(value, kind) is None), value


@pytest.mark.parametrize(
    "statement",
    [
        '{"do": "cool", "by_K": 6}',
        '{"do": "cool", "by_K": 6, "to_C": 26, "duration_s": 1}',
        '{"do": "cool", "by": 6, "duration_s": 1}',
        '{"do": "hold", "duration_s": 0}',
        '{"do": "dance"}',
        '{"do": "repeat", "count": 2, "statements": []}',
        '{"do": "pulse", "by_K": 0, "duration_s": 1}',
    ],
)
def test_the_schema_refuses_what_no_set_holds(statement: str) -> None:
    document = json.loads(to_json(parse("cue 1; icon a { hold for 1 s }")))
    assert VALID.is_valid(document)
    document["icons"][0]["statements"] = [json.loads(statement)]
    assert not VALID.is_valid(document)


@for_any(sets(), examples=60)
def test_any_set_is_valid(icons: IconSet) -> None:
    assert not list(VALID.iter_errors(json.loads(to_json(icons))))


def test_drives_in_python() -> None:
    context = Context("current", None, "arm")
    icon = Icon("a", (Current(0.5, rate_A_per_s=1), Step(by_A=-0.1), Pulse(by_A=0.1, duration_s=1), Return(2)), context)
    (made,) = json.loads(to_json(IconSet("", "", context, Metadata(), (icon,))))["icons"]
    assert made["statements"] == [
        {"do": "drive", "to_A": 0.5, "rate_A_per_s": 1},
        {"do": "step", "by_A": -0.1},
        {"do": "pulse", "by_A": 0.1, "duration_s": 1},
        {"do": "return", "rate_A_per_s": 2},
    ]

"""Sets as JSON with the published schema."""

import json
from importlib import resources
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from tests.icons.model.test_roundtrip import sets
from tests.properties import for_any
from thermicon.icons import Icon, IconSet, load_library, parse
from thermicon.icons.files.exchange import to_json
from thermicon.icons.files.shipped import library_names
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.statements import Current, Pulse, Return, Step
from thermicon.icons.model.units import Kind, fault

SCHEMA = json.loads(resources.files("thermicon.icons").joinpath("data/cue.schema.json").read_text(encoding="utf-8"))
VALID = Draft202012Validator(SCHEMA)

EVERYTHING, AMPS = (
    Path(__file__).parents[1].joinpath(f"{name}.cue").read_text("utf-8") for name in ("everything", "current")
)


@pytest.mark.parametrize("icons", [parse(EVERYTHING), parse(AMPS), *map(load_library, library_names())], ids=repr)
def test_every_kind_of_statement_and_every_shipped_set_is_valid(icons: IconSet) -> None:
    Draft202012Validator.check_schema(SCHEMA)
    assert not list(VALID.iter_errors(json.loads(to_json(icons))))


def test_a_statement_has_its_fields_with_their_units() -> None:
    made = json.loads(to_json(parse(EVERYTHING)))
    assert made["set"]["baseline_C"] == 32.5
    listed = [part for icon in made["icons"] for part in icon["statements"]]
    for each in listed:  # grows by what repeats hold
        listed += each["statements"] if each["do"] == "repeat" else []
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
    signed = [sign * value for sign in (-1, 1) for value in (1e-7, 1e-6, 1.0, 10.0, 11.0, 20.0, 21.0, 60.0, 61.0, 70.0)]
    for value in (0.0, *signed, 71.0, -71.0, 3600.0, 3601.0, 1e9, 2e9, -1e10):
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

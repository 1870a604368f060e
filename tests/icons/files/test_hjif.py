"""Icons as HJIF: constraints retyped from the published facts of the format, and a player of our own to read it by."""

import json
import re
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from thermicon.icons import Icon, IconSet, library_names, load_library, parse
from thermicon.icons.files.hjif import EXPERIMENTAL, PAUSE_S, HjifError, ticks_per_second, to_hjif
from thermicon.icons.model.corners import Corners

# What a reader asks of the parts that are written here; ours, from facts about the format, no text of the standard.
KEYFRAME = {
    "required": ["relative_position", "amplitude_modulation"],
    "properties": {
        "relative_position": {"type": "integer", "minimum": 0},
        "amplitude_modulation": {"type": "number", "minimum": -1, "maximum": 1},
    },
    "additionalProperties": False,
}
EFFECT = {
    "required": ["effect_type", "position", "phase", "base_signal", "keyframes"],
    "properties": {
        "effect_type": {"const": "Basis"},
        "position": {"type": "integer", "minimum": 0},
        "phase": {"type": "number", "minimum": 0, "maximum": 6.28318},
        "base_signal": {"enum": ["Sine", "Square", "Triangle", "SawToothUp", "SawToothDown"]},
        "keyframes": {"type": "array", "minItems": 2, "items": KEYFRAME},
    },
    "additionalProperties": False,
}
BAND = {
    "required": ["band_type", "curve_type", "lower_frequency_limit", "upper_frequency_limit", "effects"],
    "properties": {
        "band_type": {"const": "Curve"},
        "curve_type": {"const": "Linear"},
        "lower_frequency_limit": {"type": "integer", "minimum": 0, "maximum": 10_000},
        "upper_frequency_limit": {"type": "integer", "minimum": 0, "maximum": 10_000},
        "effects": {"type": "array", "items": EFFECT},
    },
    "additionalProperties": False,
}
CHANNEL = {
    "required": ["id", "description", "gain", "mixing_coefficient", "body_part_mask", "bands"],
    "properties": {
        "id": {"type": "integer"},
        "description": {"type": "string"},
        "gain": {"type": "number", "exclusiveMinimum": 0},
        "mixing_coefficient": {"type": "number", "minimum": 0},
        "body_part_mask": {"type": "integer", "minimum": 0, "maximum": 2**32 - 1},
        "bands": {"type": "array", "minItems": 1, "maxItems": 7, "items": BAND},
    },
    "additionalProperties": False,
}
PERCEPTION = {
    "required": ["id", "perception_modality", "description", "avatar_id", "effect_library", "channels"],
    "properties": {
        "id": {"type": "integer"},
        "perception_modality": {"const": "Temperature"},
        "description": {"type": "string"},
        "avatar_id": {"const": 0},
        "unit_exponent": {"type": "integer"},
        "perception_unit_exponent": {"type": "integer"},
        "reference_devices": {"type": "array"},
        "effect_library": {"type": "array"},
        "channels": {"type": "array", "maxItems": 128, "items": CHANNEL},
    },
    "additionalProperties": False,
}
FILE = {
    "required": "version profile level date description timescale avatars perceptions syncs".split(),  # noqa: SIM905
    "properties": {
        "version": {"type": "string", "pattern": r"^[0-9]{4}(-[0-9])?$", "const": "2023"},
        "profile": {"const": "Main"},
        "level": {"const": 1},
        "date": {"type": "string", "format": "date-time"},
        "description": {"type": "string"},
        "timescale": {"type": "integer", "minimum": 1, "maximum": 48_000},
        "avatars": {"type": "array", "maxItems": 0},
        "perceptions": {"type": "array", "minItems": 1, "items": PERCEPTION},
        "syncs": {"type": "array"},
    },
    "additionalProperties": False,
}
VALID = Draft202012Validator(FILE, format_checker=Draft202012Validator.FORMAT_CHECKER)
SHAPES = """cue 1
set shapes "Shapes" { site thenar; control display; baseline 31.5 °C }
icon ramps { cool by 4 °C at 3 °C/s; hold for 1 s; warm to 33 °C over 700 ms; return at 7 °C/s }
icon away { warm by 2 °C at 1 °C/s; hold for 1.5 s }
icon steps { step cool by 3 °C; hold for 1 s; pulse by 2 °C for 300 ms; hold for 1 s; step warm by 3 °C }
icon wave { sine by 3 °C every 4 s for 8 s starting cool }
icon still { hold for 2 s }
"""


def player(document: dict[str, Any], time_s: float) -> float:
    """What MPEG's player makes of the Curve bands at a time: lines, 0 at and after the end, sum, clamp, gain."""
    out = 0.0
    for perception in document["perceptions"]:
        for channel in perception["channels"]:
            total = 0.0
            for band in channel["bands"]:
                for effect in band["effects"]:
                    keys = effect["keyframes"]
                    tick = time_s * document["timescale"] - effect["position"]
                    first, last = keys[0], keys[-1]
                    if tick < 0 or tick >= last["relative_position"]:
                        continue
                    if tick <= first["relative_position"]:
                        total += first["amplitude_modulation"]
                        continue
                    after = next(n for n, key in enumerate(keys) if key["relative_position"] > tick)
                    a, b = keys[after - 1], keys[after]
                    part = (tick - a["relative_position"]) / (b["relative_position"] - a["relative_position"])
                    total += a["amplitude_modulation"] + part * (b["amplitude_modulation"] - a["amplitude_modulation"])
            out += min(1.0, max(-1.0, total)) * channel["gain"]
    return out


def read(icons: IconSet | list[Icon]) -> dict[str, Any]:
    document = json.loads(to_hjif(icons))
    assert not list(VALID.iter_errors(document))
    ids = [perception["id"] for perception in document["perceptions"]]
    assert len(set(ids)) == len(ids)
    for perception in document["perceptions"]:
        (channel,) = perception["channels"]
        (band,) = channel["bands"]
        (effect,) = band["effects"]
        ticks = [key["relative_position"] for key in effect["keyframes"]]
        assert ticks == sorted(set(ticks))
        assert effect["keyframes"][0] == {"relative_position": 0, "amplitude_modulation": 0.0}
        assert effect["keyframes"][-1]["amplitude_modulation"] == 0
    made: dict[str, Any] = document
    return made


def follow(icons: IconSet) -> None:
    document = read(icons)
    start = 0.0
    tick = 1 / document["timescale"]
    for icon in icons:
        corners = icon.corners()
        baseline = icon.context.baseline_C
        assert baseline is not None
        steps = {corners.time_s[place] for place in corners.steps} | {corners.duration_s}
        slack = 2e-9 + 2 * tick * corners.steepest_per_s
        for time in np.linspace(0, corners.duration_s + 1, 400):
            if min(abs(time - step) for step in steps) < 3 * tick:
                continue  # a step takes a tick here and 0.1 µs there
            wanted = corners.at(float(time)) if time < corners.duration_s else baseline
            assert player(document, start + time) + baseline == pytest.approx(wanted, abs=slack), (icon.name, time)
        last = document["perceptions"][ids_of(icons).index(icon.name)]["channels"][0]["bands"][0]["effects"][0]
        start += last["keyframes"][-1]["relative_position"] * tick + PAUSE_S


def ids_of(icons: IconSet) -> list[str]:
    return [icon.name for icon in icons]


@pytest.mark.parametrize("name", library_names())
def test_shipped_sets_play_as_they_are_written(name: str) -> None:
    icons = load_library(name)
    if len(icons) > 128:
        with pytest.raises(HjifError, match=r"128 icons per file at most \(profile Main, level 1\)"):
            to_hjif(icons)
    else:
        follow(icons)


def test_every_shape_plays_as_it_is_written() -> None:
    follow(parse(SHAPES))


def test_corner_times_are_exact_where_a_timescale_allows() -> None:
    icons = parse(SHAPES)
    document = read([icons["ramps"]])
    assert document["timescale"] == 21_000  # 4/3 s, 7/10 s and 1.5/7 s are all whole ticks
    keys = document["perceptions"][0]["channels"][0]["bands"][0]["effects"][0]["keyframes"]
    assert [key["relative_position"] for key in keys] == [0, 28_000, 49_000, 63_700, 68_200]
    assert [key["amplitude_modulation"] for key in keys] == [0, -1, -1, 0.375, 0]
    assert document["perceptions"][0]["channels"][0]["gain"] == 4
    assert "rounded" not in document["description"]


@pytest.mark.parametrize(
    ("times", "steps", "wanted"),
    [
        ((0.0, 2.0, 2.5), (), 1000),
        ((0.0, 0.0625), (), 2000),
        ((0.0, 1 / 3), (), 3000),
        ((0.0, 1.0000001, 2.0), (0,), 48_000),
        ((0.0, 1 / 3, 1 / 3 + 1e-7, 2.0), (1,), 48_000),
        ((0.0, 1 / 7, 1 / 7 + 1e-7, 2.0), (1,), 47_999 - 47_999 % 7),
        ((0.0, 1 / 1009), (), 1009),
        ((0.0, 2**0.5, 3**0.5), (), 48_000),
        ((0.0, 1 / 47, 1 / 1009 + 1), (), 47_423),
        ((0.0, 1 / 53, 1 / 1009 + 1), (), 48_000),
    ],
)
def test_the_timescale(times: tuple[float, ...], steps: tuple[int, ...], wanted: int) -> None:
    assert ticks_per_second([Corners(times, (32.0,) * len(times), "temperature_C", steps)]) == wanted


def test_the_file_says_what_it_means() -> None:
    document = read(parse(SHAPES))
    told = document["description"]
    assert told.startswith(f"Shapes, written by thermicon; {EXPERIMENTAL}; convention: amplitude (-1 to 1) x gain")
    assert "change in K from the baseline of 31.5 degC" in told
    assert re.search(r"; corner times rounded to the nearest 1/48000 s, by (8|9|10)\.\d us at most; ", told)
    assert "steps take one tick of 1/48000 s" in told
    assert "ending away from baseline, to which one tick leads back: away" in told
    assert "with 10 s of baseline between: ramps at 0 s, away at 13.2" in told
    channel = document["perceptions"][0]["channels"][0]
    assert channel["description"] == "temperature of the display, thenar: amplitude x gain = K from 31.5 degC"
    assert [each["description"] for each in document["perceptions"]] == ["ramps", "away", "steps", "wave", "still"]
    assert "experimental" in (to_hjif.__doc__ or "")


def test_the_date_can_be_given() -> None:
    icons = load_library("cooling-step-skin")
    when = datetime(2025, 1, 14, 12, 31, 10, 5, UTC)
    text = to_hjif(icons, when)
    assert json.loads(text)["date"] == "2025-01-14T12:31:10+00:00"
    assert to_hjif(icons, when) == text
    assert json.loads(text)["perceptions"][0]["channels"][0]["description"].startswith(
        "temperature of the skin surface"
    )


def test_what_hjif_cannot_take() -> None:
    amps = parse("cue 1; set { control current; baseline 32 °C }; icon a { to 1 A at 1 A/s; return over 1 s }")
    with pytest.raises(
        HjifError, match=r"icon a prescribes a current in A, HJIF has no such perception; write the set with"
    ):
        to_hjif(amps)
    with pytest.raises(
        HjifError, match=r'icon a has no baseline, .*; say it in the set block, such as "baseline 32 °C"'
    ):
        to_hjif(parse("cue 1; icon a { hold for 1 s }"))
    with pytest.raises(HjifError, match="there is no icon to write"):
        to_hjif([])


def test_only_the_icons_that_were_asked_for_are_written() -> None:
    dip = "icon a { cool by 6 °C at 3 °C/s; return at 3 °C/s }"
    icons = parse(f"cue 1; set {{ baseline 32 °C }}\n{dip}\nicon both {{ play a; rest for 1 s; play a }}")
    (one,) = json.loads(to_hjif([icons["both"]]))["perceptions"]
    assert one["description"] == "both"
    keyframes = one["channels"][0]["bands"][0]["effects"][0]["keyframes"]
    assert sum(frame["amplitude_modulation"] == -1 for frame in keyframes) == 2

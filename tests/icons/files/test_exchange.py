"""Sets as JSON: nothing is lost, the schema is the published one, and what is wrong is told at its place."""

import json
from importlib import resources
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from tests.icons.files.test_exchange_errors import error, with_body
from thermicon.icons import (
    Context,
    CueErrors,
    Family,
    Icon,
    IconSet,
    Metadata,
    library_names,
    load_library,
    parse,
    read_cue,
)
from thermicon.icons.files.exchange import from_json, to_json
from thermicon.icons.files.json_schema import LIMITS, schema_text
from thermicon.icons.model.parameter import Parameter
from thermicon.icons.model.shapes import Pulse, Step, Wave
from thermicon.icons.model.slots import Slot
from thermicon.icons.model.statements import Current, Hold, Play, Ramp, Repeat, Rest, Return, Statement, Total
from thermicon.icons.model.value_limits import fault

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
def test_shipped_sets_come_back_and_are_valid(name: str) -> None:
    icons = load_library(name)
    text = to_json(icons)
    assert from_json(text) == icons
    assert not list(VALID.iter_errors(json.loads(text)))


@pytest.mark.parametrize("text", [EVERYTHING, AMPS], ids=["temperature", "current"])
def test_every_kind_of_statement_comes_back(text: str) -> None:
    icons = parse(text)
    made = to_json(icons)
    again = from_json(made.encode())
    assert again == icons
    assert str(again) == str(icons)
    assert again.content_hash == icons.content_hash
    assert to_json(again) == made
    assert not list(VALID.iter_errors(json.loads(made)))


def test_a_statement_reads_like_one() -> None:
    lines = [line.strip().rstrip(",") for line in to_json(parse(EVERYTHING)).splitlines()]
    for line in (
        '{"do": "warm", "by_K": 1, "rate_K_per_s": 0.016666666666666666}',
        '{"do": "cool", "to_C": 31, "duration_s": 60}',
        '{"do": "step", "direction": "cool", "by_K": 3}',
        '{"do": "square", "by_K": 1, "period_s": 1, "duration_s": 1.5, "start": "cool", "cut": true}',
        '{"do": "play", "icon": "ramp_amount=-3_rate=1.5_pause=200_times=2"}',
        '{"do": "total", "duration_s": 200, "bound": "at most"}',
        '{"do": "change", "by_K": {"parameter": "amount"}, "rate_K_per_s": {"parameter": "rate"}}',
        '{"name": "rate", "unit": "°C/s", "low": 1, "high": 3, "step": 0.5}',
    ):
        assert line in lines
    assert '"baseline_C": 32.5' in lines


def test_the_published_schema_is_the_one_of_the_models() -> None:
    path = resources.files("thermicon.icons").joinpath("data/cue.schema.json")
    assert path.read_text(encoding="utf-8") == schema_text()
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    Draft202012Validator.check_schema(SCHEMA)
    assert "null" not in schema_text()


def test_the_schema_has_the_limits_of_the_language() -> None:
    for kind, limits in LIMITS.items():
        one = Draft202012Validator(limits)
        for value in (-1e10, -71.0, -70.0, -21.0, -20.0, -11.0, -10.0, -1.0, 0.0, 1e-7, 1e-6, 1.0, 20.0, 21.0, 60.0):
            assert one.is_valid(value) == (fault(value, kind) is None), (kind, value)
        for value in (61.0, 70.0, 71.0, 3600.0, 3601.0, 1e9, 2e9):
            assert one.is_valid(value) == (fault(value, kind) is None), (kind, value)


@pytest.mark.parametrize(
    "change",
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
def test_the_schema_refuses_what_the_reader_refuses(change: str) -> None:
    assert error(with_body(change))
    assert not VALID.is_valid(json.loads(with_body(change)))


def test_read_cue_takes_json_files(tmp_path: Any) -> None:
    path = tmp_path / "six.JSON"
    path.write_text(to_json(load_library("six-icons")), encoding="utf-8")
    assert read_cue(path) == load_library("six-icons")
    path.write_bytes(b"{")
    with pytest.raises(CueErrors, match=r"six\.JSON:1:2  E011 not valid JSON"):
        read_cue(path)
    path.write_bytes(b" " * 1_000_001)
    with pytest.raises(CueErrors, match="E004 file too large"):
        read_cue(path)


TIMES = st.one_of(st.floats(1e-5, 50), st.integers(1, 999).map(lambda n: n / 1000))
SIZES = st.floats(1e-3, 2)
TEXTS = st.text(st.characters(exclude_categories=("Cc", "Cs"), include_characters='"\\\n\t'), min_size=1).filter(
    str.strip
)


@st.composite
def bodies(draw: Any, depth: int = 2) -> tuple[Statement, ...]:
    """Statements of every kind, each group back at baseline."""
    parts: list[Statement] = []
    for _ in range(draw(st.integers(1, 4))):
        size, time = draw(SIZES), draw(TIMES)
        parts += draw(
            st.sampled_from(
                [
                    (Hold(time),),
                    (Rest(time),),
                    (Ramp("cool", by_K=size, rate_K_per_s=draw(SIZES)), Return(draw(SIZES))),
                    (Ramp("change", to_C=33 + size, duration_s=time), Return(duration_s=time)),
                    (Step("change", by_K=-size), Hold(time), Step("warm", to_C=34), Return(duration_s=time)),
                    (Pulse("warm", by_K=size, duration_s=time), Pulse("change", by_K=-size, duration_s=time)),
                    (Wave("sine", by_K=size, period_s=time, duration_s=time, start="cool"),),
                    (Wave("square", by_K=size, period_s=time, duration_s=time),),
                    (Wave("sawtooth", by_K=size, period_s=1, duration_s=time, cut=True), Hold(1)),
                    (Total(time, "at least"),),
                ]
            )
        )
    if depth and draw(st.booleans()):
        inner = tuple(part for part in draw(bodies(depth - 1)) if not isinstance(part, Total))
        parts += [Repeat(draw(st.integers(1, 3)), inner)] if inner else []
    return tuple(parts)


@st.composite
def sets(draw: Any) -> IconSet:
    context = Context(
        draw(st.sampled_from(["skin", "display"])), draw(st.none() | st.just(32.5)), draw(st.none() | st.just("arm"))
    )
    metadata = st.builds(
        Metadata, means=st.none() | TEXTS, by=st.none() | TEXTS, tags=st.sampled_from([(), ("a", "b c"), ("a", "a")])
    )
    try:
        first = Icon("first", draw(bodies()), context, draw(metadata))
        second = Icon("second", (*draw(bodies(0)), Hold(1), Return(1)), context) if draw(st.booleans()) else None
        parts = [first, *([second] if second else [])]
        if not any(isinstance(part, Total) for part in first.statements):
            parts.append(Icon("third", (Play(first), Hold(1)), context, draw(metadata)))
        parameter = Parameter("x", "s", draw(st.lists(TIMES, min_size=1, max_size=3, unique=True)))
        body = (Repeat(2, (Hold(parameter.si(0, "time")),)),)
        parts.append(Family("f", (parameter,), body, (Slot((0, 0), "duration_s", "time", "x"),), context))  # type: ignore[arg-type]
        title = draw(st.just("") | TEXTS)
        return IconSet(
            draw(st.sampled_from(["", "é-1"])), title, context, draw(metadata), tuple(draw(st.permutations(parts)))
        )
    except CueErrors:
        assume(False)
        raise


@settings(max_examples=60, deadline=None)
@given(sets())
def test_any_set_comes_back_equal(icons: IconSet) -> None:
    text = to_json(icons)
    assert from_json(text) == icons
    assert not list(VALID.iter_errors(json.loads(text)))


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.floats()
    | st.integers()
    | st.text(st.characters(), max_size=5)
    | st.sampled_from(["cool", "a"]),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.text(st.characters(), max_size=4)
            | st.sampled_from(["do", "by_K", "to_C", "duration_s", "parameter", "statements", "count"]),
            inner,
            max_size=4,
        )
    ),
    max_leaves=12,
)


@settings(max_examples=150, deadline=None)
@given(st.text() | VALUES.map(json.dumps) | st.binary())
def test_garbage_raises_nothing_else(text: str | bytes) -> None:
    with pytest.raises(CueErrors, match=r"E\d\d\d "):
        from_json(text)


GOOD = json.loads(to_json(parse(EVERYTHING)))


@settings(max_examples=120, deadline=None)
@given(st.data())
def test_a_damaged_set_raises_nothing_else(data: st.DataObject) -> None:
    document = json.loads(json.dumps(GOOD))
    for _ in range(data.draw(st.integers(1, 3))):
        here: Any = document
        while True:
            keys = list(here) if isinstance(here, dict) else list(range(len(here)))
            if not keys:
                break
            key = data.draw(st.sampled_from(keys))
            if not isinstance(here[key], (dict, list)) or data.draw(st.integers(0, 3)) == 0:
                if data.draw(st.booleans()) and isinstance(here, dict):
                    here[data.draw(st.sampled_from(["do", "by_K", "x", "statements", "name"]))] = here.pop(key)
                else:
                    here[key] = data.draw(VALUES)
                break
            here = here[key]
    try:
        icons = from_json(json.dumps(document), "a.json")
    except CueErrors as found:
        assert str(found).startswith("a.json")
    else:
        assert from_json(to_json(icons)) == icons


def test_drives_in_python() -> None:
    context = Context("current", None, "arm")
    icon = Icon("a", (Current(0.5, rate_A_per_s=1), Step(by_A=-0.1), Pulse(by_A=0.1, duration_s=1), Return(2)), context)
    icons = IconSet("", "", context, Metadata(), (icon,))
    assert from_json(to_json(icons)) == icons

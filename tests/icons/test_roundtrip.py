"""Whatever can be built can be written and read back, equal to the last digit."""

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from thermicon.icons import (
    Change,
    CueErrors,
    Drive,
    Frame,
    Hold,
    Icon,
    IconSet,
    Metadata,
    Repeat,
    Rest,
    Return,
    Statement,
    parse,
)
from thermicon.icons.units import exact, quantity, to_si

TIMES = st.one_of(st.floats(1e-6, 50), st.integers(1, 999).map(lambda n: n / 1000), st.integers(1, 50).map(float))
RATES = st.one_of(
    st.floats(0.01, 100), st.integers(1, 600).map(lambda n: n / 60), st.integers(1, 50).map(lambda n: n / 10)
)
STEPS = st.one_of(st.floats(1e-3, 3), st.integers(1, 30).map(lambda n: n / 10))
TEXTS = st.text(st.characters(exclude_categories=("Cc", "Cs"), include_characters='"\\\n\t'), min_size=1).filter(
    str.strip
)
TAGS = TEXTS.map(lambda text: text.replace(",", " ").strip()).filter(bool)
NAMES = st.from_regex(r"[a-zé][a-z0-9é-]{0,12}", fullmatch=True)


def pace(rate: str) -> st.SearchStrategy[dict[str, float]]:
    return st.one_of(st.fixed_dictionaries({rate: RATES}), st.fixed_dictionaries({"duration_s": TIMES}))


@st.composite
def bodies(draw: Any, control: str, depth: int = 2) -> tuple[Statement, ...]:
    parts: list[Statement] = []
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(["hold", "dip", "repeat"] if depth else ["hold", "dip"]))
        if kind == "hold":
            parts.append(draw(st.builds(draw(st.sampled_from([Hold, Rest])), TIMES)))
        elif kind == "repeat":
            parts.append(Repeat(draw(st.integers(1, 3)), draw(bodies(control, depth - 1))))
        elif control == "current":
            parts.append(Drive(draw(st.floats(0.1, 2)), **draw(pace("rate_A_per_s"))))
            parts.append(Return(**draw(pace("rate_per_s"))))
        else:
            size = draw(st.sampled_from([{"by_K": draw(STEPS)}, {"to_C": draw(st.floats(33.0, 40.0))}]))
            direction = "warm" if "to_C" in size else draw(st.sampled_from(["warm", "cool"]))
            parts.append(Change(direction, **size, **draw(pace("rate_K_per_s"))))
            parts.append(Hold(draw(TIMES)))
            parts.append(Return(**draw(pace("rate_per_s"))))
    return tuple(parts)


METADATA = st.builds(
    Metadata,
    means=st.none() | TEXTS,
    by=st.none() | TEXTS,
    doi=st.none() | TEXTS,
    licence=st.none() | TEXTS,
    tags=st.lists(TAGS, max_size=3, unique=True).map(tuple),
)


@st.composite
def icons(draw: Any, frame: Frame | None = None, name: str | None = None) -> Icon:
    if frame is None:
        frame = Frame(
            draw(st.sampled_from(["skin", "display", "current"])),
            draw(st.none() | st.floats(28, 32.5)),
            draw(st.none() | NAMES),
        )
    body = draw(bodies(frame.control))
    try:
        return Icon(name or draw(NAMES), body, frame, draw(METADATA))
    except CueErrors:
        assume(False)
        raise


@settings(max_examples=150, deadline=None)
@given(icons())
def test_an_icon_reads_back_equal(icon: Icon) -> None:
    again = parse(str(icon)).icons[0]
    assert again == icon
    assert str(again) == str(icon)
    assert again.lower() == icon.lower()


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_a_set_reads_back_equal(data: st.DataObject) -> None:
    frame = Frame(data.draw(st.sampled_from(["skin", "display"])), data.draw(st.none() | st.floats(28, 32.5)))
    names = data.draw(st.lists(NAMES, min_size=1, max_size=3, unique=True))
    members = tuple(data.draw(icons(frame, name)) for name in names)
    title = data.draw(st.just("") | TEXTS)
    made = IconSet(data.draw(st.just("") | NAMES), title, frame, data.draw(METADATA), members)
    assert parse(str(made)) == made
    assert str(parse(str(made))) == str(made)


@settings(max_examples=300, deadline=None)
@given(st.floats(1e-6, 1e3), st.sampled_from(["time", "rate", "current_rate", "difference"]))
def test_a_number_reads_back_to_the_same_float(value: float, kind: Any) -> None:
    number, unit = quantity(value, kind).split(" ")
    assert to_si(number, unit, kind) == value
    assert abs(exact(value, kind) - Fraction(value)) <= abs(Fraction(value)) / 2**52


@pytest.mark.parametrize(
    ("written", "kept"),
    [
        ("hold for 50 ms", "hold for 0.05 s"),
        ("hold for 0.001 s", "hold for 1 ms"),
        ("hold for 1 min", "hold for 60 s"),
        ("cool by 6 K at 3 degC/s", "cool by 6 °C at 3 °C/s"),
        ("cool by 1 °C at 1 °C/min", "cool by 1 °C at 1 °C/min"),
        ("cool by .5°C over+2s", "cool by 0.5 °C over 2 s"),
        ("cool to 1e1 °C at 10 K/min", "cool to 10 °C at 10 °C/min"),
        ("cool by 0.50 °C at 30 K/min", "cool by 0.5 °C at 0.5 °C/s"),
    ],
)
def test_the_canonical_spelling(written: str, kept: str) -> None:
    assert str(parse(f"cue 1; icon x {{ {written} }}")) == f"cue 1\n\nicon x {{\n  {kept}\n}}\n"


def test_a_header_may_take_several_lines_and_any_order() -> None:
    text = 'cue 1\nicon x tags "a, b"\n  by "me" # who\n  means "go \\"left\\"\\\\\\n"\n{ hold for 1 s }'
    icon = parse(text).icons[0]
    assert icon.metadata == Metadata(means='go "left"\\\n', by="me", tags=("a", "b"))
    assert parse(str(icon)).icons[0] == icon


def test_words_of_the_language_may_be_names() -> None:
    made = parse("cue 1\nset set { site to; site-2 }\nicon hold { hold for 1 s }".replace("; site-2", ""))
    assert (made.name, made.frame.site, made.icons[0].name) == ("set", "to", "hold")


def test_a_comma_is_a_text_but_no_tag() -> None:
    icon = parse('cue 1\nicon a licence "," { hold for 1 s }').icons[0]
    assert icon.metadata.licence == ","
    with pytest.raises(CueErrors, match="E117 missing text"):
        parse('cue 1\nicon a tags "," { hold for 1 s }')

"""Exact round trips of random models through text."""

from dataclasses import replace
from fractions import Fraction
from typing import Any, get_args

import pytest
from hypothesis import assume
from hypothesis import strategies as st

from tests.builders import messages
from tests.properties import for_any
from thermicon.icons import CueErrors, Family, Icon, IconSet, parse
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.parameter import Parameter, Slot
from thermicon.icons.model.statements import (
    Current,
    Hold,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Shape,
    Statement,
    Step,
    Total,
    Wave,
)
from thermicon.icons.model.units import exact, quantity, to_si

TIMES = st.one_of(st.floats(1e-6, 50), st.integers(1, 999).map(lambda n: n / 1000), st.integers(1, 50).map(float))
RATES = st.one_of(
    st.floats(0.01, 100), st.integers(1, 600).map(lambda n: n / 60), st.integers(1, 50).map(lambda n: n / 10)
)
STEPS = st.one_of(st.floats(1e-3, 3), st.integers(1, 30).map(lambda n: n / 10))
TEXTS = st.text(
    st.characters(exclude_categories=("Cc", "Cf", "Cs", "Zl", "Zp"), include_characters='"\\\n\t'), min_size=1
).filter(str.strip)
TAGS = TEXTS.map(lambda text: text.replace(",", " ").strip()).filter(bool)
NAMES = st.from_regex(r"[a-zé][a-z0-9é-]{0,12}", fullmatch=True)


def pace(rate: str) -> st.SearchStrategy[dict[str, float]]:
    return st.one_of(st.fixed_dictionaries({rate: RATES}), st.fixed_dictionaries({"duration_s": TIMES}))


@st.composite
def waves(draw: Any, current: bool) -> tuple[Statement, ...]:
    """A wave in whole periods, or a cut one that goes back."""
    period, count = draw(st.integers(1, 40)) / 10, draw(st.integers(1, 3))
    size = {"by_A" if current else "by_K": draw(STEPS)}
    start = draw(st.sampled_from((None, "up", "down") if current else (None, "warm", "cool")))
    shape, cut = draw(st.sampled_from(get_args(Shape))), draw(st.booleans())
    whole = float(Fraction(str(period)) * count)
    wave = Wave(shape, **size, period_s=period, duration_s=draw(TIMES) if cut else whole, start=start, cut=cut)
    return (wave, Return(**draw(pace("rate_per_s")))) if cut else (wave,)


@st.composite
def moves(draw: Any, current: bool) -> tuple[Statement, ...]:
    """A statement that leads away from baseline and one that leads back."""
    away: list[Statement]
    if current:
        away = [Step(by_A=-0.5), Step(to_A=draw(STEPS)), Current(draw(st.floats(0.1, 2)), **draw(pace("rate_A_per_s")))]
    else:
        size, target, how = draw(STEPS), draw(st.floats(33.0, 40.0)), draw(pace("rate_K_per_s"))
        away = [Ramp("change", by_K=-size, **how), Step("change", by_K=size)]
        for way in ("warm", "cool"):
            away += [Ramp(way, by_K=size, **how), Step(way, by_K=size)]
        for way in ("warm", "change"):
            away += [Ramp(way, to_C=target, **how), Step(way, to_C=target)]
    return draw(st.sampled_from(away)), Hold(draw(TIMES)), Return(**draw(pace("rate_per_s")))


@st.composite
def bodies(draw: Any, control: str, depth: int = 2, known: tuple[Icon, ...] = ()) -> tuple[Statement, ...]:
    parts: list[Statement] = []
    current = control == "current"
    kinds = ["hold", "move", "pulse", "wave", *["repeat"] * (depth > 0), *["play"] * bool(known)]
    for kind in draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=3)):
        if kind == "hold":
            parts.append(draw(st.builds(draw(st.sampled_from([Hold, Rest])), TIMES)))
        elif kind == "repeat":
            parts.append(Repeat(draw(st.integers(1, 3)), draw(bodies(control, depth - 1, known))))
        elif kind == "play":
            parts.append(Play(draw(st.sampled_from(known))))
        elif kind == "pulse":
            size = draw(STEPS) * draw(st.sampled_from([-1, 1]))
            pulse = Pulse(**{"by_A" if current else "by_K": size}, duration_s=draw(TIMES))
            parts.append(pulse if current else draw(st.sampled_from([pulse, Pulse("cool", by_K=1, duration_s=1)])))
        else:
            parts += draw(moves(current) if kind == "move" else waves(current))
    if depth == 2 and draw(st.booleans()):
        parts.append(draw(st.sampled_from([Total(3600, "at most"), Total(1e-6, "at least")])))
    return tuple(parts)


METADATA = st.builds(
    Metadata,
    means=st.none() | TEXTS,
    by=st.none() | TEXTS,
    doi=st.none() | TEXTS,
    licence=st.none() | TEXTS,
    tags=st.lists(TAGS, max_size=3, unique=True).map(tuple),
)


CONTEXTS = st.builds(
    Context, st.sampled_from(["skin", "display", "current"]), st.none() | st.floats(28, 32.5), st.none() | NAMES
)


@st.composite
def icons(draw: Any, context: Context | None = None, name: str | None = None, known: tuple[Icon, ...] = ()) -> Icon:
    context = draw(CONTEXTS) if context is None else context
    body = draw(bodies(context.control, known=known))
    try:
        return Icon(name or draw(NAMES), body, context, draw(METADATA))
    except CueErrors:
        assume(False)
        raise


TEMPLATE = (
    Ramp("warm", by_K=1, rate_K_per_s=1),
    Hold(1),
    Return(1),
    Repeat(2, (Pulse(by_K=-1, duration_s=1), Ramp("change", to_C=36, duration_s=1), Return(duration_s=1))),
    Wave("sawtooth", by_K=1, period_s=1, duration_s=4, start="cool", cut=True),
    Step("cool", by_K=1),
    Step(to_C=40),
    Total(3600, "at most"),
)
SLOTS = {
    "size": [((0,), "by_K", "difference"), ((4,), "by_K", "difference"), ((5,), "by_K", "difference")],
    "speed": [((0,), "rate_K_per_s", "rate"), ((2,), "rate_per_s", "rate")],
    "time": [((1,), "duration_s", "time"), ((3, 0), "duration_s", "time"), ((4,), "period_s", "time")],
    "count": [((3,), "count", "count")],
    "step": [((3, 0), "by_K", "change")],
    "target": [((3, 1), "to_C", "absolute"), ((6,), "to_C", "absolute")],
}
KINDS = {
    "size": (st.floats(0.01, 3), ["K", "°C", "degC"]),
    "speed": (st.floats(0.05, 90), ["K/s", "°C/s", "°C/min"]),
    "time": (st.floats(0.01, 50), ["s", "ms", "min"]),
    "count": (st.integers(1, 9).map(float), [""]),
    "step": (st.floats(0.01, 5) | st.floats(-5, -0.01), ["K"]),
    "target": (st.floats(36, 45), ["°C"]),
}


@st.composite
def families(draw: Any, context: Context | None = None, name: str | None = None) -> Family:
    """A family of one template, in which some of the numbers vary."""
    context = draw(CONTEXTS.filter(lambda made: made.control != "current")) if context is None else context
    parameters, slots, template = [], [], TEMPLATE
    for each in draw(st.lists(st.sampled_from(list(SLOTS)), min_size=1, max_size=3, unique=True)):
        values, units = KINDS[each]
        span = draw(st.none() | st.sampled_from([(1.0, 3.0, 0.5), (1.0, 3.0, 1.0)]))
        if span is None or each in ("count", "target"):
            listed = tuple(draw(st.lists(values, min_size=1, max_size=3, unique=True)))
            own = Parameter(f"{each}-é", draw(st.sampled_from(units)), listed)
        else:
            own = Parameter(f"{each}-é", draw(st.sampled_from(units)), span=span)
        parameters.append(own)
        for path, field, kind in draw(st.lists(st.sampled_from(SLOTS[each]), min_size=1, unique=True)):
            slots.append(Slot(path, field, kind, own.name))
            value = own.si(0, kind)
            template = changed(template, path, field, int(value) if kind == "count" else value)
    metadata = draw(METADATA)
    hole = draw(st.sampled_from(["", f" {{{parameters[0].name}}} ", "{ }"]))
    metadata = replace(metadata, means="x" + (metadata.means or "").replace("{", "") + hole)
    try:
        return Family(
            name or draw(NAMES), tuple(parameters), template, tuple(draw(st.permutations(slots))), context, metadata
        )
    except CueErrors:
        assume(False)
        raise


def changed(body: tuple[Any, ...], path: tuple[int, ...], field: str, value: float) -> tuple[Any, ...]:
    """A body with another value in a field of the statement at a path."""
    first, *more = path
    inner = {"body": changed(body[first].body, tuple(more), field, value)} if more else {field: value}
    return (*body[:first], replace(body[first], **inner), *body[first + 1 :])


@st.composite
def sets(draw: Any) -> IconSet:
    """A set of icons that play each other, and families."""
    context = draw(CONTEXTS.filter(lambda made: made.control != "current"))
    names = draw(st.lists(NAMES, min_size=1, max_size=4, unique=True))
    entries: list[Icon | Family] = []
    for name in names:
        known = tuple(entry[0] if isinstance(entry, Family) else entry for entry in entries)
        entries.append(draw(st.one_of(icons(context, name, known), families(context, name))))
    return IconSet(draw(st.just("") | NAMES), draw(st.just("") | TEXTS), context, draw(METADATA), tuple(entries))


@for_any(icons(), examples=200)
def test_an_icon_reads_back_equal(icon: Icon) -> None:
    again = parse(str(icon)).icons[0]
    assert again == icon
    assert str(again) == str(icon)
    assert again.corners() == icon.corners()
    assert again.content_hash == icon.content_hash
    assert repr(icon).startswith(f"<Icon {icon.name}: ")
    assert "\n" not in repr(icon)


@for_any(families(), examples=100)
def test_a_family_and_its_members_read_back_equal(family: Family) -> None:
    (again,) = parse(str(family)).entries
    assert again == family
    assert str(again) == str(family)
    assert list(again) == list(family)
    assert "\n" not in repr(family)
    for member in family.sample(2):
        assert parse(str(member)).entries == (member,)
        assert Icon(member.name, member.statements, member.context, member.metadata) == member
        assert member in family
        assert family.find(member.name) == member


@for_any(sets(), examples=80)
def test_a_set_reads_back_equal(made: IconSet) -> None:
    again = parse(str(made))
    assert again == made
    assert str(again) == str(made)
    assert again.content_hash == made.content_hash
    assert "\n" not in repr(made)
    for entry in made.entries:  # each stands alone, after those that it plays
        assert parse(str(entry)).entries[-1] == entry


@for_any(st.floats(1e-6, 1e3), st.sampled_from(["time", "rate", "current_rate", "difference"]), examples=300)
def test_a_number_reads_back_to_the_same_float(value: float, kind: Any) -> None:
    number, unit = quantity(value, kind).split(" ")
    assert to_si(number, unit, kind) == value
    assert abs(exact(value, kind) - Fraction(value)) <= abs(Fraction(value)) / 2**52


CANONICAL = messages(__file__, "cases.toml")["canonical"]


@pytest.mark.parametrize("written", CANONICAL)
def test_the_canonical_spelling(written: str) -> None:
    assert str(parse(f"cue 1; icon x {{ {written} }}")) == f"cue 1\n\nicon x {{\n  {CANONICAL[written]}\n}}\n"


def test_a_header_may_take_several_lines_and_any_order() -> None:
    text = 'cue 1\nicon x tags "a, b"\n  by "me" # who\n  means "go \\"left\\"\\\\\\n" licence ","\n{ hold for 1 s }'
    icon = parse(text).icons[0]
    assert icon.metadata == Metadata(means='go "left"\\\n', by="me", licence=",", tags=("a", "b"))
    assert parse(str(icon)).icons[0] == icon
    with pytest.raises(CueErrors, match="E117 missing text"):
        parse('cue 1\nicon a tags "," { hold for 1 s }')

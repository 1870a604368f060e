"""A family as a lazy sequence of checked icons."""

import pytest

from tests.builders import messages
from thermicon.icons import CueErrors, Family, Icon, IconSet, back, cool, parse, pulse, repeat, step
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.parameter import Parameter, Slot
from thermicon.icons.model.statements import Hold

TEXT = """cue 1
set lot { baseline 32 °C }
icon first { hold for 1 s }
icon ramp(amount in [-6, -3, 3, 6] °C, rate in 1..3 step 0.5 °C/s) means "ramp {amount} at {rate}" tags "a, b" {
  change by amount at rate
  return at rate
}
icon last { play ramp_amount=3_rate=1.5; hold for 1 s }
"""
SET = parse(TEXT)
RAMP = SET.families[0]
AMPERES, AMPERES_PER_S = Slot((0,), "by_A", "current", "a"), Slot((1,), "rate_per_s", "current_rate", "a")


def family(
    values: tuple[float, ...] = (1, 2),
    unit: str = "K",
    name: str = "f",
    slots: tuple[Slot, ...] = (Slot((0,), "by_K", "difference", "a"),),
    template: tuple[object, ...] = (cool(by=1, at=1),),
    means: str | None = None,
    control: str = "skin",
    parameters: tuple[Parameter, ...] | None = None,
) -> Family:
    own = (Parameter("a", unit, values),) if parameters is None else parameters
    return Family(name, own, template, slots, Context(control), Metadata(means=means))  # type: ignore[arg-type]


def test_it_is_a_sequence() -> None:
    assert len(RAMP) == 20
    assert [icon.name for icon in RAMP] == [RAMP[n].name for n in range(20)]
    expected = [f"ramp_amount={amount}_rate={rate}" for amount in (-6, -3, 3, 6) for rate in (1, 1.5, 2, 2.5, 3)]
    assert [icon.name for icon in RAMP] == expected, "the last parameter runs fastest"
    assert RAMP[-1] == RAMP[19] == list(RAMP)[-1]
    assert RAMP[3] in RAMP and "ramp_amount=6_rate=2.5" in RAMP
    for other in ("ramp_amount=6_rate=2.6", Icon("ramp_amount=6_rate=1", (Hold(1),), RAMP.context), 3):
        assert other not in RAMP
    for index in (20, -21):
        with pytest.raises(IndexError, match=f"family ramp has 20 members, so there is none at {index}"):
            RAMP[index]


def test_members_are_whole_icons() -> None:
    member = RAMP[6]
    assert member.name == "ramp_amount=-3_rate=1.5"
    assert member.metadata == Metadata(means="ramp -3 °C at 1.5 °C/s", tags=("a", "b"))
    assert member.corners().value == (32.0, 29.0, 32.0)
    assert Icon(member.name, member.statements, member.context, member.metadata) == member
    assert hash(RAMP[6]) == hash(member)


def test_members_are_found_by_name_and_by_values() -> None:
    assert RAMP.find("ramp_amount=6_rate=3") == RAMP[-1]
    for name in ("ramp", "ramp_amount=6", "ramp_rate=3_amount=6", "ramp_amount=6_rate=3.0", "ramp_amount=x_rate=1"):
        assert RAMP.find(name) is None
    assert RAMP.member({"amount": 6, "rate": 3}) == RAMP[-1]
    with pytest.raises(ValueError, match=r"family ramp: rate = 4 is not in rate in 1\.\.3 step 0\.5 °C/s"):
        RAMP.member({"amount": 6, "rate": 4})
    with pytest.raises(ValueError, match="rate = None is not in"):
        RAMP.member({"amount": 6})


def test_a_sample_is_seeded_and_has_no_member_twice() -> None:
    drawn = RAMP.sample(7, seed=3)
    assert drawn == RAMP.sample(7, seed=3)
    assert drawn != RAMP.sample(7, seed=4)
    assert len(set(drawn)) == 7
    assert [icon.name for icon in RAMP if icon in drawn] == [icon.name for icon in drawn]
    assert RAMP.sample(99) == tuple(RAMP)


def test_a_set_counts_and_slices_members() -> None:
    assert len(SET) == len(SET.icons) == 22
    names = [icon.name for icon in SET]
    assert [icon.name for icon in (*SET.icons[:2], *SET.icons[-2:], SET.icons[-1])] == [*names[:2], *names[-2:], "last"]
    assert SET.icons[::7] == tuple(list(SET)[::7])
    assert SET["ramp_amount=-6_rate=1"] == RAMP[0] and RAMP in SET and RAMP[5] in SET
    assert repr(SET) == "<IconSet lot: 22 icons, 1 to 12 s, control skin, baseline 32 °C>"
    for index in (22, -23):
        with pytest.raises(IndexError, match=f"no icon at {index}: the set has 22"):
            SET.icons[index]
    with pytest.raises(KeyError, match=r"called 0; by place, ask .icons\[0\]; the set has: .*ramp_amount=-6_rate=1, …"):
        _ = SET[0]
    with pytest.raises(KeyError, match="ramp is a family of 20, with members such as ramp_amount=-6_rate=1"):
        SET["ramp"]


@pytest.mark.slow
def test_a_family_ends_at_a_hundred_thousand_members() -> None:
    text = "cue 1; icon x(a in 0.01..10 step 0.01 K, b in 0.1..LAST step 0.1 s) { pulse by a for b }"
    many = parse(text.replace("LAST", "1"))
    assert len(many) == 10_000
    assert many.icons[-1].name == "x_a=10_b=1"
    assert many.families[0].summary().highest == 42.0
    with pytest.raises(CueErrors, match=r"E231(?s:.)*has 101,000 members(?s:.)*at most 100,000: take larger steps"):
        parse(text.replace("LAST", "10.1"))


def test_names_stay_short_decimals() -> None:
    own = Parameter("a", "s", span=(0.1, 1.2, 0.1))
    texts = " ".join(map(own.text, range(len(own))))
    assert texts == "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1 1.1 1.2"
    assert [own.si(n, "time") for n in range(3)] == [0.1, 0.2, 0.3]
    assert [Parameter("a", "ms", (1, 1e-5)).text(place) for place in (0, 1)] == ["1", "1e-5"]
    assert Parameter("a", "degC/s", (1,)) == Parameter("a", "°C/s", (1,))


def test_a_family_of_python_is_that_of_the_text() -> None:
    size, count = Parameter("size", "K", (1, 2)), Parameter("n", "", span=(1, 3, 1))
    slots = (Slot((0, 0), "by_K", "change", "size"), Slot((0,), "count", "count", "n"))
    made = Family("f", (size, count), (repeat(1, pulse(by=1, duration=1)), Hold(1)), slots)
    text = "cue 1; icon f(size in [1, 2] K, n in 1..3 step 1) { repeat n { pulse by size for 1 s }; hold for 1 s }"
    assert made == parse(text).families[0]


def test_a_start_that_a_member_cannot_take_is_told() -> None:
    text = "cue 1; icon x(a in [26, 30] °C) { cool to a at 1 K/s }"
    assert parse(text).families[0].summary(31).highest == 31.0
    with pytest.raises(CueErrors, match=r"<icon x_a=30>(?s:.)*E201 (?s:.)*30 °C is above the 28 °C"):
        parse(text).summary(28)


MESSAGES = messages(__file__)


@pytest.mark.parametrize("made", MESSAGES["family"])
def test_what_cannot_be_is_refused(made: str) -> None:
    with pytest.raises(ValueError, match=MESSAGES["family"][made]):
        eval(made, globals() | {"IconSet": IconSet, "back": back, "step": step})

"""Icons on several elements: one ordinary icon for each element that plays, on one clock."""

import json
import pickle
from typing import Any

import pytest
from hypothesis import strategies as st

from tests.icons.files.test_exchange import VALID
from tests.icons.model.test_roundtrip import METADATA, NAMES, bodies
from tests.properties import for_any
from thermicon.icons import CueErrors, Icon, IconSet, SpatialIcon, format_text, parse, to_json
from thermicon.icons.files.shipped import by_name, set_of
from thermicon.icons.model.context import Context, elements_fault
from thermicon.icons.model.iconset import SeveralElements
from thermicon.icons.model.spatial import Along, On, Together, bodies_of
from thermicon.icons.model.statements import Hold, Ramp, Rest, Return

DIP = "cool by 4 °C at 2 °C/s; return at 2 °C/s"
GLOW = "warm by 3 °C at 3 °C/s; hold for 2 s; return at 3 °C/s"
FIVE = "s1, s2, s3, s4, s5"
TWO = Context(elements=("left", "right"))
LONG = On(("left",), (Ramp("cool", by_K=10, rate_K_per_s=3), Return(3)))


def spatial(body: str, elements: str = "left, right") -> SpatialIcon:
    (icon,) = parse(f"cue 1\nset {{ elements {elements} }}\nicon x {{\n{body}\n}}").spatial
    return icon


def times(icon: SpatialIcon) -> dict[str, tuple[float, ...]]:
    return {name: track.corners().time_s for name, track in icon.tracks.items()}


def test_an_element_rests_until_it_plays_and_who_never_plays_has_no_track() -> None:
    icon = spatial(f"on left {{ {DIP} }}\non right {{ {GLOW} }}\non left {{ {DIP} }}", "left, right, back")
    assert times(icon) == {"left": (0, 2, 4, 8, 10, 12), "right": (0, 4, 5, 7, 8)}
    assert icon.duration_s == 12
    assert {track.context for track in icon.tracks.values()} == {Context()}


def test_together_lasts_as_long_as_its_longest() -> None:
    icon = spatial(f"together {{ on left {{ {DIP}; {DIP} }}; on right {{ {GLOW} }} }}\non right {{ {DIP} }}")
    assert times(icon) == {"left": (0, 2, 4, 6, 8), "right": (0, 1, 3, 4, 8, 10, 12)}


@pytest.mark.parametrize(
    ("names", "order"),
    [("s2..s4", "s2 s3 s4"), ("s4..s2", "s4 s3 s2"), ("s5, s1..s2", "s5 s1 s2"), ("all", "s1 s2 s3 s4 s5")],
)
def test_along_begins_each_element_one_step_after_the_one_before(names: str, order: str) -> None:
    icon = spatial(f"along {names} every 300 ms {{ {DIP} }}\non s1 {{ {DIP} }}", FIVE)
    count = len(order.split())
    begins = {name: at[1] if len(at) == 4 else 0.0 for name, at in times(icon).items() if name != "s1"}
    assert begins == {name: pytest.approx(0.3 * place) for place, name in enumerate(order.split()) if name != "s1"}
    assert icon.duration_s == pytest.approx(0.3 * (count - 1) + 4 + 4)


def test_elements_that_play_alike_share_one_track() -> None:
    icon = spatial(f"on all {{ {DIP} }}", FIVE)
    assert len({id(track) for track in icon.tracks.values()}) == 1
    assert icon.tracks["s3"].statements == parse(f"cue 1; icon x {{ {DIP} }}")["x"].statements


def test_lengths_that_differ_by_rounding_leave_no_rest() -> None:
    """Ten thirds of a second, and the same as six digits."""
    near = On(("right",), (Ramp("cool", by_K=10, duration_s=3.3333333), Return(3)))
    icon = SpatialIcon("x", (Together((LONG, near)), On(("right",), (Hold(1),))), TWO)
    assert [type(part).__name__ for part in icon.tracks["right"].statements] == ["Ramp", "Return", "Hold"]
    later = SpatialIcon("x", (LONG, near), TWO)
    assert later.tracks["right"].corners().time_s[1] == pytest.approx(20 / 3, abs=1e-9)


def test_the_order_of_names_says_nothing_in_on_but_all_in_along() -> None:
    assert spatial(f"on right, left {{ {DIP} }}") == spatial(f"on all {{ {DIP} }}")
    swapped = spatial(f"along right, left every 1 s {{ {DIP} }}")
    assert swapped != spatial(f"along all every 1 s {{ {DIP} }}")
    assert times(swapped)["left"][1] == 1


def test_words_of_the_blocks_stay_names_of_icons_families_and_parameters() -> None:
    text = """cue 1
        icon all { hold for 1 s }
        icon on-off { play all; play along_on=2 }
        icon along(on in 1..2 step 1 s) { hold for on }
        icon on { play on-off }
        icon together { play on }
        icon elements { rest for 1 s }
    """
    icons = parse(text)
    assert [icon.name for icon in icons] == ["all", "on-off", "along_on=1", "along_on=2", "on", "together", "elements"]
    assert parse(str(icons)) == icons
    named = parse(f"cue 1\nset all {{ elements on, along }}\nicon all {{ on on {{ {DIP} }}; on along {{ {DIP} }} }}")
    assert list(named.spatial[0].tracks) == ["on", "along"]
    assert parse(str(named)) == named


@st.composite
def spatial_sets(draw: Any) -> IconSet:
    names = tuple(draw(st.lists(NAMES.filter("all".__ne__), min_size=2, max_size=4, unique=True)))
    context = Context(draw(st.sampled_from(["skin", "display"])), 32.0, None, names)

    def body() -> Any:
        made = draw(bodies(context.control, known=()))
        return tuple(part for part in made if type(part).__name__ != "Total")

    def block(chosen: tuple[str, ...]) -> On | Along:
        if len(chosen) > 1 and draw(st.booleans()):
            return Along(chosen, draw(st.sampled_from([0.1, 0.3, 1.0])), body())
        return On(tuple(name for name in names if name in chosen), body())

    parts: list[On | Along | Together] = []
    for _ in range(draw(st.integers(1, 3))):
        order = tuple(draw(st.permutations(names)))
        cut = draw(st.integers(1, len(order) - 1))
        parts.append(Together((block(order[:cut]), block(order[cut:]))) if draw(st.booleans()) else block(order[:cut]))
    icon = SpatialIcon(draw(NAMES), tuple(parts), context, draw(METADATA))
    return IconSet.of(icon, draw(NAMES))


@for_any(spatial_sets(), examples=60)
def test_text_and_json_say_all_of_an_icon_and_nothing_is_lost_or_doubled(icons: IconSet) -> None:
    (icon,) = icons.spatial
    assert parse(str(icons)) == icons
    assert format_text(str(icons)) == str(icons)
    assert not list(VALID.iter_errors(json.loads(to_json(icons))))
    assert pickle.loads(pickle.dumps(icon)) == icon
    for name, track in icon.tracks.items():
        expected = [part for body in bodies_of(icon.parts) if name in body.names for part in body.body]
        for part in track.statements:
            if expected and part == expected[0]:
                expected.pop(0)
            else:
                assert isinstance(part, Rest), "nothing but waiting is added"
        assert not expected
    assert max(track.corners().duration_s for track in icon.tracks.values()) == pytest.approx(icon.duration_s)


def test_renamed_elements_play_the_same() -> None:
    body = f"together {{ on left {{ {DIP} }}; on right {{ {GLOW} }} }}"
    first, second = spatial(body), spatial(body.replace("left", "a").replace("right", "b"), "b, a")
    assert {name: track.statements for name, track in second.tracks.items()} == {
        {"left": "a", "right": "b"}[name]: track.statements for name, track in first.tracks.items()
    }
    assert first.content_hash != second.content_hash


def test_everything_that_plays_one_element_refuses_them_with_a_cure() -> None:
    icon = spatial(f"on left {{ {DIP} }}")
    icons = IconSet.of(icon)
    for take in (set_of, by_name, list, lambda given: given["x"], lambda given: given.icons):
        with pytest.raises(
            SeveralElements, match=r'\(left, right\).*; for one element, leave out "elements" and "on"$'
        ):
            take(icons)
    with pytest.raises(SeveralElements):
        by_name([icon])
    assert len(icons) == 1
    alone = str(icons).replace("  elements left, right\n", "").replace("  on left {\n", "").replace("  }\n", "")
    assert parse(alone)["x"].statements == icon.tracks["left"].statements


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ((), "needs parts"),
        ((On(("thumb",), (Hold(1),)),), "plays on thumb"),
        ((On(("left",), (Ramp("cool", by_K=1, rate_K_per_s=1),)),), "ends away from baseline"),
        ((On(("left",), (Hold(3000),)), On(("right",), (Hold(601),))), "at most one hour"),
    ],
)
def test_a_model_that_cannot_be_played_is_not_made(parts: tuple[On, ...], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        SpatialIcon("x", parts, TWO)
    with pytest.raises(CueErrors, match="E201"):
        SpatialIcon("x", (On(("left",), (Ramp("warm", to_C=20, rate_K_per_s=1),)),), TWO)
    with pytest.raises(ValueError, match="names elements"):
        IconSet("", "", Context(), Icon("a", (Hold(1),)).metadata, (), (SpatialIcon("x", (LONG,), TWO),))


def test_an_icon_of_an_hour_is_the_longest() -> None:
    assert spatial("on left { hold for 3000 s }\non right { hold for 600 s }").duration_s == 3600
    with pytest.raises(CueErrors, match=r"(?s)E221 .*lasts 3600\.5 s"):
        spatial("on left { hold for 3000 s }\non right { hold for 600.5 s }")


def test_a_set_has_two_to_a_hundred_elements() -> None:
    many = [f"e{place}" for place in range(101)]
    assert [elements_fault(many[:count], "skin") is None for count in (1, 2, 100, 101)] == [False, True, True, False]
    with pytest.raises(ValueError, match="no current"):
        Context("current", elements=("a", "b"))
    for wrong in ("left", ("left", "left"), ("left", "all"), ("left", "my hand")):
        with pytest.raises(ValueError, match=r"^elements: "):
            Context(elements=wrong)  # type: ignore[arg-type]


def test_a_set_reports_extremes_over_all_elements_and_its_picture_has_a_row_for_each() -> None:
    icons = parse(f"cue 1\nset {{ elements left, right }}\nicon x {{ on left {{ {DIP} }}; on right {{ {GLOW} }} }}")
    found = icons.summary()
    assert (found.shortest_s, found.longest_s, found.lowest, found.highest, found.steepest_per_s) == (8, 8, 28, 35, 3)
    axes = icons.spatial[0].plot()
    low, high = (label.get_text() for label in axes.get_yticklabels())
    assert (low, high) == ("left", "right")
    rows = [collection.get_paths() for collection in axes.collections]
    levels = [[y for path in row for _, y in path.vertices] for row in rows]
    assert min(levels[0]) > max(levels[1]), "rows do not touch"
    assert max(levels[0]) - min(levels[0]) == pytest.approx(4)
    assert [label.get_text() for label in icons.plot().get_yticklabels()] == ["x: left", "x: right"]

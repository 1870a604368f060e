"""Plots or pictures of icons, with any text in its place."""

import math
import re
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from thermicon.icons import Icon, IconSet, library, load_library, parse
from thermicon.icons.files.shipped import Library
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.statements import Hold
from thermicon.icons.pictures.draw import COOL, STAY, WARM, chosen, evenly

SIX = load_library("six-icons")
SHAPES = parse("""cue 1
icon step { step cool by 6 °C; hold for 2 s; step warm by 6 °C; hold for 1 s }
icon ramp(amount in [-6, -3, 3, 6] °C, rate in [1, 3] °C/s) means "ramp {amount}" {
  change by amount at rate; hold for 2 s; return at rate
}
""")
RAMP = SHAPES.families[0]
HUGE = parse("""cue 1
icon many(a in 1..10 step 1 K, b in 0.5..5 step 0.5 K/s, c in 10..100 step 10 s) {
  cool by a at b; hold for c; return at b
}""")
CURRENT = parse("cue 1\nset { control current }\nicon drive { to 0.5 A at 1 A/s; hold for 2 s; return at 1 A/s }")


def texts(svg: str) -> list[str]:
    """What a picture says, as people read it."""
    return [each.text or "" for each in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]


def test_a_picture_keeps_its_texts_and_equal_icons_give_equal_bytes() -> None:
    icon = SIX["cooling-step"]
    svg = icon._repr_html_()
    assert {"cooling-step", "time (s)", "display temperature (°C)"} <= set(texts(svg))
    assert svg.startswith('<svg role="img" aria-label="cooling-step: display temperature (°C)"')
    assert svg == parse(str(SIX))["cooling-step"]._repr_html_()
    assert not re.search(r"\d{4}-\d\d-\d\d|<script", svg)
    assert {icon.name for icon in SIX} <= set(texts(SIX._repr_html_()))


EVIL = "</text></svg><script>alert('x')</script><img src=x onerror=\"alert(1)\">&amp; abc $x^2$ {amount"


@pytest.mark.parametrize("show", ["set", "library"])
def test_texts_cannot_become_markup(show: str) -> None:
    icon = Icon("a", (Hold(1),), Context("skin", 32), Metadata(means=EVIL, by=EVIL))
    icons = IconSet("s", EVIL, icon.context, Metadata(by=EVIL), (icon,))
    made = icons._repr_html_() if show == "set" else Library((("s", icons),))._repr_html_()
    tree = ElementTree.fromstring(made)
    assert not {each.tag.rpartition("}")[2] for each in tree.iter()} & {"script", "img"}
    assert not any(name.startswith("on") for each in tree.iter() for name in each.attrib)


def test_members_are_chosen_evenly_with_the_corners() -> None:
    assert evenly(100, 4) == [0, 33, 66, 99]
    assert chosen((1,), 24) == [0]
    for sizes, most in (((100, 100, 100), 24), ((100, 100, 100), 8), ((7, 5), 3), ((2,) * 9, 24)):
        places, count = chosen(sizes, most), math.prod(sizes)
        assert len(places) <= most
        assert {0, count - 1} <= set(places) <= set(range(count))
    # The last value of the last parameter must not be all that is ever drawn.
    assert len({place % 24 for place in chosen((25, 24), 24)}) > 3


def test_a_family_of_eight_has_a_legend_with_values() -> None:
    ax = RAMP.plot()
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend[0] == "amount = −6 °C, rate = 1 °C/s"
    assert (len(legend), len(set(legend)), ax.get_title()) == (8, 8, "ramp: 8 icons")
    looks = {(line.get_color(), line.get_linestyle()) for line in ax.get_lines()}
    assert len(looks) == 9


def test_titles_legends_and_labels() -> None:
    ax = SIX.plot()
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [icon.name for icon in SIX]
    assert (ax.get_title(), ax.get_ylabel()) == (SIX.title, "display temperature (°C)")
    assert CURRENT.plot().get_ylabel() == "current (A)"
    assert HUGE.plot().get_title() == "1,000 icons (24 of 1,000 drawn)"
    ax = HUGE.families[0].plot()
    assert (len(ax.collections), ax.get_legend(), ax.get_title()) == (24, None, "many: 1,000 icons, 24 drawn")
    assert ax.get_xlim()[1] > 100
    title = Icon("x" * 90, (Hold(1),)).plot().get_title()
    assert title.endswith("…") and len(title) == 48
    two = Icon("a", (Hold(1),)), Icon("b", (Hold(2),))
    ax = IconSet("", "costs $1 and ${", Context(), Metadata(), two).plot()
    ax.figure.canvas.draw()
    assert ax.get_title() == "costs $1 and ${", "dollars are no formula"


def test_a_plot_shows_levels_times_and_directions() -> None:
    ax = SIX["cooling-step"].plot()
    (lines,) = ax.collections
    corners = [[0.0, 32.0], [2.0, 26.0], [6.0, 26.0], [8.0, 32.0]]
    assert [segment.tolist() for segment in lines.get_segments()] == [list(each) for each in pairwise(corners)]
    assert [tuple(colour[:3]) for colour in lines.get_colors()] == [to_rgb(c) for c in (COOL, STAY, WARM)]
    assert (ax.get_title(), ax.get_xlabel()) == ("cooling-step", "time (s)")
    low, high = ax.get_ylim()
    assert low < 26.0 and 32.0 < high < low + 12.0, "all of it is seen, and it fills half of the height"
    (lines,) = SHAPES["step"].plot().collections
    assert list(lines.get_linewidths()) == [1.5, 2.5, 1.5, 2.5], "steps are thinner than ramps"
    assert [tuple(colour[:3]) for colour in lines.get_colors()] == [to_rgb(c) for c in (COOL, STAY, WARM, STAY)]


def test_plots_draw_on_the_axes_they_are_given() -> None:
    for drawn in (SIX, SIX["cooling-step"], RAMP, HUGE):
        ax = Figure().add_subplot()
        assert drawn.plot(ax) is ax


def test_the_library_is_a_table_with_pictures() -> None:
    shelf = library()
    assert shelf["six-icons"] == SIX
    assert list(shelf) == sorted(shelf)
    (six,) = (entry for entry in shelf.entries if entry.name == "six-icons")
    assert (six.icons, six.title, six.source) == (6, SIX.title, "after Singhal and Jones, 2015 and 2018")
    assert six.intent.startswith("a quick, strong cooling; a moderate warming")
    assert any(re.fullmatch(rf"six-icons +6 +{SIX.title}", row) for row in repr(shelf).splitlines())
    assert SIX.title in shelf._repr_html_()
    assert list(shelf.to_frame().columns) == ["name", "icons", "title", "intent", "source"]
    assert Library((("huge", HUGE),)).entries[0].icons == 1_000
    assert "six-icon" not in shelf
    with pytest.raises(KeyError, match=r"no shipped set is called 'six-icon'; did you mean six-icons\? there are: b"):
        shelf["six-icon"]


def test_cool_and_warm_differ_in_grey() -> None:
    grey = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in map(to_rgb, (COOL, WARM, STAY))]
    assert grey[1] - grey[0] > 0.25
    assert grey[1] - grey[2] > 0.25

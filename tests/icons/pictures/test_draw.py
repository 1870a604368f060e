"""Plots and pictures: what they show, that they stay small, and that no text of a file gets out of its place."""

import re
import subprocess
import sys
from xml.etree import ElementTree

import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from thermicon.icons import Icon, IconSet, library, load_library, parse
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.corners import Corners
from thermicon.icons.model.statements import Hold
from thermicon.icons.pictures.curve_style import COOL, STAY, WARM, chosen, directions, envelope, evenly, ticks
from thermicon.icons.pictures.picture import picture, thumbnail

SIX = load_library("six-icons")
SHAPES = parse("""cue 1
icon step { step cool by 6 °C; hold for 2 s; step warm by 6 °C; hold for 1 s }
icon square { square by 3 °C every 4 s for 12 s }
icon sine { sine by 3 °C every 4 s for 12 s starting cool }
icon dense { sine by 3 °C every 500 ms for 60 s }
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
TWELVE = "\n".join(
    f'icon i{n} means "number {n}" {{ cool by {n + 1} °C at 3 °C/s; hold for {n + 1} s }}' for n in range(12)
)


def texts(svg: str) -> list[str]:
    """What a picture says, as people read it."""
    spoken = [each.text or "" for each in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]
    titles = ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")
    return [text or (title[0].tail or "") for text, title in zip(spoken, titles, strict=True)]


@pytest.mark.parametrize("icon", [*SIX, *SHAPES.icons[:4], CURRENT["drive"]], ids=lambda icon: icon.name)
def test_a_picture_of_an_icon_is_small_and_sound(icon: Icon) -> None:
    svg = icon._repr_html_()
    assert len(svg.encode()) < 3000
    assert texts(svg)[0] == icon.name
    assert svg == picture(icon)


@pytest.mark.slow
def test_a_picture_of_a_set_is_small() -> None:
    assert len(SIX._repr_html_().encode()) < 10_000
    waves = "\n".join(f"icon w{n} {{ sine by {n + 1} °C every 4 s for 40 s }}" for n in range(12))
    assert len(parse("cue 1\n" + waves)._repr_html_().encode()) < 40_000
    shaken = "\n".join(f"icon w{n} {{ square by {n + 1} °C every 1 s for 600 s }}" for n in range(12))
    assert len(parse("cue 1\n" + shaken)._repr_html_().encode()) < 40_000
    assert len(HUGE._repr_html_().encode()) < 10_000


@pytest.mark.slow
def test_pictures_need_no_ids_no_date_and_no_matplotlib() -> None:
    svg = SHAPES._repr_html_()
    assert not re.search(r"\bid=|url\(|href|<style|<defs|\d{4}-\d\d-\d\d|<script", svg)
    assert svg == parse(str(SHAPES))._repr_html_()
    code = (
        "import sys; from thermicon.icons import load_library, library; load_library('six-icons')._repr_html_(); "
        "library()._repr_html_(); print([n for n in ('matplotlib', 'pandas') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_steps_are_vertical_strokes_in_the_colour_of_their_direction() -> None:
    svg = picture(SHAPES["step"])
    strokes = dict(re.findall(r'<path d="([^"]*)" stroke="(#\w+)" stroke-width="1.6"/>', svg))
    (down, up) = sorted(strokes, key=lambda path: float(path[1:].split(",")[0]))
    assert (strokes[down], strokes[up]) == (COOL, WARM)
    assert re.fullmatch(r"M46,[\d.]+l0,[\d.]+", down)
    assert re.fullmatch(r"M[\d.]+,[\d.]+l0-[\d.]+", up)


def test_pieces_have_the_colours_of_their_direction() -> None:
    corners = SIX["cooling-step"].corners()
    assert directions(corners) == ["cool", "stay", "warm"]
    assert directions(CURRENT["drive"].corners()) == ["cool", "stay", "warm"]
    svg = picture(SIX["cooling-step"])
    assert all(f'stroke="{colour}"' in svg for colour in (COOL, WARM, STAY))
    assert 'stroke-dasharray="4 3"' in svg


def test_axes_have_units_baseline_and_extremes() -> None:
    said = texts(picture(SIX["cooling-step"]))
    assert said == ["cooling-step", "a quick, strong cooling", "display (°C)", "32", "26", "8 s", "0", "2", "4", "6"]
    assert texts(picture(CURRENT["drive"]))[1] == "current (A)"
    assert "skin (°C), baseline assumed" in texts(picture(SHAPES["step"]))


def test_a_family_shows_its_members_count_and_parameters() -> None:
    svg = picture(RAMP)
    assert texts(svg)[:3] == ["ramp: 8 icons", "amount in [-6, -3, 3, 6] °C; rate in [1, 3] °C/s", "ramp {amount}"]
    assert svg.count("M") > 8
    said = texts(picture(HUGE.families[0]))
    assert said[0] == "many: 1,000 icons"
    assert said[1].startswith("24 drawn · a in 1..10 step 1 K; b in")
    assert {"22", "140 s"} <= set(said)


def test_a_set_shows_twelve_and_counts_the_others() -> None:
    made = parse(
        f'cue 1\nset more "More" {{ baseline 33 °C }}\n{TWELVE}\nicon last {{ hold for 1 s }}\n{str(RAMP)[6:]}'.replace(
            "baseline 33 °C", "baseline 33 °C"
        )
    )
    said = texts(made._repr_html_())
    assert said[0] == "More"
    assert said[1].startswith("more · 21 icons · 1")
    assert "control skin · baseline 33 °C" in said[1]
    assert said[-1] == "and 9 more"
    assert "i11" in said
    assert "last" not in said
    assert not any("more" in text for text in texts(SIX._repr_html_()))


def test_icons_of_a_set_share_axes_unless_some_would_be_flat() -> None:
    assert texts(SIX._repr_html_()).count("8 s") == 6
    mixed = parse("cue 1\nicon a { hold for 1 s }\nicon b { hold for 100 s }")._repr_html_()
    assert {"1 s", "100 s"} <= set(texts(mixed))


def test_a_crowded_curve_is_a_band_and_says_so() -> None:
    svg = picture(SHAPES["dense"])
    assert f'fill="{STAY}"' in svg
    assert any("band: too fast to draw" in text for text in texts(svg))
    assert not any("band" in text for text in texts(picture(SHAPES["sine"])))


EVIL = "</text></svg><script>alert('x')</script><img src=x onerror=\"alert(1)\">&amp; abc $x^2$ {amount"


@pytest.mark.parametrize("show", ["set", "icon", "thumbnail", "library"])
def test_texts_cannot_become_markup(show: str) -> None:
    icon = Icon("a", (Hold(1),), Context("skin", 32), Metadata(means=EVIL, by=EVIL))
    icons = IconSet("s", EVIL, icon.context, Metadata(by=EVIL), (icon,))
    from thermicon.icons.pictures.gallery import Library

    made = {
        "set": icons._repr_html_,
        "icon": icon._repr_html_,
        "thumbnail": lambda: thumbnail(icon),
        "library": Library((("s", icons),))._repr_html_,
    }[show]()
    tree = ElementTree.fromstring(made.replace("<br>", "<br/>"))
    tags = {each.tag.rpartition("}")[2] for each in tree.iter()}
    assert tags <= {"svg", "g", "path", "text", "title", "table", "thead", "tbody", "tr", "th", "td", "b", "br"}
    assert not any(name.startswith("on") for each in tree.iter() for name in each.attrib)


def test_marks_that_turn_the_writing_direction_reach_no_picture() -> None:
    with pytest.raises(ValueError, match=r"means: the text holds the control character U\+202E"):
        Metadata(means="warm \u202emraw")


def test_long_texts_are_cut_and_kept_for_the_pointer() -> None:
    icon = Icon("x" * 90, (Hold(1),), metadata=Metadata(means="漢字 " * 60))
    tree = ElementTree.fromstring(picture(icon))
    for text in list(tree.iter("{http://www.w3.org/2000/svg}text"))[:2]:
        assert (text[0].tail or "").endswith("…")
        assert len(text[0].tail or "") < 50
    assert ("漢字 " * 60).strip() in "".join(tree.itertext())


def test_members_are_chosen_evenly_with_the_corners() -> None:
    assert evenly(100, 4) == [0, 33, 66, 99]
    assert chosen((1,), 24) == [0]
    for sizes, most in (((100, 100, 100), 24), ((100, 100, 100), 8), ((7, 5), 3), ((2,) * 9, 24)):
        places = chosen(sizes, most)
        count = 1
        for size in sizes:
            count *= size
        assert len(places) <= most
        assert {0, count - 1} <= set(places) <= set(range(count))
    # The last value of the last parameter must not be all that is ever drawn.
    assert len({place % 24 for place in chosen((25, 24), 24)}) > 3


def test_ticks_are_round_and_end_with_the_duration() -> None:
    assert ticks(8, 5) == [0, 2, 4, 6, 8]
    assert ticks(0.4, 5) == [0, 0.1, 0.2, 0.3, 0.4]
    for duration in (0.001, 1, 7.3, 59.9, 3600):
        found = ticks(duration, 5)
        assert 3 <= len(found) <= 7
        assert found == sorted(set(found))
        assert (found[0], found[-1]) == (0, duration)


def test_the_envelope_holds_the_curve() -> None:
    corners = Corners((0.0, 1.0, 2.0, 3.0), (0.0, 4.0, 0.0, 0.0), "temperature_C")
    assert [row[1:] for row in envelope(corners, 3)] == [(0, 4), (0, 4), (0, 0)]


def test_a_family_of_eight_has_a_legend_with_values() -> None:
    ax = RAMP.plot()
    legend = [text.get_text() for text in ax.get_legend().get_texts()]
    assert legend[0] == "amount = −6 °C, rate = 1 °C/s"
    assert (len(legend), len(set(legend)), ax.get_title()) == (8, 8, "ramp: 8 icons")
    looks = {(line.get_color(), line.get_linestyle()) for line in ax.get_lines()}
    assert len(looks) == 9


def test_a_large_family_is_coloured_by_direction() -> None:
    ax = HUGE.families[0].plot()
    assert (len(ax.collections), ax.get_legend()) == (24, None)
    assert ax.get_title() == "many: 1,000 icons, 24 drawn"
    assert ax.get_xlim()[1] > 100


def test_a_set_plots_with_names_and_its_title() -> None:
    ax = SIX.plot()
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [icon.name for icon in SIX]
    assert (ax.get_title(), ax.get_ylabel()) == (
        "Six thermal icons after Singhal and Jones",
        "display temperature (°C)",
    )
    assert CURRENT.plot().get_ylabel() == "current (A)"
    assert HUGE.plot().get_title() == "1,000 icons (24 of 1,000 drawn)"


def test_plots_draw_on_the_axes_they_are_given() -> None:
    for drawn in (SIX, SIX["cooling-step"], RAMP, HUGE):
        ax = Figure().add_subplot()
        assert drawn.plot(ax) is ax


def test_dollars_in_titles_are_no_formula() -> None:
    icons = IconSet("", "costs $1 and ${", Context(), Metadata(), (Icon("a", (Hold(1),)), Icon("b", (Hold(2),))))
    ax = icons.plot()
    ax.figure.canvas.draw()
    assert ax.get_title() == "costs $1 and ${"


def test_steps_are_thinner_than_ramps_in_a_plot() -> None:
    (lines,) = SHAPES["step"].plot().collections
    assert list(lines.get_linewidths()) == [1.5, 2.5, 1.5, 2.5]
    assert [tuple(colour[:3]) for colour in lines.get_colors()] == [to_rgb(c) for c in (COOL, STAY, WARM, STAY)]


def test_the_library_is_a_table_with_pictures() -> None:
    shelf = library()
    assert shelf["six-icons"] == SIX
    assert list(shelf) == sorted(shelf)
    (six,) = (entry for entry in shelf.entries if entry.name == "six-icons")
    assert (six.count, six.title) == (6, "Six thermal icons after Singhal and Jones")
    assert six.intent.startswith("a quick, strong cooling; a moderate warming")
    assert six.source == "after Singhal and Jones, 2015 and 2018"
    rows = repr(shelf).splitlines()
    assert any(re.fullmatch(r"six-icons +6 icons +Six thermal icons after Singhal and Jones", row) for row in rows)
    assert max(map(len, rows)) <= 100
    html = shelf._repr_html_()
    assert html.count("<svg") >= 11
    assert len(html.encode()) < 40_000
    assert list(shelf.to_frame().columns) == ["name", "icons", "title", "intent", "source"]


def test_an_unknown_shipped_set_is_told() -> None:
    with pytest.raises(
        KeyError, match=r"no shipped set is called 'six-icon'; did you mean six-icons\? there are: calibration"
    ):
        library()["six-icon"]
    assert "six-icon" not in library()


def test_families_in_the_library_count_without_being_made() -> None:
    from thermicon.icons.pictures.gallery import Library

    shelf = Library((("huge", HUGE),))
    assert shelf.entries[0].count == 1_000
    assert "1,000 icons" in repr(shelf)
    assert shelf._repr_html_().count("<svg") == 1

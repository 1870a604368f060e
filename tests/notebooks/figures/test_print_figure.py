"""Figures in print."""

from pathlib import Path

import pytest
import typer
from matplotlib.figure import Figure
from PIL import Image

from thermicon.notebooks.cli.options import FigureOptions
from thermicon.notebooks.figures.print_figure import restyle, write_figure
from thermicon.notebooks.figures.style import Look, read_width_mm


def two_panels() -> Figure:
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for ax in (upper, lower):
        ax.plot([0, 1, 2], [32, 30, 31], color="#2166ac", label="skin")
        ax.plot([0, 1, 2], [32, 33, 31], color="#e08214", ls="--", label="display")
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    lower.set_xlabel("time (s)")
    lower.set_ylabel("skin (°C)")
    figure.suptitle("a title")
    return figure


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pdf", "svg", "png"])
def test_the_same_figure_gives_the_same_bytes_without_a_date(tmp_path: Path, kind: str) -> None:
    for name in ("one", "other"):
        write_figure(two_panels(), tmp_path / f"{name}.{kind}", Look(85.0))
    first = (tmp_path / f"one.{kind}").read_bytes()
    assert first == (tmp_path / f"other.{kind}").read_bytes()
    assert b"CreationDate" not in first and b"dc:date" not in first


def test_a_pdf_has_its_fonts_embedded_as_truetype(tmp_path: Path) -> None:
    write_figure(two_panels(), tmp_path / "a.pdf", Look(85.0))
    content = (tmp_path / "a.pdf").read_bytes()
    assert b"/FontFile2" in content and b"/Type3" not in content


def test_a_picture_is_as_wide_as_asked(tmp_path: Path) -> None:
    write_figure(two_panels(), tmp_path / "a.png", Look(85.0))
    assert Image.open(tmp_path / "a.png").width == pytest.approx(85.0 / 25.4 * 300, abs=1)


def test_a_column_has_letters_and_one_key_below() -> None:
    figure = two_panels()
    restyle(figure, 85.0)
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["a", "b"]
    assert [ax.get_legend() for ax in figure.axes] == [None, None]
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["skin", "display"]
    sizes = {text.get_fontsize() for ax in figure.axes for text in ax.get_xticklabels()}
    assert max(sizes) <= 9.0 and min(sizes) >= 5.5


def test_the_title_is_left_to_the_caption_and_panels_say_what_they_show_and_no_more() -> None:
    figure = two_panels()
    for ax, title in zip(
        figure.axes, ("Predicted d′ (memory: episodes)", "Answers, % (diagonal named: 85 %)"), strict=True
    ):
        ax.set_title(title)
    restyle(figure, 85.0)
    titles = [ax.get_title().partition("$  ")[2] for ax in figure.axes]
    assert titles == ["Predicted d′", "Answers, %"]
    assert figure.get_suptitle() == ""
    one = Figure()
    one.add_subplot(title="one panel")
    restyle(one, 85.0)
    assert one.axes[0].get_title() == ""


def test_a_long_label_goes_on_in_another_line_and_the_key_names_a_line_once() -> None:
    figure = two_panels()
    _, lower = figure.axes
    lower.set_xlabel("time since the hand was placed on the display, in seconds, by the clock of the receptors (s)")
    restyle(figure, 85.0)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["skin", "display"]
    assert lower.get_xlabel().count("\n") >= 1
    figure.draw_without_rendering()
    box = lower.xaxis.label.get_window_extent()
    assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width


def test_panels_keep_their_height_whatever_the_key_needs() -> None:
    heights = []
    for count in (2, 12):
        figure = Figure(figsize=(8.0, 3.0), layout="constrained")
        ax = figure.add_subplot()
        for place in range(count):
            ax.plot([0, 1], [0, place], label=f"a line with the number {place}")
        figure.legend(loc="outside upper center", ncols=4)
        restyle(figure, 85.0)
        figure.draw_without_rendering()
        heights.append(ax.get_window_extent().height / figure.dpi)
    assert heights[1] == pytest.approx(heights[0], rel=0.25) and heights[1] > 0.6


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("85", "is not a width with a unit"),
        ("85px", "such as 85mm"),
        ("2mm", "outside 40 to 500 mm"),
        ("-85mm", "unit"),
    ],
)
def test_a_width_that_cannot_be(text: str, what: str) -> None:
    with pytest.raises(typer.BadParameter, match=what):
        read_width_mm(text)


def test_looks_without_a_figure_are_refused() -> None:
    with pytest.raises(typer.BadParameter, match="name its file with --figure"):
        FigureOptions(paper="85mm")
    assert FigureOptions(Path("a.png"), "85mm").look == Look(85.0)

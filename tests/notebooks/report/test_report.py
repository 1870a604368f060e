"""``rank --report`` as one self-contained page."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from markupsafe import escape

from thermicon.circuit import Rig
from thermicon.icons import IconSet, load_library, parse
from thermicon.notebooks.cli.options import CrowdOptions, RigOptions, command_text
from thermicon.notebooks.cli.ranking import TaskOptions
from thermicon.notebooks.report.rank_page import LIMITS, SAFETY, report
from thermicon.notebooks.report.set_report import SetReport
from thermicon.perception import Ranking, rank
from thermicon.perception.selection.edit import cheapest_edits

Cli = Callable[..., Any]
NASTY = """cue 1
set nasty "Hot & <b>cold</b> <script>alert(1)</script>" { control display; baseline 32 °C }
icon dip means "a <img src=x onerror=y> dip" { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }
icon glow by "R&D" { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
icon slow { warm by 3 °C at 0.5 °C/s; return at 2 °C/s }
"""
VOID = {"meta", "img", "br"}


class Reader(HTMLParser):
    """Every tag opened and closed in its turn, every address, and the text."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.addresses: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href", "data", "srcset")]
        assert not any(name.startswith("on") for name, _ in attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] != "style":
            self.text += data


def read(made: str) -> Reader:
    reader = Reader()
    reader.feed(made)
    reader.close()
    assert not reader.open
    return reader


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")


@pytest.fixture(scope="module")
def icons() -> IconSet:
    return parse(NASTY)


@pytest.fixture(scope="module")
def three() -> IconSet:
    """Three of the six icons: half of the pictures, which take long to draw."""
    six = load_library("six-icons")
    return replace(six, entries=six.entries[:3])


@pytest.fixture(scope="module")
def ranking(icons: IconSet, rig: Rig) -> Ranking:
    return rank(icons, rig, people=6, parameters=4)


@pytest.fixture(scope="module")
def made(ranking: Ranking, icons: IconSet, rig: Rig) -> str:
    return report(SetReport(ranking, edits=cheapest_edits(ranking)), icons, "thermicon rank a&b.cue")


@pytest.mark.slow
def test_the_page_stands_alone(made: str) -> None:
    reader = read(made)
    assert made.startswith("<!DOCTYPE html>\n")
    assert all(address.startswith("data:image/") for address in reader.addresses)
    assert not {"script", "link", "iframe", "object"} & set(reader.seen)
    assert "@import" not in made
    assert "url(" not in made
    assert 'name="viewport"' in made
    assert "@media print" in made
    assert reader.seen.count("img") == 4 + 3  # the set's pictures, then the overview of each icon
    assert all(re.search(r'alt="[^"]+"', image) for image in re.findall(r"<img[^>]{0,200}", made))


def test_what_people_wrote_is_text(made: str) -> None:
    reader = read(made)
    assert reader.seen.count("b") == 4  # the large numbers, which are ours
    for words in ("Hot & <b>cold</b>", "<script>alert(1)</script>", "a <img src=x onerror=y> dip", '"R&D"'):
        assert words in reader.text
        assert escape(words) in made
    assert "thermicon rank a&b.cue" in reader.text


def test_it_tells_what_the_ranking_found(made: str, ranking: Ranking, icons: IconSet) -> None:
    words = " ".join(read(made).text.split())
    for text in (*LIMITS, SAFETY, ranking.content_hash, f"thermicon {ranking.version}", "6 virtual, seed 0"):
        assert text in words
    assert all(reason in words for reason in ranking.worst.why)
    assert f"Worst pair: {ranking.worst.a} and {ranking.worst.b}" in words
    for icon in icons:
        assert " ".join(str(icon)[str(icon).index("icon ") :].split()) in words
    low, high = ranking.proportion_correct_interval
    assert f"95 % of people: {100 * low:.0f}–{100 * high:.0f} %" in words
    for part in ("direction", "intensity", "rate", "duration", "pause"):
        assert part in words
    assert "receiver operating characteristic of the worst pair" in made
    for heading in ("Settings", "The set", "Pictures of the set", "Icons", "Safety"):
        assert f"<h2>{heading}</h2>" in made


@pytest.mark.slow
def test_it_is_the_same_every_time_without_a_date(made: str, ranking: Ranking, icons: IconSet, rig: Rig) -> None:
    assert report(SetReport(ranking, edits=cheapest_edits(ranking)), icons, "thermicon rank a&b.cue") == made
    assert re.findall(r"20\d\d-\d\d-\d\d", read(made).text) == []
    assert len(made) < 1_500_000


def test_one_icon_has_no_pairs(rig: Rig) -> None:
    icons = parse("cue 1\nicon only { warm by 2 °C at 1 °C/s; return at 1 °C/s }\n")
    made = report(SetReport(rank(icons, rig, people=1, parameters=0)), icons)
    words = read(made).text
    assert "Predicted ranking of 1 icon by thermicon" in words
    for heading in ("Pairs", "Pictures of the set", "Worst pair"):
        assert heading not in words
    assert "95 % of people" not in words


@pytest.mark.slow
def test_what_is_unsafe_or_outside_the_data_is_warned_of(rig: Rig) -> None:
    icons = parse(
        "cue 1\nset s { control current }\n"
        "icon burn { to -3 A at 20 A/s; hold for 20 s; return at 20 A/s }\n"
        "icon jolt { to 1.6 A at 0.4 A/s; to 0.1 A at 0.4 A/s }\n"
    )
    ranking = rank(icons, rig, people=2, parameters=0)
    made = report(SetReport(ranking), icons, cures={"jolt": "it would be with less"})
    assert '<p class="warn">* burn is NOT SAFE and not reached: ' in made
    assert "; it would be with less</p>" in made
    assert '<p class="note">Outside the data: burn: ' in made
    assert "<td>burn *</td>" in made


@pytest.mark.slow
def test_the_command_writes_it_whole_or_not_at_all(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "report.html"
    options = ("--people", 3, "--intervals", 0, "--set", "contact.area_cm2=4")
    said = cli.good("rank", two, *options, "--report", out, "--json", tmp_path / "a.json")
    assert f"wrote {out}" in said.stderr
    text = out.read_text(encoding="utf-8")
    assert "thermicon rank two.cue --set contact.area_cm2=4 --people 3 --intervals 0" in read(text).text
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["content_hash"] in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.json", "report.html", "two.cue"]
    again = tmp_path / "again.html"
    cli.good("rank", two, *options, "--report", again)
    assert again.read_bytes() == out.read_bytes()


def test_the_command_can_be_given_again() -> None:
    assert command_text(["six-icons"], RigOptions(), CrowdOptions()) == "thermicon rank six-icons"
    changed = RigOptions("/home/x/watch.toml", ["driver.current_limit_A=1.2"])
    asked = CrowdOptions(seed=3, memory="naming", tracking="ideal", observer=Path("/home/x/lab.csv"))
    groups = (changed, asked, TaskOptions(["gap=8", "trials=24"]))
    assert command_text(["/home/x/my icons.cue", "b.cue"], *groups) == (
        "thermicon rank 'my icons.cue' b.cue --rig watch.toml --set driver.current_limit_A=1.2 --seed 3 "
        "--tracking ideal --memory naming --observer lab.csv --task gap=8 --task trials=24"
    )
    assert "--observer /home/x/lab.csv" in command_text(["six-icons"], asked, paths=True)

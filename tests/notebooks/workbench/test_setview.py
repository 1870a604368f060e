"""The set view without a browser."""

from collections.abc import Iterator
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from tests.builders import few_draws, missing
from tests.notebooks.workbench.openbench import SAID, wait
from thermicon.circuit import Rig
from thermicon.icons import parse
from thermicon.icons.model.changes import numbers_of, repeated, with_number
from thermicon.notebooks import Workbench
from thermicon.notebooks.editing.number_literals import CannotEdit, with_edit
from thermicon.notebooks.report.set_report import chosen
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.live_view import BackgroundJob, BackgroundWorker, Superseded
from thermicon.notebooks.workbench.set_model import RankedSet, overlay_frame, rank_set
from thermicon.notebooks.workbench.set_view import SetView
from thermicon.perception.observer.observer_model import ObserverModel

TWO = """cue 1

icon near {
  warm by 4 °C at 2 °C/s  # as far as is pleasant
  hold for 2 s
  return at 2 °C/s
}

icon nearer { warm by 3.6 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
"""
THREE = TWO + "icon far { cool by 4 °C at 2 °C/s; return at 2 °C/s }\n"


class Bench:
    """A set view that is shown, on a text."""

    def __init__(self, text: str, model: ObserverModel | None = None) -> None:
        self.design = DesignModel(text, Rig.load("thenar"), model=model)
        self.view = SetView(self.design, lambda new: self.type(new))
        self.design.on_change(self.view.renew)
        self.view.shown = True
        self.view.renew()
        self.wait()

    @property
    def made(self) -> RankedSet:
        assert self.view.made is not None
        return self.view.made

    def type(self, text: str) -> None:
        self.design.receive({"type": "text", "text": text})

    def wait(self) -> None:
        wait(self.view.worker)
        wait(self.view.editor)

    def said(self, name: str) -> str:
        return str(self.view.said[name].value)

    @property
    def stale(self) -> bool:
        return "thermicon-stale" in self.view.body._dom_classes

    @property
    def frame(self) -> tuple[dict[str, Any], list[bytes]]:
        assert self.view.heat._newest is not None
        return self.view.heat._newest

    def click(self, row: int, column: int) -> dict[str, Any]:
        self.view.heat._receive(self.view.heat, {"type": "cell", "seq": 7, "row": row, "column": column}, [])
        return self.frame[0]


@pytest.fixture(scope="module", autouse=True)
def few_people() -> Iterator[None]:
    """Numbers are not what is tested here, so a few people do."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("thermicon.notebooks.workbench.set_view.WELL", (24, 2))
        yield


@pytest.fixture(scope="module")
def ranked() -> Bench:
    """Three icons, ranked to the end; tests that change it make their own."""
    bench = Bench(THREE)
    assert "24 people" in bench.said("status")
    return bench


def test_a_set_is_ranked_with_its_intervals_worst_pair_map_and_near_icons_side_by_side(ranked: Bench) -> None:
    assert "in a new laboratory (95 %): " in ranked.said("scores")
    assert ranked.said("table").count("<tr>") == 4
    assert missing(["near", "nearer"], ranked.said("pair")) == []
    assert missing(["<svg", "stress", "nearer"], ranked.said("map")) == []
    assert not ranked.stale
    labels = ranked.made.labels
    assert abs(labels.index("near") - labels.index("nearer")) == 1
    assert ranked.frame[0]["labels"] == labels
    assert [len(buffer) for buffer in ranked.frame[1]] == [36, 36]


def test_a_click_shows_the_pair_with_its_reasons_and_an_edit(ranked: Bench) -> None:
    place = ranked.made.labels.index
    answer = ranked.click(place("near"), place("far"))
    assert answer["seq"] == 7
    assert answer["picked"] == [place("near"), place("far")]
    assert "opposite" in ranked.said("why") or "direction" in ranked.said("why")
    ranked.wait()
    assert "distinguishable already" in ranked.said("edit_text")
    assert ranked.view.apply.disabled
    ranked.click(place("near"), place("near"))
    assert "two different icons" in ranked.said("edit_text")
    ranked.click(0, 9)
    assert "there is no cell" in ranked.said("status")
    ranked.click(place("near"), place("nearer"))
    ranked.wait()  # the pair that is shown first, for other tests


def test_a_choice_is_that_of_the_command_and_says_what_is_in_its_way(ranked: Bench) -> None:
    how = {"goal": None, "people": 24, "parameters": 2}
    found: Any = chosen(parse(THREE), Rig.load("thenar"), 2, "worst", None, False, how).choice
    for count, words in ((2, ["Best 2 of 3, by the worst pair", ", ".join(found.icons)]), (4, ["no choice", "4"])):
        ranked.view.count.value = count
        ranked.view.choose_best()
        wait(ranked.view.chooser)
        assert missing(words, ranked.said("choice")) == []


def test_both_icons_lie_over_each_other_on_one_clock(ranked: Bench) -> None:
    frame = overlay_frame(ranked.made, ranked.design.observer, "near", "far")
    assert [panel["key"] for panel in frame.meta["panels"]] == ["skin", "cold", "warm"]
    assert [series["label"] for series in frame.meta["panels"][0]["series"]] == ["near", "far"]
    assert {len(buffer) for buffer in frame.buffers} == {frame.meta["time"]["n"]}


@pytest.mark.slow
def test_an_edit_is_applied_and_undone_and_errors_keep_the_last_good_set_as_stale() -> None:
    bench = Bench(TWO)
    assert not bench.view.apply.disabled, bench.said("edit_text")
    bench.view.apply.click()
    assert bench.design.text != TWO
    assert "# as far as is pleasant" in bench.design.text
    assert "applied" in bench.said("edit_text")
    bench.wait()
    assert bench.made.text == bench.design.text
    assert bench.made.pair("near", "nearer").d_prime > 2.4
    bench.design.receive({"type": "undo"})
    assert bench.design.text == TWO
    bench.wait()
    bench.type(TWO.replace("by 4 °C", "by 4"))
    assert bench.stale
    assert missing(["line 4, missing unit", "last valid set is shown"], bench.said("status")) == []
    bench.type(TWO)
    bench.wait()
    assert not bench.stale


def test_nothing_is_ranked_while_the_view_is_not_shown() -> None:
    design = DesignModel(TWO, Rig.load("thenar"))
    view = SetView(design, lambda text: None)
    design.on_change(view.renew)
    design.receive({"type": "text", "text": THREE})
    assert view.worker.threads == []
    assert view.made is None
    assert "when this tab opens" in view.said["status"].value


def test_a_set_of_one_says_that_it_is_never_confused() -> None:
    bench = Bench("cue 1; icon dip { cool by 4 °C at 2 °C/s; return at 2 °C/s }")
    assert "no distance" in bench.said("scores")
    assert "dip" in bench.said("table")
    assert bench.view._maps.layout.display == "none"


@pytest.mark.parametrize("text", SAID["texts"])
def test_what_cannot_be_ranked_is_said(text: str) -> None:
    assert missing(SAID["texts"][text], Bench(text).said("status")) == []


def test_the_newest_job_wins_and_nobody_hears_of_the_others() -> None:
    worker, done = BackgroundWorker(), list[str]()

    def slow(job: BackgroundJob) -> None:
        with pytest.raises(Superseded):
            while True:
                job.go_on()
        done.append("ended")
        job.on_page(lambda: done.append("never"))

    worker.ask(slow)
    worker.ask(lambda job: job.on_page(lambda: done.append("newest")))
    wait(worker)
    assert "never" not in done
    assert done[-1] == "newest"


def test_a_request_that_failed_says_so_again_and_ends_the_work_on_the_one_after_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    go = Event()

    def ranked(text: str, *given: Any) -> None:
        if "# fail" in text:
            raise ValueError("it failed")
        assert go.wait(20)

    monkeypatch.setattr("thermicon.notebooks.workbench.set_view.rank_set", ranked)
    monkeypatch.setattr(SetView, "settles_s", 0.0)
    bench = Bench(TWO + "# fail")
    for text, words in (("cue 1", "the text has errors"), (TWO + "# slow", "ranking")):
        assert "it failed" in bench.said("status")
        bench.design.show_text(text)
        assert words in bench.said("status")
        bench.design.receive({"type": "undo"})
    go.set()
    bench.wait()
    assert "it failed" in bench.said("status")
    assert bench.view.made is None


@pytest.mark.parametrize("name", ["near", "nearer"])
def test_an_edit_keeps_all_that_is_not_edited_and_a_repeat_is_put_around_what_moves(name: str) -> None:
    icon = parse(TWO)[name]
    longer = with_number(icon, numbers_of(icon, 32.0)[0], 4.3)
    assert with_edit(TWO, longer, "old", "new") == TWO.replace(f"by {'4' if name == 'near' else '3.6'} °C", "by 4.3 °C")
    edited = with_edit(TWO, repeated(icon, 2), "its 3 statements", "repeat 2 { its 3 statements }")
    assert parse(edited)[name].statements == repeated(icon, 2).statements
    assert "# as far as is pleasant" in edited


def test_an_edit_that_does_not_fit_is_refused_with_what_to_do() -> None:
    icon = parse(TWO)["near"]
    edited = with_number(icon, numbers_of(icon, 32.0)[0], 4.3)
    family = "cue 1; icon r(a in [3, 4] °C) { cool by a at 2 °C/s; return at 2 °C/s }"
    for text, made, words in (
        (
            TWO.replace("near {", "other {", 1),
            edited,
            "no icon is called near now; change it by hand: in near, old",
        ),
        (TWO.replace("hold for 2 s", "hold for 3 s"), edited, "the text has changed"),
        (family, next(iter(parse(family))), "written by the family r"),
    ):
        with pytest.raises(CannotEdit, match=words):
            with_edit(text, made, "old", "new")


def test_a_single_draw_gives_no_interval(tmp_path: Path) -> None:
    model = ObserverModel.load(few_draws(tmp_path / "lab.csv", 1, "by weights from 2 laboratories"))
    assert rank_set(TWO, Rig.load("thenar"), 2, 128, observer=model).ranking.new_laboratory is None
    bench = Workbench(TWO, observer=few_draws(tmp_path / "two.csv", 2, "by weights from 4 laboratories"))
    assert bench.ranking(2).observer == "two.csv"

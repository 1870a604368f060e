"""The strip of the design view without a browser: what it says of set, goal and icon, and when."""

from typing import Any

import pytest

from tests.builders import missing
from tests.notebooks.workbench.openbench import wait
from thermicon.circuit import Rig
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.set_strip import SetStrip

TWO = """cue 1
icon near { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
icon far { cool by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
"""


class Bench:
    """A strip that is shown, with all that it sent since the last message."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        for name, value in (("QUICK", (4, 0)), ("WELL", (24, 2))):
            monkeypatch.setattr(f"thermicon.notebooks.workbench.set_strip.{name}", value)
        self.sent: list[dict[str, Any]] = []
        self.design = DesignModel(TWO, Rig.load("thenar"))
        self.strip = SetStrip(self.design, self.sent.append)
        self.design.on_change(self.strip.renew)
        self.strip.shown = True
        self.does(type="goal", text="correct >= 60 %")

    def does(self, finish: bool = True, **message: Any) -> dict[str, Any]:
        self.sent.clear()
        self.design.receive(message)
        if finish:
            wait(self.strip.worker)
        return self.sent[-1] if self.sent else {}


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(monkeypatch)


def test_it_is_rough_first_then_final_and_stale_as_soon_as_the_text_is_newer(bench: Bench) -> None:
    assert [said["rough"] for said in bench.sent if not said["stale"]] == [True, False]
    assert bench.strip.known((bench.design.text, bench.design.rig)) is bench.strip.ranking
    assert bench.does(False, type="text", text=bench.design.text.replace("far", "away"))["stale"]
    assert bench.strip.known((bench.design.text, bench.design.rig)) is None
    said = bench.does(type="text", text=TWO.replace("by 4", "by four"))
    assert said["stale"]
    assert "the text has errors" in said["about"]


@pytest.mark.parametrize(
    ("goal", "met", "binding"),
    [("time <= 1 s", False, "takes most time"), ("correct >= 50 % for 99 % of people", True, "")],
)
def test_a_goal_is_typed_once_judged_and_undone_as_a_step(bench: Bench, goal: str, met: bool, binding: str) -> None:
    said = bench.does(type="goal", text=f" {goal}")
    assert bench.design.text == f"# goal: {goal}\n{TWO}"
    assert (said["goal"], said["met"], said["stale"]) == (goal, met, False)
    assert binding in said["binding"]
    assert missing(["is wanted >="], bench.design.receive({"type": "goal", "text": "bits <= 2"}).meta["notes"][0]) == []
    assert bench.does(type="undo")["goal"] == "correct >= 60 %"
    assert bench.does(type="goal", text="")["met"] is None
    assert bench.design.text == TWO


def test_nothing_is_ranked_while_a_corner_is_dragged(bench: Bench) -> None:
    before = bench.strip.ranking
    bench.does(False, type="drag", handle=0, t=2.0, y=36.2)
    bench.strip.worker.threads[-1].join(0.5)
    assert bench.strip.worker.threads[-1].is_alive()
    assert bench.strip.ranking is before
    bench.does(type="drag", handle=0, t=2.0, y=36.2, end=True)
    assert bench.strip.ranking is not before

"""The strip of the design view without a browser: what it says of set, goal and icon, and when."""

from collections.abc import Iterator
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
    """A strip that is shown, with all that it sent."""

    def __init__(self, text: str) -> None:
        self.sent: list[dict[str, Any]] = []
        self.design = DesignModel(text, Rig.load("thenar"))
        self.strip = SetStrip(self.design, self.sent.append)
        self.design.on_change(self.strip.renew)
        self.strip.shown = True
        self.strip.renew()
        self.wait()

    def wait(self) -> None:
        wait(self.strip.worker)

    def does(self, **message: Any) -> None:
        self.sent.clear()
        self.design.receive(message)


@pytest.fixture(autouse=True)
def few_people() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        for name, value in (("QUICK", (4, 0)), ("WELL", (24, 2))):
            patched.setattr(f"thermicon.notebooks.workbench.set_strip.{name}", value)
        yield


def test_it_is_rough_first_then_final_and_stale_as_soon_as_the_text_is_newer() -> None:
    bench = Bench(TWO)
    assert [said["rough"] for said in bench.sent if not said["stale"]] == [True, False]
    assert bench.sent[-1]["felt"].endswith("%")
    request = (TWO, bench.design.rig)
    assert bench.strip.known(request) is bench.strip.ranking
    bench.does(type="icon", name="far")
    assert [said["stale"] for said in bench.sent] in ([], [False])
    bench.does(type="text", text=TWO.replace("far", "away"))
    assert bench.sent[0]["stale"]
    bench.wait()
    assert not bench.sent[-1]["stale"]
    assert bench.strip.known(request) is None
    bench.does(type="text", text=TWO.replace("by 4", "by four"))
    bench.wait()
    assert bench.sent[-1]["stale"]
    assert "the text has errors" in bench.sent[-1]["about"]


@pytest.mark.parametrize(
    ("goal", "met", "binding"),
    [
        ("correct >= 60 %", True, ""),
        ("time <= 1 s", False, "takes most time"),
        ("correct >= 99.9 % for 99 % of people", False, "are confused most"),
    ],
)
def test_a_goal_is_typed_once_judged_and_undone_as_a_step(goal: str, met: bool, binding: str) -> None:
    bench = Bench(TWO)
    bench.does(type="goal", text=f" {goal}")
    assert bench.design.text == f"# goal: {goal}\n{TWO}"
    bench.wait()
    said = bench.sent[-1]
    assert (said["goal"], said["met"], said["stale"]) == (goal, met, False)
    assert binding in said["binding"]
    bench.does(type="goal", text="")
    assert bench.design.text == TWO
    bench.does(type="undo")
    assert bench.design.document.goal == goal


def test_what_is_no_goal_is_said_and_leaves_the_text() -> None:
    design = DesignModel(TWO, Rig.load("thenar"))
    frame = design.receive({"type": "goal", "text": "correct <= 90 %"})
    assert missing(["correct", "is wanted >="], frame.meta["notes"][0]) == []
    assert design.text == TWO


def test_nothing_is_ranked_while_a_corner_is_dragged() -> None:
    bench = Bench(TWO)
    before = bench.strip.ranking
    for step in range(3):
        bench.does(type="drag", handle=0, t=2.0, y=36.0 + 0.1 * step)
    bench.strip.worker.threads[-1].join(0.5)
    assert bench.strip.worker.threads[-1].is_alive()
    assert bench.strip.ranking is before
    bench.does(type="drag", handle=0, t=2.0, y=36.2, end=True)
    bench.wait()
    assert bench.strip.ranking is not before
    assert not bench.sent[-1]["stale"]

"""The strip of the design view without a browser."""

from typing import Any

import pytest

from tests.notebooks.workbench.openbench import wait
from thermicon.circuit import Rig
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.set_strip import SetStrip

TWO = """cue 1; icon near { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
icon far { cool by 4 °C at 2 °C/s; return at 2 °C/s }
"""


@pytest.fixture
def does(monkeypatch: pytest.MonkeyPatch) -> Any:
    """``does(finish, type=…)`` is a message of the page; the answers are what the strip sends until it is done."""
    for name, value in (("QUICK", (4, 0)), ("WELL", (24, 2))):
        monkeypatch.setattr(f"thermicon.notebooks.workbench.set_strip.{name}", value)
    sent: list[dict[str, Any]] = []
    design = DesignModel(TWO, Rig.load("thenar"))
    strip = SetStrip(design, sent.append)
    design.on_change(strip.renew)
    strip.shown = True

    def message(finish: bool = True, **content: Any) -> list[dict[str, Any]]:
        sent.clear()
        design.receive(content)
        if finish:
            wait(strip.worker)
        return list(sent)

    message.strip, message.design = strip, design  # type: ignore[attr-defined]
    return message


def test_it_is_rough_first_then_final_stale_as_soon_as_the_text_is_newer_and_rests_while_a_corner_is_dragged(
    does: Any,
) -> None:
    strip, design = does.strip, does.design
    said = does(type="text", text=TWO + "\n")
    assert [each["rough"] for each in said if not each["stale"]] == [True, False]
    assert strip.known((design.text, design.rig)) is strip.ranking
    assert does(False, type="drag", handle=0, t=2.0, y=36.2)[-1]["stale"]
    assert strip.known((design.text, design.rig)) is None
    strip.worker.threads[-1].join(0.5)
    assert strip.worker.threads[-1].is_alive()
    assert not does(type="drag", handle=0, t=2.0, y=36.2, end=True)[-1]["stale"]
    said = does(type="text", text=TWO.replace("by 4", "by four"))
    assert "the text has errors" in said[-1]["about"]


@pytest.mark.parametrize(
    ("goal", "met", "binding"),
    [("time <= 1 s", False, "takes most time"), ("named >= 50 % for 99 % of people", True, "")],
)
def test_a_goal_is_typed_once_judged_and_undone_as_a_step(does: Any, goal: str, met: bool, binding: str) -> None:
    said = does(type="goal", text=f" {goal}")[-1]
    assert does.design.text == f"# goal: {goal}\n{TWO}"
    assert (said["goal"], said["met"], said["stale"]) == (goal, met, False)
    assert binding in said["binding"]
    assert "is wanted >=" in does.design.receive({"type": "goal", "text": "bits <= 2"}).meta["notes"][0]
    does(type="goal", text="")
    assert does.design.text == TWO
    assert does(type="undo")[-1]["goal"] == goal

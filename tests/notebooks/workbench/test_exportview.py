"""The export view without a browser: prepared, refused or written drives."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.builders import missing
from tests.circuit.surerig import sure_rig
from tests.notebooks.workbench.openbench import wait
from thermicon.base.files.atomic import OutputError
from thermicon.icons import parse
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.export_view import ExportView
from thermicon.perception import rank

TWO = """cue 1
icon dip { cool by 3 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }
icon glow { warm by 3 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }
"""
HOT = "cue 1; icon hot { warm by 14 °C at 3 °C/s; hold for 20 s; return at 3 °C/s }"
STEEP = "cue 1; icon cold { cool by 8 °C at 9 °C/s; hold for 1 s; return at 1 °C/s }"


class Bench:
    """An export view that is shown."""

    def __init__(self, folder: Path, text: str = TWO) -> None:
        self.design = DesignModel(text, sure_rig())
        self.view = ExportView(self.design, folder)
        self.design.on_change(self.view.renew)
        self.view.shown = True
        self.view.renew()
        self.wait()

    def wait(self) -> None:
        wait(self.view.worker)

    def said(self, name: str) -> str:
        return str(self.view.said[name].value)


def test_a_drive_is_prepared_judged_and_written(tmp_path: Path) -> None:
    bench = Bench(tmp_path / "drives")
    assert "ready to be written" in bench.said("status")
    assert missing(["dip", "mK"], bench.said("delivered")) == []
    assert "safety green" in bench.said("gate")
    assert "<svg" in bench.said("figure")
    bench.view.button.click()
    assert sorted(path.name for path in (tmp_path / "drives").glob("*.csv")) == ["dip.csv", "glow.csv"]
    assert str(tmp_path / "drives") in bench.said("written")
    assert json.loads((tmp_path / "drives" / "dip.json").read_text(encoding="utf-8"))["safety"]["colour"] == "green"


@pytest.mark.slow
def test_all_icons_are_written_with_the_detection_of_the_ranking_and_kept_unless_overwritten(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    ranking = rank(parse(TWO), sure_rig(), people=200, parameters=0)
    assert "detected by 200 virtual people" in bench.said("delivered")
    bench.view.button.click()
    assert len(list(tmp_path.iterdir())) == 4
    for score in ranking.icons:
        felt = json.loads((tmp_path / f"{score.name}.json").read_text(encoding="utf-8"))["perception"]
        assert felt["detected_by"] == "200 virtual people"
        assert felt["detected_probability"]["designed"] == pytest.approx(score.detected_probability, abs=1e-6)
    bench.view.button.click()
    assert missing(["nothing was written", "tick overwrite"], bench.said("written")) == []
    bench.view.overwrite.value = True
    bench.view.button.click()
    assert "wrote 2 drives" in bench.said("written")


def test_the_device_of_the_newest_drive_is_used_again(tmp_path: Path) -> None:
    for held, device in (('"name": "dac-12"', "dac-12"), ('"name": "gone"', "dac-16"), ("[", "dac-16")):
        (tmp_path / "dip.json").write_text(f'{{"device": {{{held}}}}}', encoding="utf-8")
        assert ExportView(DesignModel(TWO, sure_rig()), tmp_path).device.value == device


@pytest.mark.slow
def test_what_is_not_safe_is_never_written(tmp_path: Path) -> None:
    bench = Bench(tmp_path, HOT)
    for insist in (False, True):
        bench.view.insist.value = insist
        assert bench.view.button.disabled
    assert "unsafe icons are never written" in bench.said("status")
    assert "NOT SAFE" in bench.said("delivered")
    assert "safety red" in bench.said("gate")
    assert bench.view.ready is not None
    with pytest.raises(OutputError, match="hot: NOT SAFE"):
        replace(bench.view.ready, force=True).write(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_is_not_reached_is_written_only_on_request_and_not_into_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x", encoding="utf-8")
    for folder, said in ((tmp_path / "file", "it is a file"), (tmp_path / "drives", "wrote 1 drive")):
        bench = Bench(folder, STEEP)
        assert bench.view.button.disabled
        assert "only if you tick the box" in bench.said("status")
        bench.view.insist.value = True
        bench.view.button.click()
        assert said in bench.said("written")
    assert (tmp_path / "drives" / "cold.csv").exists()


def test_a_text_with_errors_is_not_exported(tmp_path: Path) -> None:
    bench = Bench(tmp_path)
    bench.design.receive({"type": "text", "text": TWO.replace("3 °C at", "3 at")})
    assert bench.view.button.disabled
    assert "the text has errors" in bench.said("status")
    bench.view.button.click()
    assert list(tmp_path.iterdir()) == []
    bench.design.receive({"type": "text", "text": TWO})
    bench.wait()
    assert not bench.view.button.disabled

"""Words that the workbench explains: the same as in the glossary, and at every place where they stand."""

from __future__ import annotations

from pathlib import Path

from thermicon.circuit import Rig
from thermicon.notebooks.timeline.frames import LIMITS, TERMS, frame_of
from thermicon.notebooks.timeline.scene import scene
from thermicon.notebooks.workbench.panels import help_html

GLOSSARY = Path(__file__).parents[3] / "docs" / "reference" / "glossary.md"


def test_words_mean_what_the_glossary_says() -> None:
    rows = GLOSSARY.read_text(encoding="utf-8").splitlines()
    for word, meaning in TERMS.items():
        assert f"| **{word}** | {meaning} |" in rows, word


def test_the_sheet_and_the_panel_of_sensation_explain_d_prime_and_clocks() -> None:
    html = help_html()
    assert "d′: distance in units of noise" in html
    assert f"limits of this simulation: {LIMITS}" in html
    made = frame_of(scene("cue 1; icon dip { cool by 3 K at 2 K/s; return at 2 K/s }", Rig.load("thenar")))
    panel = next(panel for panel in made.meta["panels"] if panel["key"] == "sensation")
    assert {"d′", "clock"} <= {word for word, _ in panel["terms"]}
    assert panel["digits"] == 1

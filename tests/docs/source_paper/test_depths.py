"""The depth that a probe on insulated skin resembles."""

import pytest

from source_paper.depths import resembles
from thermicon.circuit import Rig
from thermicon.icons import load_library

STEP = load_library("six-icons")["cooling-step"]
THENAR = Rig.load("thenar")


def test_closely_joined_skin_resembles_its_own_depth() -> None:
    for depth_mm in (0.4, 1.1, 3.0):
        pad = {"name": "pad", "place": "insulated skin", "lateral_mm": 0.02, "depth_mm": depth_mm}
        like = resembles(STEP, THENAR.with_(probe=[pad]), "pad", tail_s=10)
        assert like.depth_m == pytest.approx(depth_mm * 1e-3, rel=0.02)
        assert like.residual_K < 0.02


def test_likeness_is_said_with_its_residual() -> None:
    rig = THENAR.with_(probe=[{"name": "pad", "place": "insulated skin"}, {"name": "plate", "place": "display"}])
    assert repr(resembles(STEP, rig, "pad")) == (
        "Likeness(probe 'pad' is most like 2.49 mm, residual 0.059 K rms of 0.11 K)"
    )
    assert resembles(STEP, rig, "plate").depth_m == 0.0

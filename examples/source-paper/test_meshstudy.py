"""The mesh study: accuracy of the shipped mesh, errors of fixed elements at onset."""

from functools import cache

import numpy as np
import pytest

from source_paper.meshstudy import SHIPPED, WAYS, MeshStudy, mesh_study
from source_paper.paper import cooling_step
from source_paper.studydraw import plot_mesh_study
from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.steady import steady_state
from thermicon.icons import parse

THENAR, PAPER = Rig.load("thenar"), Rig.load("shani2021")
ON_A_CUE_K, ON_A_SWING_K = 5e-3, 20e-3

TIMES = np.linspace(0.0, 20.0, 201)
SWINGS = {
    "one slow wave": Drive(TIMES, 0.25 + 1.15 * np.sin(2 * np.pi * TIMES / 20)),
    "warmed, then cooled": Drive([0, 0.01, 5, 20], [0.08, -0.7, 1.5, 1.5], held=True),
    "warmed throughout": Drive([0, 0.01, 20], [0.08, -0.85, -0.85], held=True),
}
OTHER_SKINS = {
    "thenar": THENAR,
    "thin stratum corneum": THENAR.with_(**{"skin.layer.0.thickness_mm": 0.022, "skin.layer.1.thickness_mm": 0.08}),
    "thick stratum corneum": THENAR.with_(**{"skin.layer.0.thickness_mm": 0.3, "skin.cold_receptor_mm": 0.2}),
    "deeper receptors": THENAR.with_(**{"skin.cold_receptor_mm": 0.17, "skin.warm_receptor_mm": 0.4}),
}


@cache
def study(rig: str, control: str, way: str) -> MeshStudy:
    return mesh_study(Rig.load(rig), cooling_step(control), way=way)


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("control", ["skin", "display"])
@pytest.mark.parametrize("skin", OTHER_SKINS)
def test_the_shipped_mesh_is_within_5_mK_on_a_cue(skin: str, control: str, way: str) -> None:
    found = mesh_study(OTHER_SKINS[skin], cooling_step(control), way=way, meshes=[SHIPPED])
    assert found.reference_error_K < 0.2e-3  # halving the converged mesh changes it by this
    assert np.abs(found.error_K).max() + found.reference_error_K < ON_A_CUE_K, found


@pytest.mark.parametrize("drive", SWINGS)
@pytest.mark.parametrize("rig", [THENAR, PAPER], ids=lambda rig: rig.name)
def test_the_shipped_mesh_is_within_20_mK_on_a_swing_of_30_K(rig: Rig, drive: str) -> None:
    found = mesh_study(rig, SWINGS[drive], meshes=[SHIPPED])
    assert np.ptp(simulate_current(SWINGS[drive], rig).display_C) > 30.0
    assert np.abs(found.error_K).max() + found.reference_error_K < ON_A_SWING_K, found


def test_the_time_step_does_not_matter_to_the_study() -> None:
    once, twice = (mesh_study(THENAR, cooling_step("skin"), meshes=[SHIPPED], rate_Hz=rate) for rate in (1000, 2000))
    assert np.abs(twice.error_K[:, :, ::2] - once.error_K).max() < 0.1e-3
    assert np.abs(twice.reference_C[:, ::2] - once.reference_C).max() < 0.5e-3


def test_errors_fall_with_the_square_of_the_cell() -> None:
    coarse, fine = (np.abs(study("thenar", "display", "current").error_K[k]).max() for k in (1, 2))
    assert 3.0 < np.sqrt(coarse / fine) < 5.0  # two halvings, each a factor of about four


@pytest.mark.parametrize("control", ["skin", "display"])
def test_one_and_five_elements_are_too_few_at_onset_and_enough_later(control: str) -> None:
    found = study("shani2021", control, "temperature")
    place = next(k for k, mesh in enumerate(found.meshes) if mesh.elements == (1, 5))
    early = [max(found.part(place, t)) for t in (0.1, 0.2, 0.3, 0.5)]
    assert all(0.3 < part < 10 for part in early), early
    late = [part for t in (4.0, 5.0, 6.0) for part in found.part(place, t)]
    assert max(late) < 0.02, late


def test_a_study_is_a_table_and_a_picture() -> None:
    found = study("shani2021", "skin", "current")
    table = found.to_frame()
    assert (table["mesh"][3], table["lumps"][3]) == ("1 + 5 elements", 6)
    axes = plot_mesh_study(found)
    assert axes.get_title(loc="left").startswith("cooling-step (skin), same current")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", "error (mK)")


def test_a_cue_that_prescribes_current_plays_it_on_every_mesh() -> None:
    text = (
        "cue 1\nset pushes {\n control current\n}\nicon push {\n to 0.5 A over 1 s\n hold for 1 s\n return at 1 A/s\n}"
    )
    (push,) = parse(text).icons
    found = mesh_study(PAPER, push, meshes=[SHIPPED])
    rest = float(0.5 - steady_state(PAPER, "display", 32.0)[0])
    assert found.time_s[-1] == pytest.approx(2.0 + rest, abs=1e-6)  # it returns to the current that holds the rest
    assert np.abs(found.error_K).max() < 2e-3


def test_a_study_that_cannot_be_is_refused() -> None:
    with pytest.raises(RigError, match="way 'voltage' is not known; it is one of current, temperature"):
        mesh_study(PAPER, cooling_step("skin"), way="voltage")
    with pytest.raises(
        RigError, match="a drive prescribes no temperature to follow; compare meshes with way='current'"
    ):
        mesh_study(PAPER, Drive([0, 1], [0.1, 0.2]), way="temperature")

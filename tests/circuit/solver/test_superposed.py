"""Receptors by superposition beside the full solution: every shipped set, within half a millikelvin."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate_many
from thermicon.circuit.solver import batch
from thermicon.circuit.solver.simulate import duration_s
from thermicon.circuit.solver.superposed import MOST_CORNERS, PROBES, Superposed, corners_of, is_linear, superposed
from thermicon.icons import Icon, load_library, parse
from thermicon.icons.files.shipped import library_names

LARGEST_K = 0.5e-3
THENAR = Rig.load("thenar")


def people(rig: Rig) -> list[Rig]:
    """Three persons: the nominal one, one with a poor contact and one with thin skin."""
    contact, layer = rig.contact.resistance_m2K_per_W, rig.skin.layers[0].thickness_m * 1e3
    others = [(2.5 * contact, layer), (0.5 * contact, 0.7 * layer)]
    keys = ("contact.resistance_m2K_per_W", "skin.layer.0.thickness_mm")
    return [rig, *(rig.with_(**dict(zip(keys, values, strict=True))) for values in others)]


def both_ways(icons: Sequence[Icon], rig: Rig, monkeypatch: pytest.MonkeyPatch) -> tuple[float, list[Superposed]]:
    """Largest difference in K of the receptors from the full solution, and what was superposed."""
    end = math.ceil((max(duration_s(icon, rig) for icon in icons) + 3.0) * 100) / 100
    results: list[Superposed] = []

    def kept(*arguments: object) -> Superposed:
        results.append(superposed(*arguments))  # type: ignore[arg-type]
        return results[-1]

    def run() -> np.ndarray:
        asked = people(rig)
        return simulate_many(icons, asked, nominal=rig, end_s=end, probes=PROBES, tracking="display").values

    with monkeypatch.context() as patched:
        patched.setattr(batch, "superposed", kept)
        quick = run()
        patched.setattr(batch, "is_linear", lambda *_: False)
        return float(np.abs(quick - run()).max()), results


@pytest.mark.parametrize("name", library_names())
def test_every_shipped_set_is_within_half_a_millikelvin(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    icons = [icon for icon in load_library(name) if icon.context.control == "display"][:8]
    icons = icons or list(load_library("six-icons"))[:2]
    apart, _ = both_ways(icons, THENAR, monkeypatch)
    assert apart < LARGEST_K


@pytest.mark.parametrize("site", ["shani2021", "hand-dorsum"])
def test_other_rigs_are_too(site: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig.load(site)
    header = f"set a {{\n control display\n baseline {rig.skin.rest_C} °C\n}}\n"
    cue = f"cue 1\n{header}icon a {{\n cool by 3 °C at 1 °C/s\n hold for 1 s\n return at 2 °C/s\n}}"
    apart, results = both_ways(list(parse(cue)), rig, monkeypatch)
    assert apart < LARGEST_K
    assert len(results) == 1


def test_the_six_icons_are_superposed(monkeypatch: pytest.MonkeyPatch) -> None:
    apart, (result,) = both_ways(list(load_library("six-icons")), THENAR, monkeypatch)
    assert result.fine.all()
    assert apart < 0.1e-3


def test_lanes_at_a_limit_are_solved_in_full(monkeypatch: pytest.MonkeyPatch) -> None:
    weak = THENAR.with_(**{"driver.current_limit_A": 0.7})
    apart, (result,) = both_ways(list(load_library("six-icons")), weak, monkeypatch)
    assert 0 < result.fine.sum() < result.fine.size
    assert apart < LARGEST_K


def test_a_limit_that_is_only_near_counts_as_met(monkeypatch: pytest.MonkeyPatch) -> None:
    icons = list(load_library("six-icons"))[:1]
    needed = max(abs(batch.design(icon, THENAR, 9.0).drive.current_A).max() for icon in icons)
    close = THENAR.with_(**{"driver.current_limit_A": float(needed) * 1.01})
    _, (result,) = both_ways(icons, close, monkeypatch)
    assert not result.fine[0]


@pytest.mark.parametrize(
    "changes",
    [
        {"contact.lands_s": -0.2},
        {"module.leg_nodes": 3, "module.leg_capacity_J_per_K": 2.0},
        {"driver.update_Hz": 50},
        {"controller": {"kp_A_per_K": 1.0}},
    ],
    ids=["landing", "legs", "slow driver", "own loop"],
)
def test_what_is_not_linear_is_solved_in_full(changes: dict[str, object]) -> None:
    rows = np.arange(0.0, 1.0, 0.02)
    assert is_linear([THENAR], THENAR, PROBES, rows)
    other = THENAR.with_(**changes)
    assert not is_linear([other], other, PROBES, rows)


def test_only_receptors_at_ends_of_periods_are_superposed() -> None:
    assert not is_linear([THENAR], THENAR, ("skin_C",), np.array([0.0, 0.1]))
    assert not is_linear([THENAR], THENAR, PROBES, np.array([0.0, 0.005]))


def test_a_display_that_bends_everywhere_is_not_worth_it() -> None:
    wave = 30.0 + np.sin(np.linspace(0.0, 6.0, 2 * MOST_CORNERS))
    assert corners_of(wave[np.newaxis]) is None

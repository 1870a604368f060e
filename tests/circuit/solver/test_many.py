"""Many cues on many rigs, against one at a time or the full solution."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from thermicon.base.numbers.cores import at_most
from thermicon.circuit import Drive, Rig, design, simulate, simulate_current, simulate_many
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver import batch
from thermicon.circuit.solver.inverse import design_many
from thermicon.circuit.solver.simulate import duration_s
from thermicon.circuit.solver.superposed import MOST_CORNERS, PROBES, corners_of, is_linear, superposed
from thermicon.icons import Icon, load_library, parse
from thermicon.icons.files.shipped import names_on_one_element

THENAR = Rig.load("thenar")
OTHERS = [
    THENAR,
    THENAR.with_(**{"contact.resistance_m2K_per_W": 9e-4}),
    THENAR.with_(**{"skin.layer.0.thickness_mm": 0.26}),
]
OTHERS_TOO = [*OTHERS, Rig.load("shani2021"), Rig.load("fingertip")]
"""With different numbers of lumps."""
SIX = tuple(load_library("six-icons"))[:2]
SKIN = tuple(load_library("cooling-step-skin"))
PASSIVE = {"capacity_J_per_K": 90.0, "air_resistance_K_per_W": 1.5}


def test_display_tracking_is_each_rigs_own_run() -> None:
    batch = simulate_many(SIX, OTHERS, nominal=THENAR, end_s=12.0, tracking="display", probes=("cold_receptor_C",))
    assert batch.values.shape == (1, 3, 2, 1201) and not batch.values.flags.writeable
    for r, rig in enumerate(OTHERS):
        for i, icon in enumerate(SIX):
            alone = simulate(icon, rig, tail_s=12.0 - icon.corners(32.0).duration_s)
            assert batch["cold_receptor_C"][r, i] == pytest.approx(alone.cold_receptor_C, abs=1e-4)


@pytest.mark.parametrize("tracking", ["replay", "display", "ideal"])
@pytest.mark.parametrize("icons", [SIX[:1], SKIN], ids=["display cue", "skin cue"])
def test_a_rig_among_others_of_more_lumps_is_the_same_alone(tracking: str, icons: tuple[Icon, ...]) -> None:
    together = simulate_many(icons, OTHERS_TOO, nominal=THENAR, end_s=9.0, tracking=tracking)
    for r, rig in enumerate(OTHERS_TOO):
        alone = simulate_many(icons, [rig], nominal=THENAR, end_s=9.0, tracking=tracking)
        assert np.abs(together.values[:, r] - alone.values[:, 0]).max() < 1e-9, rig


def test_replay_plays_the_nominal_current_open_loop() -> None:
    batch = simulate_many(SKIN, OTHERS, nominal=THENAR, end_s=12.0, probes=("skin_C",))
    plan = design(SKIN[0], THENAR, 12.0)
    lead = Drive([0, *(plan.drive.time_s + 0.5)], [plan.rest_A, *plan.drive.current_A], held=True)
    for r, rig in enumerate(OTHERS):
        alone = simulate_current(lead, rig).skin_C[50:]
        assert batch["skin_C"][r, 0] == pytest.approx(alone, abs=1e-4), r
    change = batch["skin_C"][:, 0].min(axis=1) - batch["skin_C"][:, 0, 0]
    assert change[0] == pytest.approx(-6.0, abs=0.02)
    assert -5.9 < change[1] < -5.5, "the same current cools skin less through a worse contact"


def test_display_tracking_of_a_skin_cue_follows_the_nominal_display() -> None:
    probes = ("display_C", "skin_C")
    batch = simulate_many(SKIN, OTHERS, nominal=THENAR, end_s=12.0, tracking="display", probes=probes)
    nominal = simulate(SKIN[0], THENAR, tail_s=4.0)
    assert batch["display_C"][0, 0] == pytest.approx(nominal.display_C, abs=2e-3)
    assert np.abs(batch["display_C"][1, 0] - nominal.display_C).max() < 0.2
    assert np.abs(batch["skin_C"][1, 0] - nominal.skin_C).max() > 0.3


def test_ideal_gives_every_skin_the_same() -> None:
    batch = simulate_many(SKIN, OTHERS, nominal=THENAR, end_s=12.0, tracking="ideal", probes=("skin_C",))
    held = (batch.time_s > 3) & (batch.time_s < 5.9)
    assert batch["skin_C"][:, 0, held] == pytest.approx(26.0, abs=2e-3)


@pytest.mark.parametrize("probes", [("skin_C",), PROBES], ids=["in full", "superposed"])
def test_the_number_of_cores_changes_no_bit(probes: tuple[str, ...]) -> None:
    def run(count: int) -> bytes:
        with at_most(count):
            return simulate_many(SIX, OTHERS_TOO, nominal=THENAR, end_s=9.0, probes=probes).values.tobytes()

    assert run(1) == run(3)


def test_many_designs_are_the_single_ones_with_their_verdicts() -> None:
    weak = THENAR.with_(**{"driver.current_limit_A": 1.0})
    cues = [*load_library("six-icons"), *SKIN, *load_library("wave-shapes")]
    for icon, plan in zip(cues, design_many(cues, weak, 12.0), strict=True):
        alone = design(icon, weak, 12.0)
        assert np.abs(plan.drive.current_A - alone.drive.current_A).max() < 1e-6, icon.name
        assert plan.outcome.reached == alone.outcome.reached
        assert plan.outcome.reason == alone.outcome.reason
        assert plan.rest_A == alone.rest_A


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"icons": ()}, "at least one cue and one rig"),
        ({"rigs": []}, "at least one cue and one rig"),
        ({"end_s": float("nan")}, "a batch cannot end at nan s"),
        ({"end_s": 0.0}, "a batch cannot end at 0 s"),
        ({"tracking": "replays"}, "tracking 'replays' is not known; it is one of replay, display, ideal"),
        ({"nominal": THENAR.with_(**{"driver.update_Hz": 50})}, r"rigs of one batch must share driver\.update_Hz"),
        (
            {"rigs": [THENAR.with_(heat_sink=PASSIVE), THENAR]},
            r"rigs of one batch must all have a passive heat sink \(heat_sink\.air_resistance_K_per_W\) or none",
        ),
    ],
)
def test_an_impossible_batch_is_refused(changes: dict[str, object], words: str) -> None:
    given = {"icons": SIX, "rigs": [THENAR], "nominal": THENAR, "end_s": 9.0, **changes}
    with pytest.raises(RigError, match=words):
        simulate_many(**given)  # type: ignore[arg-type]


LARGEST_K = 0.5e-3


def people(rig: Rig) -> list[Rig]:
    """Three persons: the nominal one, one with a poor contact and one with thin skin."""
    contact, layer = rig.contact.resistance_m2K_per_W, rig.skin.layers[0].thickness_m * 1e3
    others = [(2.5 * contact, layer), (0.5 * contact, 0.7 * layer)]
    keys = ("contact.resistance_m2K_per_W", "skin.layer.0.thickness_mm")
    return [rig, *(rig.with_(**dict(zip(keys, values, strict=True))) for values in others)]


def both_ways(icons: Sequence[Icon], rig: Rig, monkeypatch: pytest.MonkeyPatch) -> tuple[float, list[np.ndarray]]:
    """Largest difference in K of the receptors from the full solution, and which lanes were far from every limit."""
    end = math.ceil((max(duration_s(icon, rig) for icon in icons) + 3.0) * 100) / 100
    results: list[np.ndarray] = []

    def kept(*arguments: object) -> tuple[np.ndarray, np.ndarray]:
        values, fine = superposed(*arguments)  # type: ignore[arg-type]
        results.append(fine)
        return values, fine

    def run() -> np.ndarray:
        asked = people(rig)
        return simulate_many(icons, asked, nominal=rig, end_s=end, probes=PROBES, tracking="display").values

    with monkeypatch.context() as patched:
        patched.setattr(batch, "superposed", kept)
        quick = run()
        patched.setattr(batch, "is_linear", lambda *_: False)
        return float(np.abs(quick - run()).max()), results


@pytest.mark.parametrize("name", names_on_one_element())
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
    assert result.all()
    assert apart < 0.1e-3


def test_lanes_at_a_limit_are_solved_in_full(monkeypatch: pytest.MonkeyPatch) -> None:
    weak = THENAR.with_(**{"driver.current_limit_A": 0.7})
    apart, (result,) = both_ways(list(load_library("six-icons")), weak, monkeypatch)
    assert 0 < result.sum() < result.size
    assert apart < LARGEST_K


def test_a_limit_that_is_only_near_counts_as_met(monkeypatch: pytest.MonkeyPatch) -> None:
    icons = list(load_library("six-icons"))[:1]
    needed = max(abs(batch.design(icon, THENAR, 9.0).drive.current_A).max() for icon in icons)
    for share, fine in ((1.02, False), (1.04, True)):
        close = THENAR.with_(**{"driver.current_limit_A": float(needed) * share})
        _, (result,) = both_ways(icons, close, monkeypatch)
        assert result[0] == fine


def test_what_is_not_linear_or_bends_everywhere_is_solved_in_full() -> None:
    rows = np.arange(0.0, 1.0, 0.02)
    assert is_linear([THENAR], THENAR, PROBES, rows)
    changes: list[dict[str, object]] = [{"driver.update_Hz": 50}, {"controller": {"kp_A_per_K": 1.0}}]
    for other in (THENAR.with_(**each) for each in changes):
        assert not is_linear([other], other, PROBES, rows)
    assert not is_linear([THENAR], THENAR, ("skin_C",), rows)
    assert not is_linear([THENAR], THENAR, PROBES, np.array([0.0, 0.005])), "between ends of periods"
    wave = 30.0 + np.sin(np.linspace(0.0, 6.0, 2 * MOST_CORNERS))
    assert corners_of(wave[np.newaxis]) is None

"""Sessions against checks by hand."""

import math
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Limits, Rig, SessionPlan, play_session, simulate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.exposure import cem43_min, henriques
from thermicon.circuit.safety.session_plan import LONGEST_S, MOST_PLAYS, SessionError, order_text, read_order
from thermicon.circuit.safety.sessionplay import drive_of
from thermicon.circuit.safety.verdict import energy_J, judge_safety, summarise
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import IconSet, load_library, parse, read_cue

WARM = """cue 1
set hot {{ control display; baseline 32 °C }}
icon hot {{ warm by {amount} °C at 3 °C/s; hold for 20 s; return at 3 °C/s }}
icon cool {{ cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }}
"""
RIG, SIX = Rig.load("thenar"), read_cue("six-icons")
STEP = SIX["cooling-step"]
SINK = ("capacity_J_per_K=200", "air_resistance_K_per_W=1.5")
"""A hot plate under its own loop."""


def hot_set(amount: float) -> IconSet:
    return parse(WARM.format(amount=amount))


@pytest.mark.parametrize(
    ("icons", "name", "tracking"),
    [("six-icons", "thenar", "replay"), ("six-icons", "thenar", "display"),
     ("cooling-step-skin", "shani2021", "replay"), ("cooling-step-skin", "fingertip", "replay")],
)  # fmt: skip
def test_a_session_of_one_icon_is_its_single_run(icons: str, name: str, tracking: str) -> None:
    played, rig = read_cue(icons), Rig.load(name)
    for icon in list(played)[::3]:
        session = play_session(played, SessionPlan((icon.name,)), rig, tracking=tracking)
        alone = simulate(icon, rig)
        for column in ("display_C", "skin_C", "cold_receptor_C", "warm_receptor_C", "hot_plate_C"):
            assert np.abs(getattr(session.trace, column) - getattr(alone, column)).max() < 1e-6, (icon.name, column)
        summary = summarise(alone)
        assert session.energy_J == pytest.approx(summary.energy_J, rel=1e-6)
        (play,) = session.plays
        assert (play.start_s, play.end_s, play.drift_K) == (0.0, summary.duration_s, 0.0)
        assert (play.skin_min_C, play.skin_max_C) == pytest.approx((summary.skin_min_C, summary.skin_max_C), abs=1e-6)
        assert play.verdict == judge_safety(alone).colour
        assert play.verdict == session.verdict or name != "thenar"  # in the worst case


@pytest.mark.parametrize("tracking", ["replay", "display"])
def test_two_icons_far_apart_are_two_single_runs(tracking: str) -> None:
    plan = SessionPlan(("cooling-step", "double-dip"), gap_s=1200.0)
    played = drive_of(plan, {icon.name: icon for icon in SIX}, RIG, tracking)
    assert played.starts_s == (0.0, 1208.0)
    run = simulate_current(played.drive, RIG, start_C=played.start_C)
    for name, start in zip(plan.order, played.starts_s, strict=True):
        alone, begin = simulate(SIX[name], RIG), round(start * 100)
        for column in ("display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
            part = getattr(run, column)[begin : begin + len(alone.time_s)]
            assert np.abs(part - getattr(alone, column)).max() < 2e-3, (name, column)


def test_plays_begin_a_gap_after_the_end_of_the_one_before_on_an_update() -> None:
    icons = parse("cue 1\nset s { control display; baseline 32 °C }\nicon odd { cool by 1 °C over 1.234 s }\n")
    slow = RIG.with_(**{"driver.update_Hz": 10.0})
    session = play_session(icons, SessionPlan(("odd",) * 3, gap_s=0.5), slow)
    # 1.234 + 0.5 = 1.734 → 1.8 s; 1.8 + 1.734 = 3.534 → 3.6 s
    assert [play.start_s for play in session.plays] == pytest.approx([0.0, 1.8, 3.6])
    assert [play.end_s for play in session.plays] == pytest.approx([1.234, 3.034, 4.834])
    assert np.diff(session.trace.time_s).max() == pytest.approx(0.01)  # 100 rows a second with any slower driver


def test_energy_and_dose_add_up() -> None:
    icons = hot_set(9.5)
    session = play_session(icons, SessionPlan(("hot", "cool", "hot", "hot"), gap_s=5.0), RIG)
    trace = session.trace
    assert sum(play.energy_J for play in session.plays) == pytest.approx(session.energy_J, rel=1e-9)
    power = trace.voltage_V[:-1] * trace.current_A[:-1]
    assert session.energy_J == pytest.approx(float(power @ np.diff(trace.time_s)), rel=1e-9)
    assert session.dose_cem43_min > 1e-3
    assert sum(play.dose_cem43_min for play in session.plays) == pytest.approx(session.dose_cem43_min, rel=1e-6)
    assert session.dose_cem43_min == pytest.approx(float(cem43_min(trace.time_s, trace.skin_C)[-1]))
    assert session.henriques == pytest.approx(float(henriques(trace.time_s, trace.skin_C)[-1]))
    worst = session.worst("thermal dose")
    assert worst.value > session.dose_cem43_min


def test_what_is_safe_once_is_not_safe_in_a_session() -> None:
    icons = hot_set(8.0)
    once = play_session(icons, SessionPlan(("hot",)), RIG)
    often = play_session(icons, SessionPlan(("hot",) * 4, gap_s=2.0), RIG)
    assert (once.verdict, often.verdict) == ("amber", "red")
    assert "skin surface" in str(often.reason)
    verdicts = [play.verdict for play in often.plays]
    assert verdicts == sorted(verdicts, key=("green", "amber", "red").index)


def test_replayed_drives_move_the_baseline_and_a_tracked_display_hardly() -> None:
    plan = SessionPlan(("cooling-step",) * 5)
    replayed, tracked = (play_session(SIX, plan, RIG, tracking=way) for way in ("replay", "display"))
    drifts = [play.drift_K for play in replayed.plays]
    assert drifts == pytest.approx([0.0, -0.80, -1.33, -1.69, -1.95], abs=0.02)
    assert replayed.baseline_drift_K == drifts[-1]
    assert replayed.duration_s == 4 * 10.0 + 5 * duration_s(STEP, RIG)
    frame = replayed.to_frame()
    assert list(frame.columns[:4]) == ["icon", "start_s", "end_s", "verdict"] and len(frame) == 5
    assert replayed.plot().get_xlabel() and "<svg" in replayed._repr_html_()
    assert abs(tracked.baseline_drift_K) < 0.25
    assert replayed.recovery_s > tracked.recovery_s > 0


def test_a_rate_is_not_averaged_away_in_a_long_session() -> None:
    icons = parse(
        "cue 1\nset s { control display; baseline 32 °C }\n"
        "icon jolt { step to 22 °C; hold for 1 s; step to 32 °C; hold for 1 s }\n"
    )
    plan = SessionPlan(("jolt",) * 24, gap_s=12.0)  # over 5 min, from where on the gate has 10 rows a second
    limits = Limits.of({"skin_rate_K_per_s": 9.4})
    session = play_session(icons, plan, RIG, limits=limits)
    assert session.duration_s > 300
    assert session.verdict == "red"
    rate = session.worst("rate of skin temperature")
    assert (rate.passed, rate.severity) == (False, "hard")
    skin, times = session.trace.skin_C, session.trace.time_s
    fine, coarse = (float(np.abs(np.diff(skin[::k]) / np.diff(times[::k])).max()) for k in (1, 10))
    assert coarse < 0.98 * fine < rate.value
    assert fine <= rate.value + 1e-9


def test_icons_that_prescribe_current_are_played_by_their_means() -> None:
    icons = parse("cue 1\nset s { control current }\nicon push { to 0.4 A over 2 s; hold for 1 s; return over 1 s }\n")
    session = play_session(icons, SessionPlan(("push",)), RIG)
    alone = simulate(icons["push"], RIG)
    assert np.abs(session.trace.skin_C - alone.skin_C).max() < 5e-3
    with pytest.raises(SessionError, match=r"push prescribes the current.*use tracking replay"):
        play_session(icons, SessionPlan(("push",)), RIG, tracking="display")


def test_a_loop_and_a_passive_sink_are_played() -> None:
    loop = RIG.with_(controller={"kp_A_per_K": 0.4, "ki_A_per_Ks": 0.3, "kd_As_per_K": 0.0, "lag_s": 0.05})
    sink = RIG.with_set([f"heat_sink.{each}" for each in SINK])
    for other in (loop, sink):
        session = play_session(SIX, SessionPlan(("cooling-step", "warming-step")), other)
        alone = simulate(STEP, other)
        assert np.abs(session.trace.skin_C[:801] - alone.skin_C).max() < 1e-6
    tracked = play_session(SIX, SessionPlan(("cooling-step", "warming-step")), loop, tracking="display")
    assert abs(tracked.trace.display_C[:801] - simulate(STEP, loop).display_C).max() < 1e-6


def test_shuffled_plans_are_balanced_and_seeded() -> None:
    names = ["a", "b", "c"]
    plan = SessionPlan.shuffled(names, 8, seed=3)
    assert {name: plan.order.count(name) for name in names} == dict.fromkeys(names, 8)
    assert plan == SessionPlan.shuffled(names, 8, seed=3)
    assert plan.order != SessionPlan.shuffled(names, 8, seed=4).order
    assert plan.order != tuple(names * 8)


def test_an_order_file_names_icons_by_line_or_comma(tmp_path: Path) -> None:
    path = tmp_path / "order.txt"
    path.write_text("# block 1\ncooling-step, double-dip\n\nwarming-step # the last\n", encoding="utf-8")
    order = read_order(path, SIX)
    assert order == ("cooling-step", "double-dip", "warming-step")
    path.write_text(order_text(SessionPlan(order)), encoding="utf-8")
    assert read_order(path, SIX) == order


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cooling-step\n\ncoolingstep\n", r":3: no icon is called 'coolingstep'; did you mean cooling-step"),
        ("# nothing\n,\n", "no icon in this order"),
        ("cooling-step\n" * (MOST_PLAYS + 1), "5,001 plays are too many; a session has at most 5,000"),
    ],
)
def test_a_wrong_order_is_told_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "order.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SessionError, match=message):
        read_order(path, SIX)


def test_impossible_plans_are_refused_before_any_work(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SessionError, match="at least one play"):
        SessionPlan(())
    for gap in (-1.0, math.nan, math.inf, 3601.0):
        with pytest.raises(SessionError, match=r"gap of .* s is outside 0 to 3600 s"):
            SessionPlan(("a",), gap_s=gap)
    with pytest.raises(SessionError, match="0 repeats are not possible"):
        SessionPlan.shuffled(["a"], 0)
    with pytest.raises(SessionError, match="1,000,000 repeats of 2 icons: 2,000,000 plays are too many"):
        SessionPlan.shuffled(["a", "b"], 1_000_000)
    with pytest.raises(SessionError, match="the plan names warming-step, which is not among the icons"):
        play_session([STEP], SessionPlan(("warming-step",)), RIG)
    with pytest.raises(RigError, match="cannot be held"):
        play_session(SIX, SessionPlan(("cooling-step",)), RIG.with_(**{"driver.current_limit_A": 0.01}))
    monkeypatch.setattr("thermicon.circuit.safety.sessionplay.design", None)  # nothing may be designed
    with pytest.raises(SessionError, match=rf"last \d+ s; the limit is {LONGEST_S:g} s: play fewer, shorten the gap"):
        play_session(SIX, SessionPlan(("cooling-step",) * 100, gap_s=120.0), RIG)
    fast = RIG.with_(**{"driver.update_Hz": 10_000.0})
    with pytest.raises(SessionError, match=r"driver's 10000 Hz are \d+ rows; the limit is 1,500,000"):
        play_session(SIX, SessionPlan(("cooling-step",) * 60), fast)
    with pytest.raises(SessionError, match="tracking 'ideal' is not known"):
        play_session(SIX, SessionPlan(("cooling-step",)), RIG, tracking="ideal")


def test_every_extreme_is_that_of_its_column() -> None:
    trace = simulate(STEP, RIG)
    found = summarise(trace).to_dict()
    assert found["skin_min_C"] == trace.skin_C.min()
    assert found["skin_max_C"] == trace.skin_C.max()
    assert found["heat_flow_cold_receptor_min_W_per_m2"] == trace.heat_flow_cold_receptor_W_per_m2.min()
    assert found["voltage_max_V"] == trace.voltage_V.max()
    assert found["duration_s"] == 8.0
    assert (found["reached"], found["safe"], found["safety"], found["reason"]) == (True, True, "green", None)
    assert list(found)[:5] == ["duration_s", "reached", "largest_miss_K", "largest_miss_s", "rms_miss_K"]
    assert list(found)[-3:] == ["safe", "safety", "reason"]
    assert all(np.isfinite(value) for value in found.values() if isinstance(value, float))


def test_energy_is_power_times_time_whatever_the_rows() -> None:
    trace = simulate_current(Drive([0, 10], [0.5, 0.5]), Rig.load("shani2021"))
    hot, cold = float(trace.hot_plate_C[0]), float(trace.display_C[0])
    power = 0.5 * (0.0521 * (hot - cold) + 0.5 * 6.35)  # V·I with V = α(Th − Tc) + IR, written out
    assert summarise(trace).energy_J == pytest.approx(10 * power, rel=1e-9)
    for icon in (STEP, load_library("cooling-step-skin").icons[0]):
        coarse, fine = (energy_J(simulate(icon, RIG, rate_Hz=rate)) for rate in (100.0, 2000.0))
        assert coarse == pytest.approx(fine, rel=2e-3)
    held = simulate(STEP, RIG)  # each row's power counts until the next
    assert energy_J(held) == pytest.approx(float((held.voltage_V * held.current_A)[:-1].sum()) * 0.01, rel=1e-9)


def test_a_miss_and_a_hazard_say_why_and_without_a_target_there_is_no_miss() -> None:
    weak = summarise(simulate(STEP, RIG.with_(**{"driver.current_limit_A": 0.6})))
    assert weak.reached is False
    assert weak.reason is not None and weak.reason.startswith("misses its target by")
    burns = summarise(simulate_current(Drive([0, 1, 30], [0, -1.5, -1.5]), RIG))
    assert (burns.safe, burns.safety) == (False, "red")
    assert burns.reason is not None and "above the hard limit of" in burns.reason
    assert (burns.reached, burns.largest_miss_K, burns.largest_miss_s, burns.rms_miss_K) == (None,) * 4

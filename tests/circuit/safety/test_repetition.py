"""Repeated plays against brute force."""

import json
from dataclasses import replace

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import worst_case
from tests.circuit.delivery.replay import Held, Player
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Drive, Limits, Rig, gate
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.safety import playmap
from thermicon.circuit.safety.checks import Before
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.gate import Gate, gate_set
from thermicon.circuit.safety.plant import recovery_s
from thermicon.circuit.safety.playmap import PlayMap
from thermicon.circuit.safety.repeated import PauseError, Repeating, shortest_pause_s
from thermicon.circuit.safety.tally import HOTTEST_C, WATCHED, Tally
from thermicon.circuit.solver.batch_inputs import State
from thermicon.icons import parse

THENAR = Rig.load("thenar")
REST = 0.08
COOL = Drive([0, 0.5, 2.5, 3.5], [REST, 0.7, REST, REST], held=True)
WARM = Drive([0, 1.0, 3.0, 4.0], [REST, -0.4, -0.4, REST])
BOTH = Drive([0, 0.5, 1.5, 2.5], [REST, 0.5, -0.3, REST], held=True)
HOT = (
    'cue 1\nset h "hot" { site thenar\n control display\n baseline 32 °C }\n'
    "icon glow { warm by 7 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
)


def few(rig: Rig = THENAR) -> Ensemble:
    """The rig as given and corners far apart."""
    return Ensemble.of(rig).only([0, 1, 22, 43, 64])


PLAYS = [CurrentPlay(drive, REST) for drive in (COOL, WARM, BOTH)]


def simulated(plant: CurrentPlant, play: CurrentPlay, pause_s: float, state: State) -> State:
    """States after a play and its pause, without the plant's map."""
    ended = plant.ensemble.end_of(play.drive, state)
    return ended if pause_s <= 0.0 else plant.ensemble.rest(play.rest_A, ended, pause_s)


def test_a_steady_cycle_is_what_sixty_plays_come_to() -> None:
    plant = CurrentPlant.of(few())
    for play in PLAYS:
        start = state = plant.rest(play)
        for _ in range(60):
            state = simulated(plant, play, 60.0, state)
        assert np.abs(plant.cycle(play, 60.0).nodes_C - state.nodes_C).max() < 5e-3
        assert np.abs(state.nodes_C - start.nodes_C).max() > 0.02, "it is not the rest"


def test_short_plays_without_a_pause_still_have_their_cycle() -> None:
    """A second forgets little: a thousand plays are needed, and a few would not tell."""
    plant = CurrentPlant.of(few())
    steady = plant.cycle(PLAYS[2], 0.0)
    assert steady.nodes_C.max() < HOTTEST_C, "each corner has one"
    again = simulated(plant, PLAYS[2], 0.0, steady)
    assert np.abs(again.nodes_C - steady.nodes_C).max() < 1e-6


def test_what_heats_without_end_has_no_cycle() -> None:
    plant, play = CurrentPlant.of(few().only([0])), CurrentPlay(Drive([0, 1], [-6.0, -6.0]), REST)
    assert (plant.cycle(play, 0.0).nodes_C[:, :-1] == HOTTEST_C).all()


def test_a_play_is_said_to_settle_where_its_repetition_does() -> None:
    """Maps of nodes that warm each other very unequally, whose repetition grows or shrinks by 2 % a play."""
    random = np.random.default_rng(6)
    plain = 10.0 ** random.uniform(-3.0, 1.0, (200, 4, 4))
    largest = np.abs(np.linalg.eigvals(plain)).max(axis=1)
    for factor, settles in ((0.98, True), (1.02, False)):
        matrix = factor * plain / largest[:, np.newaxis, np.newaxis]
        assert (PlayMap(matrix, np.ones((200, 4))).fixed_point()[1] == settles).all()


@pytest.mark.parametrize(("pause_s", "near_K"), [(0.0, 15.0), (3.0, 6.0), (20.0, 2.0)])
def test_bounds_enclose_thirty_plays_in_any_order(pause_s: float, near_K: float) -> None:
    plant = CurrentPlant.of(few())
    steady, start = [plant.cycle(play, pause_s) for play in PLAYS], plant.rest(PLAYS[0])
    warm = plant.bound(PLAYS, pause_s, steady, warm=True).nodes_C
    cold = plant.bound(PLAYS, pause_s, steady, warm=False).nodes_C
    rng, nearest = np.random.default_rng(2), np.inf
    for _ in range(3):
        state = start
        for k in rng.integers(0, 3, 30):
            state = simulated(plant, PLAYS[k], pause_s, state)
            assert (state.nodes_C <= warm + 1e-6).all()
            assert (state.nodes_C >= cold - 1e-6).all()
            nearest = min(nearest, float((warm - state.nodes_C)[:, 1].min()))
    assert nearest < near_K, "bounds are of use: the display comes near them"
    for play in PLAYS:  # what no order can pass, since no play leads out
        assert (simulated(plant, play, pause_s, State(warm)).nodes_C <= warm + 1e-5).all()
        assert (simulated(plant, play, pause_s, State(cold)).nodes_C >= cold - 1e-5).all()


def test_pauses_asked_in_turns_do_not_get_each_others_bounds() -> None:
    plant = CurrentPlant.of(few())
    repeating = Repeating(plant, [[play] for play in PLAYS], Limits.shipped())
    for pause_s in (3.0, 20.0, 3.0, 0.0, 3.1, 20.0):
        steady, warm, cold = repeating.bounds(pause_s)
        for play, cycle in zip(PLAYS, steady, strict=True):
            assert np.abs(simulated(plant, play, pause_s, cycle).nodes_C - cycle.nodes_C).max() < 1e-5
            assert (simulated(plant, play, pause_s, warm).nodes_C <= warm.nodes_C + 1e-5).all()
            assert (simulated(plant, play, pause_s, cold).nodes_C >= cold.nodes_C - 1e-5).all()


def test_bounds_of_a_set_hold_where_one_drive_warms_the_sink_and_another_the_display() -> None:
    """A passive sink that coolings have warmed makes the next warming warmer than any number of warmings."""
    sink = {"temperature_C": 28.0, "capacity_J_per_K": 40.0, "air_resistance_K_per_W": 0.5}
    plant = CurrentPlant.of(few(THENAR.with_(**{"skin.elements": [1] * 5}, heat_sink=sink)).only([0, 3]))
    cool, warm = (CurrentPlay(Drive([0, 0.5, 2.0, 4.0], [REST, amps, REST, REST], held=True), REST) for amps in (1, -1))
    steady = [plant.cycle(play, 20.0) for play in (cool, warm)]
    most, least = (plant.bound([cool, warm], 20.0, steady, side).nodes_C for side in (True, False))
    rng, beyond = np.random.default_rng(3), 0.0
    for order in ([0] * 29 + [1], [1] * 29 + [0], *rng.integers(0, 2, (3, 30))):
        state = plant.rest(cool)
        for k in order:
            state = simulated(plant, (cool, warm)[k], 20.0, state)
            assert (state.nodes_C <= most + 1e-6).all()
            assert (state.nodes_C >= least - 1e-6).all()
            beyond = max(beyond, float((state.nodes_C - np.max([one.nodes_C for one in steady], axis=0)).max()))
    assert beyond > 0.1, "the bounds are no mere steady cycles"
    read = [
        [network.read(nodes, name) for name in WATCHED]
        for network, nodes in zip(plant.ensemble.networks, most, strict=True)
    ]
    assert plant.now(cool, State(most)) == pytest.approx(np.transpose(read)), "the sink is not taken for a lump"


def test_recovery_is_when_display_and_skin_are_back() -> None:
    ensemble = few()
    start = ensemble.at_rest(REST)
    end = ensemble.end_of(COOL, start)
    plant = CurrentPlant.of(ensemble)
    found = recovery_s(plant, PLAYS[0], start, end)
    times = np.arange(0.0, 2 * found, 0.02)
    values = ensemble.hold(REST, end, times)[0]
    began = ensemble.hold(REST, start, np.array([0.0, 1.0]))[0][:, :, :1]
    assert plant.now(PLAYS[0], start) == pytest.approx(began[:, :, 0])
    which = [WATCHED.index("display_C"), WATCHED.index("skin_C")]
    away = (np.abs(values - began)[which] > 0.1).any(axis=(0, 1))
    last = times[np.flatnonzero(away)[-1]]
    assert last <= found <= last + 1.02, "rows stand 0.1 s apart, later 1 s"


def played_thirty_times(drive: Drive, ensemble: Ensemble, pause_s: float, off_s: float = 1e-3) -> float:
    """Warmest skin in °C of thirty plays with pauses between, and of a time without current after the last."""
    state, warmest, skin = ensemble.at_rest(REST), -np.inf, WATCHED.index("skin_C")
    for number in range(30):
        state = ensemble.rest(REST, state, pause_s) if number else state
        for (_, values), then in ensemble.play(drive, state):
            warmest, state = max(warmest, float(values[skin].max())), then
    return max(warmest, float(ensemble.hold(0.0, state, np.linspace(0.0, off_s, 601))[0][skin].max()))


def test_the_shortest_pause_is_safe_and_a_tenth_less_is_not() -> None:
    rig = sure_rig()
    drive = Drive([0, 2.0, 10.0, 12.0], [REST, -0.2, -0.2, REST])
    ensemble = Ensemble.of(rig)
    once = played_thirty_times(drive, ensemble, 600.0)
    limits = Limits.of({"skin_highest_C": 40.0, "skin_highest_soft_C": 39.5})
    assert once < 39.5, "zero current leads to 39.1 °C"
    repeating = Repeating(CurrentPlant.of(ensemble), [[CurrentPlay(drive, REST)]], limits)
    shortest = shortest_pause_s(repeating)
    assert shortest > 3.0
    assert repeating.safe(shortest)
    assert not repeating.safe(0.9 * shortest)
    assert played_thirty_times(drive, ensemble, shortest) <= 40.0
    assert played_thirty_times(drive, ensemble, 0.5 * shortest) > 40.0, "the limit is real, not only a bound's"


def test_the_shortest_pause_waits_until_zero_current_after_a_play_is_safe_too() -> None:
    drive = Drive([0, 1.0, 3.5, 4.5, 9.8, 10.8], [REST, -0.13, -0.13, 0.02, 0.02, REST], held=True)
    ensemble, limits = Ensemble.of(sure_rig()), Limits.of({"skin_highest_C": 38.96, "skin_highest_soft_C": 38.0})
    shortest = shortest_pause_s(Repeating(CurrentPlant.of(ensemble), [[CurrentPlay(drive, REST)]], limits))
    kept_C, passed_C = (played_thirty_times(drive, ensemble, share * shortest, 600.0) for share in (1.0, 0.5))
    assert kept_C <= 38.96 < passed_C


def test_a_pause_that_cannot_be_is_told() -> None:
    for pause in (-1.0, 600.5, float("nan")):
        with pytest.raises(PauseError, match=r"s between plays is not possible; give 0 to 600 s"):
            gate(COOL, THENAR, pause_s=pause)


@pytest.mark.slow
def test_what_glows_again_after_five_seconds_is_refused_and_after_its_recovery_is_not() -> None:
    rig = sure_rig("thenar", "contact_resistance_relative", "gain_relative", "ambient_K", "heat_sink_K")
    delivery = deliver(parse(HOT)["glow"], rig, Device.load("dac-16"))
    usual, soon = worst_case(delivery), worst_case(delivery, 5.0)
    assert usual.colour in ("green", "amber")
    assert usual.repeated.recovery_s == usual.repeated.pause_s > 60.0
    assert soon.colour == "red"
    assert soon.repeated.shortest_pause_s == usual.repeated.shortest_pause_s
    assert soon.reason.startswith("skin surface reaches 4")
    assert "repeated plays with 5 s of pause" in soon.reason
    assert f"the shortest safe pause is {soon.repeated.shortest_pause_s:g} s" in soon.reason
    assert 5.0 < float(soon.repeated.shortest_pause_s or 0) < usual.repeated.pause_s


def test_one_drive_of_a_set_counts_for_the_others_and_a_red_one_does_not() -> None:
    rig = sure_rig()
    alone = gate(BOTH, rig, rest_A=REST, pause_s=10.0)
    strong = Drive([0, 1.0, 3.0, 4.0], [REST, 6.0, 6.0, REST])
    beside, _ = gate_set([(BOTH, REST), (WARM, REST)], rig, pause_s=10.0)
    without, red = gate_set([(BOTH, REST), (strong, REST)], rig, pause_s=10.0)

    def warmest(one: Gate) -> float:
        return max(c.value for c in one.repeated.checks if (c.quantity, c.upper) == ("display", True))

    assert beside.repeated.checks != alone.repeated.checks
    assert (without.checks, red.colour) == (alone.checks, "red")
    assert warmest(beside) > warmest(alone)


def test_a_bound_that_starts_where_it_ends_is_found_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    plant = CurrentPlant.of(few())
    steady = plant.cycle(PLAYS[0], 5.0)
    plant._rests[PLAYS[0]] = steady
    solved, plain = [], playmap._solved

    def counted(matrix: np.ndarray, constant: np.ndarray) -> np.ndarray:
        solved.append(len(matrix))
        return plain(matrix, constant)

    monkeypatch.setattr(playmap, "_solved", counted)
    found = plant.bound(PLAYS[:1], 5.0, [steady], warm=True)
    assert np.abs(found.nodes_C - steady.nodes_C).max() < 1e-9
    assert len(solved) <= 3


def rate_of(tally: Tally) -> float:
    """The fastest fall of the skin in K/s."""
    return min(check.value for check in tally.checks() if check.quantity == "rate of skin temperature")


def test_a_play_that_follows_another_has_the_rates_of_both_played_on() -> None:
    plant = CurrentPlant.of(few())
    steady = [plant.cycle(play, 0.5) for play in PLAYS]
    tallies = plant.following(PLAYS, 0.5, steady, plant.begun_C(PLAYS)[0], THENAR.limits, 0)
    worst = {}
    for name, others in {"own": [0], "another": [1, 2]}.items():
        fastest = np.inf
        for other in others:
            for before in (plant.rest(PLAYS[other]), *([steady[other]] if name == "another" else [])):
                state = simulated(plant, PLAYS[other], 0.5, before)
                for (rows, values), _ in plant.play(PLAYS[0], state):
                    fastest = min(fastest, float((np.diff(values[0]) / np.diff(rows)).min()))
        worst[name] = fastest
    own = [tally.run.before for tally in tallies].index(Before("once", 0.5))
    assert rate_of(tallies[own]) == pytest.approx(worst["own"], rel=0.02)
    said = min(
        rate_of(tally) for tally in tallies if tally.run.before in (Before("another", 0.5), Before("others", 0.5))
    )
    assert said == pytest.approx(worst["another"], rel=0.02)
    assert said < rate_of(tallies[own])


def test_a_second_play_without_a_pause_is_too_fast_where_the_first_and_the_thirtieth_are_not() -> None:
    """Found among 10,000 random drives: −9.3 K/s at first, −9.98 in the steady cycle, −10.06 in the second play."""
    rig = Rig.load("shani2021").with_(
        **{"heat_sink.temperature_C": 29.44, "heat_sink.resistance_K_per_W": 0.4787, "module.cold_plate_J_per_K": 1.435,
           "module.hot_plate_J_per_K": 4.17, "module.seebeck_V_per_K": 0.06812, "contact.area_cm2": 12.53,
           "contact.resistance_m2K_per_W": 0.0004196, "driver.current_limit_A": 1.318, "driver.update_Hz": 20.0,
           "skin.elements": [1, 5]}
    )  # fmt: skip
    text = (
        "cue 1\nset s { control display\n baseline 34.4 °C }\n"
        "icon a { cool by 10.86 °C at 14.27 °C/s\n hold for 1.12 s\n return at 0.81 °C/s }\n"
    )
    verdict = worst_case(deliver(parse(text)["a"], rig, Device.load("dac-14")), 0.0)
    assert "second play after 0 s of pause" in str(verdict.repeated.reason)
    assert "rate of skin temperature reaches −10.0" in str(verdict.repeated.reason)
    assert 0.0 < (verdict.repeated.shortest_pause_s or 0.0) < 1.0


def test_the_pause_that_is_judged_safe_is_no_shorter_than_the_shortest() -> None:
    again = gate(WARM, sure_rig()).repeated
    assert again.reason is None
    assert again.shortest_pause_s is not None and again.shortest_pause_s <= again.pause_s


def test_a_rate_that_is_worst_after_a_longer_pause_lengthens_the_shortest() -> None:
    """A plate that warms back towards rest is fastest a second after the end: the play that begins then is, too."""
    rig = sure_rig("shani2021").with_(**{"heat_sink.resistance_K_per_W": 2.0})
    drive = Drive([0, 0.2, 0.4, 4.4, 5.4], [-0.6, 0.8, 0.1, 0.5, 0.15], held=True)
    player = Player(json.loads(rig.document), np.random.default_rng(0), extra=0)
    held = replace(Held.of(drive.time_s, drive.current_A, drive.current_A**2), rest=(0.15, 0.15**2))

    def fastest(state: np.ndarray) -> float:
        rows, steps, _ = player.play(held, state)
        return float(np.abs(np.diff(rows[:, 0, 0, 0]) / steps).max())

    def after(pause_s: float) -> float:
        return fastest(player.through(held, player.rest(held), pause_s))

    limit = 2.53
    assert max(fastest(player.rest(held)), after(0.0)) < limit - 0.03 < limit + 0.03 < after(1.0)
    found = gate(drive, rig, pause_s=0.0, rest_A=0.15, limits=Limits.of({"skin_rate_K_per_s": limit})).repeated
    assert "second play after 1 s of pause" in str(found.reason)
    shortest = found.shortest_pause_s or 0.0
    assert all(after(shortest + more) <= limit for more in (0.0, 0.3, 1.0, 2.0, 4.0, 8.0, 15.0, 60.0))

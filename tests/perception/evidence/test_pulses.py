"""Memory of short pulses."""

import re
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.builders import dprime_from_memory, population_dprime
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig, simulate
from thermicon.circuit.solver.simulate import simulate_all
from thermicon.icons import IconSet, load_library, read_cue
from thermicon.icons.language.parse import parse
from thermicon.notebooks.cli.main import app
from thermicon.perception import Observer, perceive
from thermicon.perception.evidence.pulses import short_pulses
from thermicon.perception.identification.carry_over import carry_over
from thermicon.perception.identification.confusion import embed
from thermicon.perception.identification.delivered import judge_delivered
from thermicon.perception.identification.episodes import EpisodesError
from thermicon.perception.identification.map import stress
from thermicon.perception.observer.observer import DATA
from thermicon.perception.observer.people import draw_people
from thermicon.perception.selection.pool import Pool

CUES, RIG = DATA / "short-pulses.cue", "tcs2"
HEAD = "cue 1\nset pulses { site thenar; control skin; baseline 32 °C }\n"


def excess(apart: Array) -> float:
    """By how much d′ of a pair exceeds the way over a third icon, at most, in d′."""
    icons = apart.shape[-1]
    return max(
        float((apart[:, :, j] - apart[:, :, k] - apart[:, k, j][:, None]).max())
        for j, k in permutations(range(icons), 2)
    )


@pytest.mark.parametrize(
    ("icons", "rig", "bent"),
    [
        (load_library("six-icons"), "thenar", 0.05),
        (load_library("pulse-sequences"), "thenar", 0.05),
        pytest.param(load_library("wave-shapes"), "thenar", 0.05, marks=pytest.mark.slow),
        pytest.param(load_library("wilson-ramps"), "thenar", 0.05, marks=pytest.mark.slow),
        pytest.param(load_library("wave-confusions"), "thenar", 0.05, marks=pytest.mark.slow),
        pytest.param(read_cue(CUES), RIG, 0.07, marks=pytest.mark.slow),
    ],
    ids=lambda given: getattr(given, "name", given),
)
def test_memory_keeps_distances(icons: IconSet, rig: str, bent: float) -> None:
    """No cost is so high that d′ are no distances any more, which points in space would have to bend."""
    apart = population_dprime(list(icons), Rig.load(rig), draw_people(8, 3))
    assert excess(apart) < 0.3
    assert stress(apart, embed(apart)).max() < bent


def dprime(one: str, other: str) -> float:
    icons, rig = parse(f"{HEAD}icon one {{ {one} }}\nicon other {{ {other} }}\n"), Rig.load("thenar")
    felt = [perceive(simulate(icon, rig, tail_s=12.0 - 4.0)) for icon in icons]
    return dprime_from_memory(felt)


def test_a_second_pulse_counts_and_cold_is_not_warm() -> None:
    cold, warm = (f"change by {by} °C at 4 °C/s; hold for 500 ms; return at 4 °C/s; rest for 500 ms" for by in (-3, 3))
    assert dprime(f"{cold}; {warm}", f"{cold}; {warm}; {warm}") > 2.0
    assert dprime(cold, warm) > 5.0


@pytest.mark.slow
@pytest.mark.parametrize("rig", ["thenar", "tcs2"])
def test_trains_of_any_length_differ(rig: str) -> None:
    trains = "".join(
        f"icon t{n} {{ repeat {n} {{ change by -3 °C at 6 °C/s; return at 6 °C/s; rest for 300 ms }} }}\n"
        for n in range(7, 21)
    )
    icons = parse(HEAD.replace("skin", "display") + trains)
    apart = population_dprime(list(icons), Rig.load(rig), draw_people(24, 11))
    assert np.median(apart, axis=0)[~np.eye(len(trains.splitlines()), dtype=bool)].min() > 0.5


LONG = "icon long { repeat 80 { change by -3 °C at 9 °C/s; return at 9 °C/s; rest for 200 ms } }\n"
PLAIN = "icon plain(by in [-3, -2] °C) { change by by at 3 °C/s; hold for 1 s; return at 3 °C/s }\n"


TRAINS = HEAD.replace("control skin", "control display").replace("thenar", "forearm") + LONG + PLAIN


def test_an_icon_with_too_many_episodes_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "trains.cue").write_text(TRAINS, encoding="utf-8")
    result = CliRunner().invoke(app, ["improve", str(tmp_path / "trains.cue"), "--people", "4", "--rig", RIG])
    assert result.exit_code == 1, result.output
    assert re.match(
        r"long: felt as \d\d separate episodes of cold and warmth; .* at most 64 of an icon: give", result.output
    )


def test_it_is_named_wherever_it_is_met() -> None:
    """Between icons, after icons, among those of a file as a device delivers them, and for pairs of percepts."""
    rig = Rig.load(RIG)
    icons = list(parse(TRAINS))[:2]
    traces = simulate_all(icons, rig, end_s=75.0)
    pools = [Pool.of(some, rig, Observer.load(), end_s=75.0) for some in (icons[:1], icons[1:])]
    for met in (
        lambda: dprime_from_memory([perceive(trace) for trace in traces]),
        lambda: carry_over(icons, rig, 75.0, 3.0),
        lambda: judge_delivered(["long", "other"], traces, traces),
        lambda: pools[0].dprimes(pools[1], "episodes", Observer.load()),
    ):
        with pytest.raises(EpisodesError, match=r"^long: felt as"):
            met()


@pytest.mark.slow
def test_chosen_pulses_are_named_better_than_those_of_chance_and_fewer_better_than_more() -> None:
    found = {one.quantity.removeprefix("proportion correct, "): one for one in short_pulses("temperature", 12, 6, 0)}
    most, fewer, chance = (found[name].value for name in ("best 22", "best 16", "mean of random 22"))
    assert chance + 0.05 < most < fewer < 1.0
    assert all(found[f"best {count}"].low < found[f"best {count}"].value for count in (22, 16))
    assert found["best 22"].baseline < most - 0.1

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.builders import population_dprime, steps
from thermicon.circuit import Rig, simulate
from thermicon.circuit.safety.verdict import judge_safety
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import Icon, IconSet, parse
from thermicon.icons.model.changes import numbers_of, repeated, with_number
from thermicon.perception import cheapest_edit, draw_people, rank
from thermicon.perception.criteria import DISTINGUISHABLE_DPRIME
from thermicon.perception.selection import candidate_edits
from thermicon.perception.selection.candidate_edits import worse
from thermicon.perception.selection.edit import Edit, NoEdit

PEOPLE, WANTED = 40, 1.3 * DISTINGUISHABLE_DPRIME


@pytest.fixture(scope="module")
def found(six: IconSet, rig: Rig) -> Edit:
    ranking = rank(six, rig, people=PEOPLE, parameters=0)
    edit = cheapest_edit(ranking, "warming-step", "linear-warming", wanted=WANTED)
    assert isinstance(edit, Edit)
    return edit


def changed(six: IconSet, edit: Edit) -> list[Icon]:
    return [edit.edited if icon.name == edit.icon else icon for icon in six]


def test_an_edit_is_one_line_that_reads_back(six: IconSet, found: Edit) -> None:
    before = next(icon for icon in six if icon.name == found.icon)
    assert parse(str(found.edited))[found.icon] == found.edited
    old, new = (text.splitlines() for text in (str(before), str(found.edited)))
    differ = [(a.strip(), b.strip()) for a, b in zip(old, new, strict=True) if a != b]
    assert differ == [(found.old, found.new)]


def test_it_parts_the_pair_for_people_and_harms_no_other(six: IconSet, found: Edit, rig: Rig) -> None:
    crowd = draw_people(PEOPLE, 0)
    names = [icon.name for icon in six]
    i, j, edited = names.index("warming-step"), names.index("linear-warming"), names.index(found.icon)
    before = np.median(population_dprime(list(six), rig, crowd), axis=0)
    after = np.median(population_dprime(changed(six, found), rig, crowd), axis=0)
    assert before[i, j] < WANTED <= after[i, j]
    assert found.d_prime == pytest.approx(after[i, j], abs=0.01)
    for k in set(range(6)) - {i, j}:
        assert after[edited, k] >= min(before[edited, k] - 0.11, 2.0 * WANTED)


def test_it_is_safe_and_reached_and_costs_what_is_said(six: IconSet, found: Edit, rig: Rig) -> None:
    trace = simulate(found.edited, rig)
    assert trace.reachable
    assert judge_safety(trace).safe
    before = next(icon for icon in six if icon.name == found.icon)
    added = duration_s(found.edited, rig) - duration_s(before, rig)
    one, two = numbers_of(before, 32.0), numbers_of(found.edited, 32.0)
    ratios = [abs(np.log(b.value / a.value)) for a, b in zip(one, two, strict=True) if a.value != b.value]
    assert len(ratios) == 1
    assert found.added_s == pytest.approx(added)
    assert found.cost == pytest.approx(ratios[0] + 0.1 * max(added, 0.0))


def test_what_needs_no_edit_and_what_no_edit_can_do_is_told(six: IconSet, rig: Rig) -> None:
    ranking = rank(six, rig, people=8, parameters=0)
    edit = cheapest_edit(ranking, "cooling-step", "warming-step")
    assert isinstance(edit, NoEdit)
    assert "criterion 2.56" in edit.reason
    edit = cheapest_edit(ranking, "warming-step", "linear-warming", wanted=30.0)
    assert isinstance(edit, NoEdit)
    assert edit.reason.startswith("no single edit separates them to d′ 30: the largest d′ of a safe and reachable one")
    assert "with numbers up to 256 times larger or smaller" in edit.reason
    assert 0.0 < float(edit.reason.rsplit(" ", 1)[1]) < 30.0
    with pytest.raises(ValueError, match="nobody"):
        cheapest_edit(ranking, "warming-step", "nobody")
    with pytest.raises(ValueError, match=r"^cheapest_edit: a pair is two icons, not double-dip twice"):
        cheapest_edit(ranking, "double-dip", "double-dip")


def test_what_is_short_of_the_criterion_is_said_to_be_less(rig: Rig) -> None:
    """Warmth on a small contact, where a nominal person reaches a d′ that half of the people do not."""
    text = (
        'cue 1\nset alerts "Alerts" { site fingertip; control display; baseline 32 °C }\n'
        "icon warm { warm by 5 °C at 3 °C/s; hold for 1 s; return at 2 °C/s }\n"
        "icon late { warm by 5 °C at 1 °C/s; hold for 1 s; return at 2 °C/s }\n"
    )
    small = Rig.load("fingertip")
    edit = cheapest_edit(rank(list(parse(text)), small, people=PEOPLE, parameters=0), "warm", "late")
    assert isinstance(edit, NoEdit)
    assert 0.0 < float(edit.reason.rsplit(" ", 1)[1]) < DISTINGUISHABLE_DPRIME


def test_a_repeat_is_an_edit(rig: Rig) -> None:
    text = (
        "cue 1\nset two { site thenar; control display; baseline 32 °C }\n"
        "icon x { cool by 3 °C at 3 °C/s; return at 3 °C/s; total at most 9 s }\n"
        "icon y { cool by 3.1 °C at 3 °C/s; return at 3 °C/s }\n"
    )
    icons = list(parse(text))
    twice = repeated(icons[0], 2)
    assert duration_s(twice, rig) == 4.0
    assert "repeat 2 {" in str(twice)
    assert "total at most 9 s" in str(twice)
    edit = cheapest_edit(rank(icons, rig, people=8, parameters=0), "x", "y")
    assert isinstance(edit, Edit)
    assert edit.d_prime >= DISTINGUISHABLE_DPRIME


def test_what_would_bring_another_pair_together_is_not_offered(rig: Rig) -> None:
    """The cheapest edit alone is not that beside an icon which is just what it would make."""

    def offered(*third: str) -> tuple[str, bool]:
        body = "by {} °C at {} °C/s; hold for 1 s; return at 2 °C/s".format
        parts = (body("2", "2"), body("2", "1.4"), *third)
        text = "\n".join(f"icon {name} {{ warm {part} }}" for name, part in zip("abc", parts, strict=False))
        icons = parse(f"cue 1\nset x {{ control display; baseline 32 °C }}\n{text}")
        ranking = rank(icons, rig, people=12, parameters=0)
        edit = cheapest_edit(ranking, "a", "b")
        assert isinstance(edit, Edit)
        after = rank([edit.edited if one.name == edit.icon else one for one in icons], rig, people=12, parameters=0)
        before, then = (each.d_prime[2:, :2] for each in (ranking, after))
        return f"{edit.icon}: {edit.new}", bool((then > np.minimum(before, 2.0 * DISTINGUISHABLE_DPRIME) - 0.11).all())

    alone, _ = offered()
    weaker = f"{alone.removeprefix('b: warm ')}; hold for 1 s; return at 2 °C/s"
    (beside, kept), far = offered(weaker), offered("by 4 °C at 1.4 °C/s; hold for 1 s; return at 2 °C/s")
    assert alone.startswith("b: ") and beside.startswith("a: ") and kept
    first, second = (float(re.findall(r"[\d.]+", each)[0]) for each in (alone, far[0]))
    assert far[0].startswith("b: warm by ") and far[1] and second == pytest.approx(first, abs=0.1)


def test_what_makes_a_pair_worse() -> None:
    before, after = np.array([3.0, 3.0, 9.0, 9.0]), np.array([2.89, 2.91, 5.11, 5.13])
    assert worse(before, after, 2.56).tolist() == [True, False, True, False]


@pytest.mark.parametrize(("added_s", "costs"), [(-2.0, [0.7]), (29.9, [0.7 + 2.99]), (30.1, [])])
def test_an_edit_is_at_most_half_a_minute_longer_and_a_second_costs_a_tenth(
    rig: Rig, added_s: float, costs: list[float]
) -> None:
    longer = parse(f"cue 1; icon a {{ hold for {8.0 + added_s} s }}")["a"]
    kept: Any = SimpleNamespace(rig=rig, durations_s=[8.0])
    found = candidate_edits._valid(kept, 0, lambda: (longer, "old", "new"), 0.7, 0, 0.0)
    assert [edit.cost for edit in found] == pytest.approx(costs)


def test_numbers_are_found_and_changed_within_repeats(six: IconSet) -> None:
    icon = six["double-dip"]
    numbers = numbers_of(icon, 32.0)
    assert [number.path for number in numbers] == [(0,), (0, 0), (0, 0), (0, 1), (0, 2), (0, 3)]
    assert [number.value for number in numbers] == [2.0, 3.0, 3.0, 1.0, 3.0, 1.0]
    for number in numbers:
        new = with_number(icon, number, number.times(2.0))
        assert [n.value for n in numbers_of(new, 32.0) if n.path == number.path and n.field == number.field] == [
            2.0 * number.value
        ]
        assert sum(a != b for a, b in zip(str(icon).split(), str(new).split(), strict=True)) == 1
    rounded = [candidate_edits._outwards(value, numbers[0], 2) for value in (2.341, 1.287)]
    assert rounded == pytest.approx([2.4, 1.2]), "away from what it was, so that the effect is kept"


def test_a_temperature_counts_from_the_baseline(monkeypatch: pytest.MonkeyPatch) -> None:
    icon = parse("cue 1\nset { baseline 32 °C }\nicon to-it { cool to 28 °C at 2 °C/s; return at 2 °C/s }")["to-it"]
    number = next(n for n in numbers_of(icon, 32.0) if n.field == "to_C")
    assert number.times(1.5) == 26.0
    monkeypatch.setattr(candidate_edits, "_valid", lambda kept, place, make, ratio, way, step: [ratio])
    kept: Any = SimpleNamespace(icons=[icon])
    (ratio,) = candidate_edits.changed(kept, (0, number, True), 0, 0, np.log(1.5))
    assert ratio == pytest.approx(np.log(1.5))  # what the change costs


def test_icons_too_weak_to_feel_are_made_strong_enough(rig: Rig) -> None:
    icons = list(steps(up=0.03, down=-0.03))
    found = cheapest_edit(rank(icons, rig, people=12, parameters=0), "up", "down")
    assert isinstance(found, Edit)
    edited = [found.edited if icon.name == found.icon else icon for icon in icons]
    again = rank(edited, rig, people=12, parameters=0).pairs[0].d_prime
    assert again == pytest.approx(found.d_prime, rel=1e-6) and again >= 2.56

"""Icons on elements apart are compared surface by surface."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from thermicon.base.checks.arguments import InputError
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Element, Layout, Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import Ranking, Task, choose, rank
from thermicon.perception.identification.surfaces import detected_by_any
from thermicon.perception.observer.channels import MEMORY_FORMS
from thermicon.perception.ranking.rank_file import OFTEN_CONFUSED
from thermicon.perception.selection.request import Selection
from thermicon.perception.sensation.detection import Detection

THENAR, FINGER = Rig.load("thenar"), Rig.load("fingertip")
COOL, FASTER = "cool by 2 °C at 1 °C/s; return at 1 °C/s", "cool by 2 °C at 1.5 °C/s; return at 1.5 °C/s"
WARM, MORE = "warm by 2 °C at 1 °C/s; return at 1 °C/s", "warm by 3 °C at 1.5 °C/s; return at 1.5 °C/s"
HEAD = "control display; baseline 32 °C"


def layout(*names: str, rigs: Mapping[str, Rig] | None = None, lapse: float = 0.0) -> Layout:
    return Layout(tuple(Element((rigs or {}).get(name, THENAR), name) for name in names), "mine", lapse=lapse)


def played(elements: str = "left, right", **bodies: str) -> IconSet:
    """Icons of parts such as ``on left { … }``."""
    icons = "\n".join(f"icon {name} {{ {body} }}" for name, body in bodies.items())
    return parse(f"cue 1\nset s {{ elements {elements}; {HEAD} }}\n{icons}")


def alone(**bodies: str) -> IconSet:
    """The same on one element."""
    return parse(
        f"cue 1\nset s {{ {HEAD} }}\n" + "\n".join(f"icon {name} {{ {body} }}" for name, body in bodies.items())
    )


def both(left: str, right: str) -> str:
    return f"together {{ on left {{ {left} }}; on right {{ {right} }} }}"


def ranked(icons: IconSet, on: Layout | Rig, **how: object) -> Ranking:
    return rank(icons, on, **({"people": 12, "parameters": 0} | how))  # type: ignore[arg-type]


def test_an_element_that_idles_in_all_icons_changes_no_byte() -> None:
    bodies = {"a": COOL, "b": FASTER, "c": WARM}
    for memory in ("both", *MEMORY_FORMS):
        how = {"parameters": 3, "memory": memory}
        one = ranked(alone(**bodies), THENAR, **how)
        spatial = played(**{name: f"on right {{ {body} }}" for name, body in bodies.items()})
        for on in (layout("left", "right"), layout("right", "left", "third")):
            other = ranked(spatial, on, **how)
            for name in ("pooled", "by_form", "bits", "pairs", "reports"):
                assert np.array_equal(getattr(one.felt, name), getattr(other.felt, name)), (memory, name)
            assert np.array_equal(one.felt.detection.onset_s, other.felt.detection.onset_s)
            assert one.new_laboratory and other.new_laboratory
            assert one.new_laboratory.felt_and_named == other.new_laboratory.felt_and_named
            assert one.total_J == other.total_J


@pytest.mark.parametrize("right", [THENAR, FINGER], ids=["alike", "another-rig"])
def test_squares_of_distance_add_over_elements_and_either_detects(right: Rig) -> None:
    faint = "cool by 0.3 °C at 0.3 °C/s; return at 0.3 °C/s", "cool by 0.4 °C at 0.3 °C/s; return at 0.3 °C/s"
    two = ranked(
        played(a=both(COOL, WARM), b=both(FASTER, MORE), c=both(faint[0], faint[1])),
        layout("left", "right", rigs={"right": right}),
    )
    hands = ranked(alone(a=COOL, b=FASTER, c=faint[0]), THENAR), ranked(alone(a=WARM, b=MORE, c=faint[1]), right)
    wanted = np.hypot(*(hand.felt.pairs for hand in hands))
    assert two.felt.pairs == pytest.approx(wanted, rel=1e-12)
    assert min(hand.felt.pairs[:, 0].min() for hand in hands) > 0.3
    missed = np.prod([1.0 - hand.felt.reports for hand in hands], axis=0)
    assert two.felt.reports == pytest.approx(1.0 - missed, abs=1e-12)
    assert 0.1 < missed[:, 2].mean() < 0.95
    whole = [sum(part.value**2 for part in pair.parts) for pair in two.pairs]
    each = [sum(part.value**2 for hand in hands for part in hand.pairs[k].parts) for k in range(3)]
    assert whole == pytest.approx(each, rel=1e-9)


@pytest.mark.parametrize("form", MEMORY_FORMS)
def test_an_element_that_plays_alike_in_all_icons_distinguishes_none(form: str) -> None:
    differs = {"a": COOL, "b": FASTER, "c": WARM}
    one = ranked(alone(**differs), THENAR, memory=form)
    two = ranked(
        played(**{name: both(body, MORE) for name, body in differs.items()}), layout("left", "right"), memory=form
    )
    assert np.array_equal(one.felt.pairs, two.felt.pairs)
    assert two.confusion == pytest.approx(one.confusion, abs=1e-9)


@pytest.mark.parametrize("form", MEMORY_FORMS)
def test_a_tenth_of_a_second_between_two_elements_is_hardly_noticed(form: str) -> None:
    icons = played(a=f"along left, right every 100 ms {{ {COOL} }}", b=f"along right, left every 100 ms {{ {COOL} }}")
    assert 0.0 < ranked(icons, layout("left", "right"), memory=form).pairs[0].d_prime < 1.0
    later = played(a=f"along left, right every 3 s {{ {COOL} }}", b=f"along right, left every 3 s {{ {COOL} }}")
    assert ranked(later, layout("left", "right"), memory=form).pairs[0].d_prime > 1.5


FAINT = {"w": "warm by 0.7 °C at 1 °C/s; return at 1 °C/s", "c": "cool by 0.25 °C at 1 °C/s; return at 1 °C/s"}


@pytest.mark.parametrize("form", MEMORY_FORMS)
def test_mirror_images_are_confused_alike(form: str) -> None:
    """What is faint is often missed in memory, so that many trials cost two names the same."""
    names = [f"{word}-{side}" for word in FAINT for side in ("left", "right")]
    icons = played(**{name: f"on {name[2:]} {{ {FAINT[name[0]]} }}" for name in names})
    found = ranked(icons, layout("left", "right"), people=60, memory=form)
    mirror = [1, 0, 3, 2]
    error = 4.0 * np.hypot(found.felt.standard_error, 0.003)
    assert found.confusion == pytest.approx(found.confusion[np.ix_(mirror, mirror)], abs=error)
    assert np.array_equal(found.felt.pairs[:, [1, 2]], found.felt.pairs[:, [4, 3]])
    assert found.confusion[2, 0] > OFTEN_CONFUSED / 10


def test_names_and_order_of_icons_and_elements_change_nothing() -> None:
    parts = {
        "a": both(COOL, WARM),
        "b": both(WARM, COOL),
        "c": f"on left {{ {FASTER} }}",
        "d": f"on right {{ {MORE} }}",
    }
    usual = ranked(played(**parts), layout("left", "right"), people=40)
    turned = {f"x{name}": body.replace("left", "l").replace("right", "r") for name, body in reversed(parts.items())}
    other = ranked(played("r, l", **turned), layout("r", "third", "l"), people=40)
    back = [3, 2, 1, 0]
    assert other.d_prime[np.ix_(back, back)] == pytest.approx(usual.d_prime, rel=1e-12)
    assert other.felt.reports[:, back] == pytest.approx(usual.felt.reports, rel=1e-12)
    assert other.felt.detection.onset_s[back] == pytest.approx(usual.felt.detection.onset_s, abs=1e-9)
    error = 4.0 * np.hypot(usual.felt.standard_error, other.felt.standard_error)
    assert other.confusion[np.ix_(back, back)] == pytest.approx(usual.confusion, abs=error)


@pytest.mark.parametrize("rigs", [{}, {"right": FINGER, "r": FINGER}], ids=["alike", "another-rig"])
def test_names_and_order_of_the_elements_in_a_layout_change_no_draw(rigs: Mapping[str, Rig]) -> None:
    bodies = {"a": both(COOL, WARM), "b": both(FASTER, COOL), "c": f"on left {{ {FASTER} }}"}
    other = {name: body.replace("left", "l").replace("right", "r") for name, body in bodies.items()}
    usual = ranked(played(**bodies), layout("left", "right", rigs=rigs), memory="naming")
    turned = ranked(played("r, l", **other), layout("r", "l", rigs=rigs), memory="naming")
    assert turned.confusion == pytest.approx(usual.confusion, rel=1e-9)


def test_intervals_of_a_new_laboratory_hold_the_prediction() -> None:
    icons = played(a=both(COOL, WARM), b=both(WARM, COOL), c=f"on left {{ {FASTER} }}", d=f"on left {{ {COOL} }}")
    found = ranked(icons, layout("left", "right"), people=24, parameters=32)
    elsewhere = found.new_laboratory
    assert elsewhere is not None
    ends = (
        (elsewhere.felt_and_named, found.felt_and_named),
        (elsewhere.proportion_correct, found.proportion_correct),
        (elsewhere.information_bits, found.information_bits),
    )
    for (low, high), nominal in ends:
        assert low <= nominal <= high
        assert high - low > 0.02


def test_what_a_task_costs_is_a_lapse_of_the_layout() -> None:
    icons = played(a=f"on left {{ {COOL} }}", b=f"on right {{ {COOL} }}", c=both(COOL, WARM))
    for form in MEMORY_FORMS:
        still, driving = (ranked(icons, layout("left", "right", lapse=lapse), memory=form) for lapse in (0.0, 0.15))
        assert driving.confusion == pytest.approx(0.85 * still.confusion + 0.05, abs=1e-12)
        assert still.content_hash != driving.content_hash


def drawn(probability: Array, cold: Array, when: Array) -> Detection:
    """Reports (1, tracks) at times that are uniform up to `when` (tracks,), in steps of 0.02 s."""
    time = 0.02 * np.arange(200)
    return Detection(
        probability[None], cold[None], probability[:, None] * np.minimum(time / when[:, None], 1.0)[None], 0.02
    )


def test_the_channel_is_that_of_the_earlier_report() -> None:
    probability, cold, when = np.array([0.9, 0.7, 0.4]), np.array([1.0, 0.0, 0.5]), np.array([3.0, 1.0, 2.0])
    found = detected_by_any([drawn(probability, cold, when)], np.array([[0], [1], [2]]))
    chance = np.random.default_rng(0)
    times = np.where(chance.random((400_000, 3)) < probability, when * chance.random((400_000, 3)), np.inf)
    first, reported = times.argmin(axis=1), np.isfinite(times).any(axis=1)
    assert found.probability[0, 0] == pytest.approx(reported.mean(), abs=0.002)
    assert found.cold_share[0, 0] == pytest.approx(cold[first[reported]].mean(), abs=0.003)
    by_time = [(times.min(axis=1) <= time).mean() for time in (0.4, 1.0, 2.4)]
    assert found.courses[0, 0, [20, 50, 120]] == pytest.approx(by_time, abs=0.003)


def test_what_is_not_predicted_is_refused_with_a_cure() -> None:
    icons = played(a=f"on left {{ {COOL} }}", b=f"on right {{ {COOL} }}")
    two = layout("left", "right")
    with pytest.raises(InputError, match=r'one piece of skin .*: take .*surfaces = "apart".*, such as those of wheel$'):
        ranked(icons, replace(two, surfaces="one"))
    with pytest.raises(InputError, match=r"leave out the gap of the task$"):
        ranked(icons, two, task=Task(1.0))
    with pytest.raises(InputError, match=r"change them in their file, and rank them again$"):
        choose(ranked(icons, two), Selection(2))

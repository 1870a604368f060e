"""Every kind of statement is known wherever a person or a program meets one.

A new kind stands in ``LEAVES`` and in a file of examples; the other places that it needs are asked here.
"""

import json
import re
from collections.abc import Iterator
from importlib import resources
from inspect import signature
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

import thermicon.icons as front_door
from thermicon.circuit.delivery.nearest import changed
from thermicon.icons import CueErrors, Icon, IconSet, parse, to_json
from thermicon.icons.model import builders
from thermicon.icons.model.format import statement_text
from thermicon.icons.model.statements import LEAVES, Leaf, Play, Repeat
from thermicon.notebooks.timeline.handles import handles_of

ROOT = Path(__file__).resolve().parents[3]
DATA = resources.files("thermicon.icons").joinpath("data")
SETS = [parse((ROOT / "tests" / "icons" / name).read_text("utf-8")) for name in ("everything.cue", "current.cue")]


def leaves_of(body: tuple[object, ...]) -> Iterator[Leaf]:
    for part in body:
        if isinstance(part, Repeat):
            yield from leaves_of(part.body)
        elif not isinstance(part, Play):
            assert isinstance(part, LEAVES)
            yield part


WRITTEN: list[tuple[Icon, Leaf]] = [
    (icon, leaf)
    for each in SETS
    for icon in each.entries
    if isinstance(icon, Icon)
    for leaf in leaves_of(icon.statements)
]


def examples_of(kind: type) -> list[tuple[Icon, Leaf]]:
    return [(icon, leaf) for icon, leaf in WRITTEN if type(leaf) is kind]


@pytest.mark.parametrize("kind", LEAVES)
def test_it_has_an_example_and_a_word_in_python(kind: type) -> None:
    assert examples_of(kind), "write one into tests/icons/everything.cue, or current.cue"
    words = [getattr(front_door, name) for name in front_door.__all__ if hasattr(builders, name)]
    assert kind.__name__ in {
        getattr(made, "__name__", made) for made in (signature(w).return_annotation for w in words)
    }


@pytest.mark.parametrize("icons", SETS)
def test_the_examples_come_back_from_their_text_and_keep_to_the_published_schema(icons: IconSet) -> None:
    again = parse(str(icons))
    assert again.content_hash == icons.content_hash
    assert again.entries == icons.entries
    schema = json.loads(DATA.joinpath("cue.schema.json").read_text(encoding="utf-8"))
    Draft202012Validator(schema).validate(json.loads(to_json(icons)))


@pytest.mark.parametrize("kind", LEAVES)
def test_its_word_is_in_the_reference_and_alone_is_helped_on(kind: type) -> None:
    reference = (ROOT / "docs" / "reference" / "language.md").read_text(encoding="utf-8")
    for control, word in {
        (icon.context.control, statement_text(leaf, icon.context.control).split()[0])
        for icon, leaf in examples_of(kind)
    }:
        assert re.search(rf"`{word}\b", reference), f"{word} is not in docs/reference/language.md"
        with pytest.raises(CueErrors) as wrong:
            parse(f"cue 1; set {{ control {control} }}; icon a {{ {word} }}")
        (error,) = wrong.value.errors
        assert error.help, f"nothing says what follows {word}"


@pytest.mark.parametrize("name", ["ramps", "shapes"])
def test_a_smaller_and_slower_icon_is_so_in_each_of_its_statements(name: str) -> None:
    """Every corner lies half as far from rest, and no ramp is as fast as it was."""
    icon = SETS[0][name]
    half, slow = changed(icon, 32.5, smaller=0.5), changed(icon, 32.5, slower=2.0)
    ends = icon.corners()
    assert half.corners().highest - 32.5 == pytest.approx(0.5 * (ends.highest - 32.5), abs=1e-3)
    assert half.corners().lowest - 32.5 == pytest.approx(0.5 * (ends.lowest - 32.5), abs=1e-3)
    assert slow.corners().steepest_per_s == pytest.approx(0.5 * ends.steepest_per_s, rel=1e-3)


def test_every_corner_of_a_statement_is_moved_or_says_why_not() -> None:
    for each in SETS:
        for icon in each.icons:
            for handle in handles_of(icon):
                assert handle.moves_time or handle.moves_level or handle.why

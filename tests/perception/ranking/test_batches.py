import itertools
from dataclasses import replace

import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import rank
from thermicon.perception.ranking import batches as under_test
from thermicon.perception.ranking.batches import Job

RIG = Rig.load("thenar")
ICONS = load_library("six-icons")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks of three people of the six icons."""
    monkeypatch.setattr(under_test, "SAMPLES_AT_ONCE", 36_000)


def work(people: int = 8, **changes: object) -> Job:
    made = Job(tuple(ICONS)[:3], RIG, 18.0, people, 0, 48, None, "episodes")
    return replace(made, **changes)  # type: ignore[arg-type]


def test_batchs_cover_everyone_once_and_do_not_depend_on_how_many_there_are() -> None:
    for people in (1, 3, 500):
        asked = work(people)
        spans = [asked.span(number) for number in range(asked.batches)]
        assert spans[0][0] == 0
        assert spans[-1][1] == people
        assert all(a[1] == b[0] for a, b in itertools.pairwise(spans))
        assert asked.at_once == work().at_once


@pytest.mark.slow
def test_the_same_bytes_whatever_the_number_of_workers(few: None) -> None:
    texts = {rank(ICONS, RIG, people=10, parameters=2, workers=workers).to_json() for workers in (1, 2, 3, None)}
    assert len(texts) == 1


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"at least one worker is needed, not 0"):
        rank(ICONS, RIG, people=2, parameters=0, workers=0)
    with pytest.raises(ValueError, match=r"at least one person is needed, not 0"):
        rank(ICONS, RIG, people=0, parameters=0)

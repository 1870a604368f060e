"""Orders of play: designs against their definition."""

from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thermicon.notebooks.study import orders
from thermicon.notebooks.study.orders import first_order_counts, orders_of, williams_rows


@pytest.mark.parametrize("count", range(2, 11))
def test_in_a_williams_design_every_icon_follows_every_other_equally_often(count: int) -> None:
    rows = williams_rows(count)
    assert len(rows) == (count if count % 2 == 0 else 2 * count)
    assert all(sorted(row) == list(range(count)) for row in rows)
    pairs = first_order_counts(rows)
    assert len(pairs) == count * (count - 1)
    assert len(set(pairs.values())) == 1
    places = Counter((place, icon) for row in rows for place, icon in enumerate(row))
    assert len(set(places.values())) == 1, "every icon is at every place equally often"


@given(
    rule=st.sampled_from(["balanced", "williams", "random"]),
    icons=st.integers(2, 9),
    repetitions=st.integers(1, 6),
    blocks=st.integers(1, 4),
    seed=st.integers(0, 2**52),
)
def test_no_icon_follows_itself_and_blocks_are_complete(
    rule: str, icons: int, repetitions: int, blocks: int, seed: int
) -> None:
    people = orders_of(rule, icons, repetitions, blocks, 2, seed)
    assert people == orders_of(rule, icons, repetitions, blocks, 2, seed)
    for person in people:
        whole = [place for block in person for place in block]
        assert all(before != after for before, after in pairwise(whole))
        assert len(person) == blocks
        assert all(Counter(block) == dict.fromkeys(range(icons), repetitions) for block in person)


def test_balanced_orders_are_more_even_than_random_ones() -> None:
    def spread(rule: str) -> int:
        (person,) = orders_of(rule, 6, 10, 1, 1, seed=4)
        pairs = first_order_counts(person)
        counts = [pairs[a, b] for a in range(6) for b in range(6) if a != b]
        return max(counts) - min(counts)

    assert spread("balanced") <= 2
    assert spread("random") >= 5


def test_of_twelve_orders_the_most_balanced_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    uneven, better, best = [0, 1, 0, 1, 0, 1], [0, 1, 0, 1, 2, 0], [0, 1, 2, 0, 2, 1]
    drawn = iter([*[uneven] * 11, better, best])
    monkeypatch.setattr(orders, "_drawn", lambda *_, **__: next(drawn))
    assert orders_of("balanced", 3, 2, 1, 1, seed=0) == ((tuple(better),),)


def test_rows_of_a_williams_design_are_dealt_out_equally() -> None:
    people = orders_of("williams", 4, 1, 2, 6, seed=9)
    used = Counter(block for person in people for block in person)
    assert sum(used.values()) == 12
    assert set(used.values()) == {3}

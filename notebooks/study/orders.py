"""Orders of play from one seed.

Python's own generator is used, whose sequences are the same in every version; those of numpy are not promised to be.
"""

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from random import Random

Block = tuple[int, ...]
"""Places of icons in the order of play."""

BALANCED_TRIES = 12
"""Orders of which the most balanced one is taken."""

MOST_TRIES = 200
"""How often a sequence is begun again that has run into a repeat that cannot be avoided; few need more than three."""


def williams_rows(count: int) -> tuple[Block, ...]:
    """Return the rows of a Williams design: over all, every icon follows every other equally often.

    `count` rows for an even number of icons and twice as many for an odd one (Williams 1949).

    >>> williams_rows(4)
    ((0, 3, 1, 2), (1, 0, 2, 3), (2, 1, 3, 0), (3, 2, 0, 1))
    """
    first = [(-1) ** k * ((k + 1) // 2) % count for k in range(count)]  # 0, the last, 1, the last but one, …
    rows = [tuple((place + shift) % count for place in first) for shift in range(count)]
    return tuple(rows if count % 2 == 0 else rows + [row[::-1] for row in rows])


def orders_of(
    rule: str, icons: int, repetitions: int, blocks: int, participants: int, seed: int
) -> tuple[tuple[Block, ...], ...]:
    """Return the blocks of every participant, each of two icons or more `repetitions` times, none after itself."""
    rng = Random(seed)
    if rule == "williams":
        return _williams(rng, icons, repetitions, blocks, participants)
    make = _balanced if rule == "balanced" else _drawn
    return tuple(
        tuple(_blocks(make(rng, icons, repetitions, blocks), icons * repetitions)) for _ in range(participants)
    )


def first_order_counts(blocks: Sequence[Block]) -> Counter[tuple[int, int]]:
    """How often each icon follows each other within blocks."""
    return Counter(pair for block in blocks for pair in pairwise(block))


def _blocks(order: list[int], length: int) -> list[Block]:
    return [tuple(order[begin : begin + length]) for begin in range(0, len(order), length)]


def _williams(rng: Random, icons: int, repetitions: int, blocks: int, people: int) -> tuple[tuple[Block, ...], ...]:
    """Rows dealt out so that each is used equally often, and none begins with the icon that the last one ended with."""
    names = list(range(icons))
    rng.shuffle(names)  # which icon is which in the design
    rows = [tuple(names[place] for place in row) for row in williams_rows(icons)]
    used = Counter[Block]()
    whole = []
    for _ in range(people):
        order: list[int] = []
        for _ in range(blocks * repetitions):
            free = [row for row in rows if not order or row[0] != order[-1]]
            least = min(used[row] for row in free)
            row = rng.choice([row for row in free if used[row] == least])
            used[row] += 1
            order += row
        whole.append(tuple(_blocks(order, icons * repetitions)))
    return tuple(whole)


def _balanced(rng: Random, icons: int, repetitions: int, blocks: int) -> list[int]:
    """Every icon equally often in each block; of some orders the one in which pairs are most equally frequent."""
    tries = [_drawn(rng, icons, repetitions, blocks, balanced=True) for _ in range(BALANCED_TRIES)]
    return min(tries, key=lambda order: sum(count**2 for count in first_order_counts([tuple(order)]).values()))


def _drawn(rng: Random, icons: int, repetitions: int, blocks: int, *, balanced: bool = False) -> list[int]:
    """An order without immediate repeats; balanced: the next icon has followed the last one least often so far."""
    for _ in range(MOST_TRIES):
        order: list[int] = []
        left, followed = Counter[int](), Counter[tuple[int, int]]()
        for _ in range(blocks * icons * repetitions):
            if not left.total():  # a block begins
                left.update(dict.fromkeys(range(icons), repetitions))
            place = _next(rng, order, left, followed if balanced else None)
            if place is None:
                break
            if order:
                followed[order[-1], place] += 1
            order.append(place)
            left[place] -= 1
        else:
            return order
    raise ArithmeticError("no order without immediate repeats was found")  # two icons or more always have one


def _next(rng: Random, order: list[int], left: Counter[int], followed: Counter[tuple[int, int]] | None) -> int | None:
    """The next icon; one that must come now so that its plays can still be apart, where there is one."""
    last = order[-1] if order else None
    free = sorted(place for place, count in left.items() if count and place != last)
    if not free:
        return None
    remaining = sum(left.values())
    must = [place for place in free if 2 * left[place] > remaining]
    if must:
        return must[0]
    if last is None or followed is None:
        spread = [place for place in free for _ in range(left[place])]
        return rng.choice(spread)
    least = min(followed[last, place] for place in free)
    best = [place for place in free if followed[last, place] == least]
    most = max(left[place] for place in best)
    return rng.choice([place for place in best if left[place] == most])

"""The plan of a session: which icons in which order, and the pause between them; given in a file or shuffled."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.icons import IconSet

from ..inputs import InputError, read_text

MOST_PLAYS = 5_000
"""More plays than fit into the longest session with icons of 2 s."""

LONGEST_S, LONGEST_GAP_S = 10_800.0, 3_600.0
"""A session of up to 3 h fits into the memory of a laptop; longer ones are split, as people need a break."""

ORDER_MB = 1.0
"""Largest file of an order: 200 characters for each of the most plays."""


class SessionError(InputError):
    """A session that cannot be planned or played; the text gives the reason and what to change.

    Examples
    --------
    >>> try:
    ...     SessionPlan(())
    ... except SessionError as problem:
    ...     print(problem)
    a session ...
    """


@dataclass(frozen=True, slots=True)
class SessionPlan:
    """The order of play in a session, and the gap between plays.

    Parameters
    ----------
    order
        Names of icons in the order of play, at most 5,000.
    gap_s
        Time in s from the end of one play to the start of the next, 0 to 3,600 s.
    seed
        Seed of a shuffled order; None for an order that was given.

    Raises
    ------
    SessionError
        For an empty or too long order, and for a gap outside its range.

    Examples
    --------
    >>> SessionPlan(("dip", "glow", "dip"), gap_s=5.0)
    SessionPlan(3 plays of 2 icons, 5 s apart)
    """

    order: tuple[str, ...]
    gap_s: float = 10.0
    seed: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "order", tuple(self.order))
        if not self.order:
            raise SessionError("a session needs at least one play; the order has none")
        _check_count(len(self.order), "the order")
        if not 0.0 <= self.gap_s <= LONGEST_GAP_S:  # False for NaN
            raise SessionError(f"a gap of {self.gap_s:g} s is outside 0 to {LONGEST_GAP_S:g} s")

    def __repr__(self) -> str:
        plays, icons = len(self.order), len(self.names)
        words = f"{plays} play{'s' * (plays > 1)} of {icons} icon{'s' * (icons > 1)}, {self.gap_s:g} s apart"
        return f"SessionPlan({words}{'' if self.seed is None else f', shuffled with seed {self.seed}'})"

    @property
    def names(self) -> tuple[str, ...]:
        """Each icon once, in the order of its first play."""
        return tuple(dict.fromkeys(self.order))

    @staticmethod
    def shuffled(names: Sequence[str], repeats: int, *, seed: int = 0, gap_s: float = 10.0) -> SessionPlan:
        """Return a plan with every icon `repeats` times in random order; equal seeds give equal orders.

        Raises SessionError as the plan does, and for fewer than one repeat.

        >>> plan = SessionPlan.shuffled(["dip", "glow"], 3, seed=1)
        >>> plan, plan.order.count("dip")
        (SessionPlan(6 plays of 2 icons, 10 s apart, shuffled with seed 1), 3)
        """
        check_repeats(repeats, len(names), "icons")
        places = np.random.default_rng(seed).permutation(len(names) * repeats)
        return SessionPlan(tuple(names[place % len(names)] for place in places.tolist()), gap_s, seed)

    @staticmethod
    def repeated(order: Sequence[str], repeats: int = 1, *, gap_s: float = 10.0) -> SessionPlan:
        """Return a plan that goes through an order `repeats` times; raises SessionError as `shuffled`."""
        check_repeats(repeats, len(order), "entries of the order")
        return SessionPlan(tuple(order) * repeats, gap_s)


def read_order(path: str | Path, icons: IconSet) -> tuple[str, ...]:
    """Return the icon names of an order file: one per line or separated by commas; # begins a comment.

    Raises SessionError for a file that cannot be read or holds no name, and for a name that is not in the set, with its
    line and the nearest name.
    """
    where = Path(path)
    names: list[str] = []
    known: set[str] = set()
    for line, name in _words(read_text(where, "file of an order", ORDER_MB, SessionError)):
        if name not in known:
            try:
                known.add(icons[name].name)
            except KeyError as problem:
                raise SessionError(f"{where}:{line}: {problem}") from None
        names.append(name)
    if not names:
        raise SessionError(f"{where}: there is no icon in this order, only comments; write one name per line")
    _check_count(len(names), str(where))
    return tuple(names)


def order_text(plan: SessionPlan) -> str:
    """Return the order as the text of an order file."""
    seed = "" if plan.seed is None else f", shuffled with seed {plan.seed}"
    return "\n".join([f"# {len(plan.order)} plays, {plan.gap_s:g} s apart{seed}", *plan.order, ""])


def check_length(durations_s: Sequence[float], gap_s: float) -> float:
    """Return how long a session lasts in s, from its first start to its last end; SessionError where that is too long.

    >>> check_length([8.0, 4.0], 10.0)
    22.0
    """
    total = math.fsum(durations_s) + gap_s * (len(durations_s) - 1)
    if total > LONGEST_S:
        raise SessionError(
            f"{len(durations_s)} plays with gaps of {gap_s:g} s last {total:.0f} s; the limit is {LONGEST_S:g} s: play "
            f"fewer, shorten the gap, or split the session"
        )
    return total


def check_repeats(repeats: int, entries: int, what: str) -> None:
    """Raise SessionError for fewer than one repeat, and for more plays in all than a session may have."""
    if repeats < 1:
        raise SessionError(f"{repeats} repeats are not possible; there must be at least 1")
    _check_count(entries * repeats, f"{repeats:,} repeats of {entries:,} {what}")


def _words(text: str) -> Iterator[tuple[int, str]]:
    """Line and name of every entry of an order file."""
    for line, content in enumerate(text.splitlines(), 1):
        for word in content.partition("#")[0].split(","):
            if word.strip():
                yield line, word.strip()


def _check_count(plays: int, what: str) -> None:
    if plays > MOST_PLAYS:
        raise SessionError(
            f"{what}: {plays:,} plays are too many; a session has at most {MOST_PLAYS:,}: repeat less, or split it"
        )

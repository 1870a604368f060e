"""The plan of a session: the order of play with its gap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError, read_text
from thermicon.icons import IconSet

MOST_PLAYS = 5_000
"""More plays than fit into the longest session with icons of 2 s."""
LONGEST_S, LONGEST_GAP_S = 10_800.0, 3_600.0
"""A session of up to 3 h fits into the memory of a laptop; longer ones are split, as people need a break."""
ORDER_MB = 1.0
"""Largest file of an order: 200 characters for each of the most plays."""


class SessionError(InputError):
    """A session that cannot be planned or played; the text gives the reason and what to change."""


@checked
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
        """A plan with every icon `repeats` times in random order; equal seeds give equal orders.

        >>> plan = SessionPlan.shuffled(["dip", "glow"], 3, seed=1)
        >>> plan, plan.order.count("dip")
        (SessionPlan(6 plays of 2 icons, 10 s apart, shuffled with seed 1), 3)
        """
        if repeats < 1:
            raise SessionError(f"{repeats} repeats are not possible; there must be at least 1")
        _check_count(len(names) * repeats, f"{repeats:,} repeats of {len(names):,} icons")
        places = np.random.default_rng(seed).permutation(len(names) * repeats)
        return SessionPlan(tuple(names[place % len(names)] for place in places.tolist()), gap_s, seed)


def read_order(path: str | Path, icons: IconSet) -> tuple[str, ...]:
    """Names in an order file, by lines or commas, # begins a comment; SessionError for what is not in the set."""
    where = Path(path)
    names: list[str] = []
    known: set[str] = set()
    lines = enumerate(read_text(where, "file of an order", ORDER_MB, SessionError).splitlines(), 1)
    words = ((line, word.strip()) for line, text in lines for word in text.partition("#")[0].split(","))
    for line, name in ((line, word) for line, word in words if word):
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
    """How long a session lasts in s, from its first start to its last end; SessionError where that is too long."""
    total = math.fsum(durations_s) + gap_s * (len(durations_s) - 1)
    if total > LONGEST_S:
        raise SessionError(
            f"{len(durations_s)} plays with gaps of {gap_s:g} s last {total:.0f} s; the limit is {LONGEST_S:g} s: play "
            f"fewer, shorten the gap, or split the session"
        )
    return total


def _check_count(plays: int, what: str) -> None:
    if plays > MOST_PLAYS:
        raise SessionError(
            f"{what}: {plays:,} plays are too many; a session has at most {MOST_PLAYS:,}: repeat less, or split it"
        )

"""A session: icons in sequence as one run, with verdicts on the whole and on each play; also its plan."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons import IconSet
from thermicon.icons.drawn import Tabled
from thermicon.icons.model.arguments import checked

from ..inputs import InputError, read_text
from ..rig.rules import Limits
from ..rig.uncertainty import Uncertainty
from ..solver.trace import Trace
from .checks import Check, Judged

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

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


@dataclass(frozen=True, slots=True)
class SessionPlay:
    """One icon in a session, on the rig as given: from its start until the next one starts, or the session ends.

    `drift_K` is the skin just before it minus the skin before the first play. `verdict` is green, amber or red, and
    `reason` the first limit exceeded, in one sentence; a limit in K counts from the start of the play. Times count from
    the session's start; dose and energy are those of this play and its gap.
    """

    icon: str
    start_s: float
    end_s: float
    verdict: str
    reason: str | None
    drift_K: float
    skin_min_C: float
    skin_max_C: float
    display_min_C: float
    display_max_C: float
    dose_cem43_min: float
    energy_J: float


@dataclass(frozen=True, slots=True)
class Session(Tabled, Judged):
    """A session on a rig.

    Attributes
    ----------
    plan
        Order of play and gap.
    tracking
        `replay` (open loop) or `display`.
    rest_A
        Current in A in the gaps.
    trace
        The rig as given, from the start of the first icon to the end of the last.
    plays
        One entry per play, on the rig as given.
    limits, uncertainty
        The limits that were applied, and the uncertainty of the rig.
    scenarios
        Number of corners.
    checks
        Every rule in its worst scenario.
    dose_cem43_min, henriques
        Thermal dose in min at 43 °C, and burn integral, of the rig as given.
    energy_J
        Electrical energy into the module in J.
    recovery_s
        Time in s after the end until display and skin are within 0.1 K of their start, in every corner of the
        uncertainty; None where it exceeds 10 min.

    Examples
    --------
    >>> from thermicon.circuit import Rig, play_session
    >>> from thermicon.icons import load_library
    >>> session = play_session(load_library("six-icons"), SessionPlan(("cooling-step",) * 2), Rig.load("thenar"))
    >>> session.verdict, session.duration_s, len(session.plays)
    ('amber', 26.0, 2)
    """

    plan: SessionPlan
    tracking: str
    rest_A: float
    trace: Trace
    plays: tuple[SessionPlay, ...]
    limits: Limits
    uncertainty: Uncertainty
    scenarios: int
    checks: tuple[Check, ...]
    dose_cem43_min: float
    henriques: float
    energy_J: float
    recovery_s: float | None

    def __repr__(self) -> str:
        plays = "1 play" if len(self.plays) == 1 else f"{len(self.plays)} plays"
        return (
            f"Session({self.verdict}: {plays} in {self.duration_s:g} s on {self.trace.rig_name}, skin "
            f"{self.trace.skin_C.min():.2f} … {self.trace.skin_C.max():.2f} °C, baseline drift "
            f"{self.baseline_drift_K:+.2f} K, {self.dose_cem43_min:.2g} min CEM43)"
        )

    def _repr_html_(self) -> str:
        return self.trace._repr_html_()

    @property
    def duration_s(self) -> float:
        """From the start of the first icon to the end of the last."""
        return float(self.trace.time_s[-1])

    @property
    def verdict(self) -> str:
        """The colour of the whole session in the worst case."""
        return self.colour

    @property
    def baseline_drift_K(self) -> float:
        """The largest drift before any play, with its sign."""
        return max((play.drift_K for play in self.plays), key=abs)

    def worst(self, quantity: str) -> Check | None:
        """The worst hard check of a quantity in the worst case; None where no rule limits it."""
        hard = [check for check in self.checks if check.quantity == quantity and check.severity == "hard"]
        return max(hard, key=lambda check: check.beyond, default=None)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per play, with the fields of a SessionPlay as columns."""
        import pandas as pd

        return pd.DataFrame([asdict(play) for play in self.plays], columns=[each.name for each in fields(SessionPlay)])

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the temperatures with a grey band for every play; returns the Axes."""
        drawn = self.trace.plot(ax)
        for play in self.plays:
            drawn.axvspan(play.start_s, play.end_s, color="0.5", alpha=0.12, lw=0.0, zorder=0)
        return drawn

    def to_dict(self) -> dict[str, object]:
        """All of it as plain data; units are in the names."""
        from .words import WHAT_IT_IS_NOT

        trace = self.trace
        dose, burn = self.worst("thermal dose"), self.worst("Henriques integral")
        return {
            "verdict": self.verdict,
            "reason": self.reason,
            "findings": [finding.to_dict() for finding in self.findings],
            "what_it_is_not": WHAT_IT_IS_NOT,
            "scenarios": self.scenarios,
            "rig": trace.rig_name,
            "tracking": self.tracking,
            "seed": self.plan.seed,
            "gap_s": self.plan.gap_s,
            "duration_s": self.duration_s,
            "rate_Hz": (len(trace.time_s) - 1) / self.duration_s,
            "dose_cem43_min": self.dose_cem43_min,
            "dose_cem43_worst_min": dose and dose.value,
            "dose_cem43_limit_min": dose and dose.limit,
            "henriques": self.henriques,
            "henriques_worst": burn and burn.value,
            "henriques_limit": burn and burn.limit,
            "baseline_drift_K": self.baseline_drift_K,
            "recovery_s": self.recovery_s,
            "energy_J": self.energy_J,
            "rest_A": self.rest_A,
            **{
                f"{place}_{side}_C": float(getattr(getattr(trace, f"{place}_C"), side)())
                for place in ("skin", "display", "hot_plate", "cold_receptor", "warm_receptor")
                for side in ("min", "max")
            },
            "checks": [check.to_dict() for check in self.checks],
            "uncertainty": self.uncertainty.model_dump(),
            "limits": self.limits.to_dict(),
            "plays": [asdict(play) for play in self.plays],
        }

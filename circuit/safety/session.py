"""A session: icons in sequence as one run with its verdicts."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

from thermicon.base.results.drawn import Tabled

from ..rig.rules import Limits
from ..rig.uncertainty import Uncertainty
from ..solver.trace import Trace
from .checks import Check, Judged
from .session_plan import SessionPlan

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


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

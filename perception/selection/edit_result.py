"""What a search for the cheapest edit returns: the edit, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from thermicon.icons import Icon


@dataclass(frozen=True, slots=True)
class Edit:
    """One line of one icon, before and after.

    Attributes
    ----------
    icon, old, new
        Name of the icon, and the line before and after.
    cost, added_s, d_prime
        `|log|` of the ratio of the new number to the old, plus a tenth for every second that it adds; how much longer
        the icon becomes, s; median d′ of the pair after the edit.
    edited
        The icon after it.
    recounted
        Share of people who remember another number of episodes after the edit; between 0 and 1 some gain much and
        others little.

    See Also
    --------
    cheapest_edit : Finds an edit.
    """

    icon: str
    old: str
    new: str
    cost: float
    added_s: float
    d_prime: float
    edited: Icon
    recounted: float = 0.0

    @property
    def text(self) -> str:
        """One line: old → new, and the resulting d′ of the pair."""
        added = f", {self.added_s:+.1f} s" if abs(self.added_s) >= 0.05 else ""
        return f"{self.icon}: {self.old} → {self.new}{added}: d′ {self.d_prime:.1f}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        return {
            "icon": self.icon,
            "old": self.old,
            "new": self.new,
            "cost": self.cost,
            "added_s": self.added_s,
            "d_prime": self.d_prime,
            "recounted_share": self.recounted,
        }

    def __repr__(self) -> str:
        return f"Edit({self.text}, cost {self.cost:.2f})"


@dataclass(frozen=True, slots=True)
class NoEdit:
    """Why no single edit is offered, in one sentence.

    Attributes
    ----------
    reason
        The sentence.

    See Also
    --------
    cheapest_edit : Finds an edit, or returns this.
    """

    reason: str

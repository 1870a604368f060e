"""A ranking beside what was asked of it afterwards, as one: the content of `rank --json`, its text and its page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from thermicon.perception.ranking.rank_file import as_text, plain, ranking_file

if TYPE_CHECKING:
    from thermicon.perception import Ranking
    from thermicon.perception.selection.choose import Choice
    from thermicon.perception.selection.edit import Edit, NoEdit
    from thermicon.perception.selection.goal_result import GoalResult


@dataclass(frozen=True, slots=True)
class SetReport:
    """A ranking, the icons chosen of it, the goal as set or choice meet it, edits by the names of pairs, and warnings.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> from thermicon.perception.selection.goal_result import judge_goal
    >>> ranking = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> SetReport(ranking, goal=judge_goal("correct >= 50 %", ranking)).to_dict(mapped=False)["goal"]["met"]
    True
    """

    ranking: Ranking
    choice: Choice | None = None
    goal: GoalResult | None = None
    edits: Mapping[tuple[str, str], Edit | NoEdit] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def to_dict(self, mapped: bool = True) -> dict[str, Any]:
        """The content of `rank --json` as plain data; the map takes a while and is None where it is not wanted."""
        from thermicon.perception.selection.edit import NoEdit

        made = ranking_file(self.ranking, mapped)
        made["warnings"] = list(self.warnings)
        made["goal"] = None if self.goal is None else plain(self.goal.to_dict())
        made["chosen"] = None if self.choice is None else plain(self.choice.to_dict())
        for pair in made["pairs"]:
            edit = self.edits.get((pair["a"], pair["b"]))
            if isinstance(edit, NoEdit):
                pair["no_edit"] = edit.reason
            elif edit is not None:
                pair["edit"] = plain(edit.to_dict())
        return made

    def to_json(self) -> str:
        """The content of `rank --json` as text, the same bytes for the same arguments."""
        return as_text(self.to_dict())

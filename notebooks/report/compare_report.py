"""What ``thermicon compare`` says: differences of two runs, and what is predicted for two sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number, percent

from ..files.trace_files import Aligned, differences, quantity, with_unit
from .blocks import Block, Text, grid

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception.selection.appraise import SetComparison

PEOPLE, SEED = 100, 0


@dataclass(frozen=True, slots=True)
class Comparison:
    """One pair of curves with a title, the outcomes of A and B, and a closing sentence."""

    title: str
    both: Aligned
    outcomes: tuple[str, str] = ("", "")
    after: str = ""


def compare_report(made: Comparison) -> list[Block]:
    """Report one table of differences with the meaning of A and B and the times of the comparison."""
    both, numbers = made.both, ("largest", "at", "rms", "mean")
    rows = []
    for _, row in differences(both).iterrows():
        written = [with_unit(float(row[name]), row["unit"]) for name in ("largest", "rms", "mean")]
        rows.append((quantity(row["column"]), written[0], f"{row['largest_s']:.2f} s", *written[1:]))
    sides = zip("AB", (both.name_a, both.name_b), made.outcomes, strict=True)
    heads = [f"{letter}  {name}{f': {outcome}' if outcome else ''}" for letter, name, outcome in sides]
    title = [made.title] if made.title else []
    return [
        Text("\n".join([*title, *heads])),
        grid(("B − A", *numbers), rows, numbers),
        Text(both.said),
        Text(made.after),
    ]


def matrix_report(sets: Mapping[str, IconSet], rigs: Mapping[str, Rig]) -> list[Block]:
    """Report proportion correct, worst pair and bits of every set on every rig, with the same virtual people."""
    from thermicon.circuit import simulate
    from thermicon.perception.ranking.scores import objection
    from thermicon.perception.selection.appraise import appraise

    rows, remarks = [], []
    for name, icons in sets.items():
        for rig_name, rig in rigs.items():
            members = list(icons)
            found = appraise(members, rig, people=PEOPLE, seed=SEED)
            scores = (percent(found.proportion_correct), number(found.d_prime), f"{found.information_bits:.2f}")
            rows.append((name, rig_name, str(len(members)), *scores, ",\n".join(found.worst_pair)))
            for icon in members:
                if (why := objection(simulate(icon, rig))) is not None:
                    remarks.append(f"{name} on {rig_name}: {icon.name} {why}")
    numbers = ("icons", "correct", "d′", "bits")
    return [
        grid(("set", "rig", *numbers, "worst pair"), rows, numbers),
        Text("\n".join(remarks)),
        Text(
            f"Predicted for {PEOPLE} virtual people, the same for every row (seed {SEED}): proportion correct, d′ of "
            "the worst pair and information, each set named from memory on its own. Predictions of a model, not "
            "measurements."
        ),
    ]


def comparison_line(found: SetComparison) -> str:
    """Report how often A is identified better than B, and by how much.

    >>> from thermicon.perception.selection.appraise import SetComparison
    >>> comparison_line(SetComparison(0.93, 0.02, 0.41, 100))
    'predicted: the icons of A are easier to distinguish than those of B in 93 % of 100 draws of person, contact, room \
and rig; the d′ of its worst pair is larger by 0.4 (median)'
    """
    share, better = (found.probability, "A") if found.probability >= 0.5 else (1.0 - found.probability, "B")
    other = "B" if better == "A" else "A"
    drawn = f"{found.draws} draws of person, contact, room and rig"
    if share < 0.5 + 2.0 * found.standard_error:
        return f"predicted: no difference between A and B in how well their icons are distinguished, within {drawn}"
    gain = abs(found.gain)
    return (
        f"predicted: the icons of {better} are easier to distinguish than those of {other} in {percent(share)} of "
        f"{drawn}; "
        f"the d′ of its worst pair is larger by {number(gain)} (median)"
    )

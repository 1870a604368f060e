"""Two or more sets on one or more rigs, as a table of what is predicted for each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number, percent

from .tables import show, table

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

PEOPLE = 100
FEWEST = 2


def show_matrix(sets: Mapping[str, IconSet], rigs: Mapping[str, Rig], seed: int = 0) -> None:
    """Print proportion correct, worst pair and bits of every set on every rig, with the same virtual people."""
    from thermicon.circuit import simulate
    from thermicon.perception.ranking.assemble import objection
    from thermicon.perception.selection.appraise import appraise

    numbers = ("icons", "correct", "d′", "bits")
    made = table("set", "rig", *numbers, "worst pair", numbers=numbers)
    remarks = []
    for name, icons in sets.items():
        for rig_name, rig in rigs.items():
            members = list(icons)
            found = appraise(members, rig, people=PEOPLE, seed=seed)
            made.add_row(
                name,
                rig_name,
                str(len(members)),
                percent(found.proportion_correct),
                number(found.d_prime),
                f"{found.information_bits:.2f}",
                ",\n".join(found.worst_pair),
            )
            for icon in members:
                why = objection(simulate(icon, rig))
                if why is not None:
                    remarks.append(f"{name} on {rig_name}: {icon.name} {why}")
    show(
        made,
        *(["", *remarks] if remarks else []),
        "",
        f"Predicted for {PEOPLE} virtual people, the same for every row (seed {seed}): proportion correct, d′ of the "
        "worst pair and information, each set named from memory on its own. Predictions of a model, not measurements.",
    )

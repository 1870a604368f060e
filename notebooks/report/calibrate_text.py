"""What ``thermicon calibrate`` prints: diagnostics, and every constant with what the evidence left of its prior."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .tables import show, table

if TYPE_CHECKING:
    from thermicon.perception.evidence.sampling import Sampled


def show_constants(sampled: Sampled) -> None:
    """Print diagnostics and every constant: median, 95 % interval, and what the evidence left of its prior."""
    from thermicon.perception.evidence.summaries import summarise

    draws = sampled.draws()
    rows = table(
        "constant", "median", "low", "high", "unit", "SD left", "", numbers=("median", "low", "high", "SD left")
    )
    for each in summarise(draws):
        remark = "at the edge of its prior" if each.at_edge else "not moved" if each.unmoved else ""
        numbers = (f"{each.median:.3g}", f"{each.low:.3g}", f"{each.high:.3g}")
        rows.add_row(each.name, *numbers, each.unit, f"{each.narrowed:.2f}", remark)
    show(
        f"Posterior of {len(draws.names)} constants, {draws.variable}",
        rows,
        f"{draws.header.status}; {sampled.likelihoods} likelihoods, {100.0 * sampled.acceptance:.0f} % accepted. "
        "SD left is the SD over the prior's: near 1 the evidence did not move the constant. Offsets of laboratories "
        "(E1 cold …) are in SDs of the spread between laboratories.",
    )


def worst_text(sampled: Sampled) -> str:
    """Diagnostics of the constant that has converged least."""
    from thermicon.perception.evidence.diagnostics import ESS, R_HAT

    found = sampled.diagnostics
    place = found.names.index(found.worst)
    size = f"effective sample size {found.ess[place]:.0f}, limit {ESS:g}"
    return f"R-hat {found.r_hat[place]:.3f}, limit {R_HAT:g}; {size}"

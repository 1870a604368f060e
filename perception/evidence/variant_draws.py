"""Draws of the variant that is not sampled, from the normal approximation at their maximum; marked as such.

`python -m thermicon.perception.evidence.variant_draws` writes the table of the package in a minute or two.
`python -m thermicon.perception.evidence sample --variant NAME` samples it.
"""

from __future__ import annotations

from thermicon.circuit.cores import quiet_blas

from ..observer.draws import PosteriorDraws
from ..observer.draws_file import shipped_file, to_text
from ..observer.variants import VARIABLES, Variable
from .maximum import maximise
from .posterior import Posterior
from .sampling import approximate_draws, shipped_vector


def draws_of_variant(variable: Variable) -> PosteriorDraws:
    """1,000 draws about the maximum of a variant."""
    posterior = Posterior(variable)
    with quiet_blas():
        return approximate_draws(maximise(posterior, shipped_vector(posterior)))


def main() -> None:
    """Write the tables of all variants but the default one."""
    for variant in VARIABLES[1:]:
        drawn = draws_of_variant(variant)
        shipped_file(variant).write_text(to_text(drawn.header, drawn.names, drawn.draws), encoding="utf-8")


if __name__ == "__main__":
    main()

"""A mechanism: constants with the stages of the chain that they act on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..channels import Variable


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """Part of an observer. Its docstring says what it does; fields that `constant` declares name their priors.

    `equation` is what it computes, `source` where it comes from. Mechanisms override nothing of one another: what
    follows what stands in `observer.chain`, which calls each.
    """

    equation: ClassVar[str] = ""
    source: ClassVar[str] = ""
    variable: Variable = "temperature"

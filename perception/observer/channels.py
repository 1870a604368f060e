"""Names of channels and variants that all stages share.

Two variants: temperature at receptor depth, or heat flow there (the hypothesis of Shani and Lineykin 2021).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

Channel = Literal["cold", "warm"]
MemoryForm = Literal["episodes", "naming"]
MemoryChoice = Literal["both", "episodes", "naming"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
MEMORY_FORMS: tuple[MemoryForm, ...] = get_args(MemoryForm)
"""How the episodes of an icon are remembered: in logarithms, or as ratings that are named directly."""
FORM = "form of memory"
"""Name of a laboratory's form, as its place in `MEMORY_FORMS`, in draws."""


def forms_in(memory: MemoryChoice) -> tuple[MemoryForm, ...]:
    """The forms that count; distances and reasons are those of the first.

    >>> forms_in("both"), forms_in("naming")
    (('episodes', 'naming'), ('naming',))
    """
    return tuple(form for form in MEMORY_FORMS if memory in ("both", form))


SIGN: Mapping[Channel, float] = {"cold": -1.0, "warm": 1.0}
"""Direction that a channel answers to: cooling or warming."""

Variable = Literal["temperature", "heat flow"]
VARIABLES: tuple[Variable, ...] = get_args(Variable)
"""Every variant; the first is the default."""


def check_variable(variable: str) -> Variable:
    """The variable itself, or an error that says what there is."""
    for known in VARIABLES:
        if variable == known:
            return known
    raise ValueError(f"there is no sensory variable {variable!r}: choose one of {', '.join(VARIABLES)}")


def source_of(variable: Variable) -> str:
    """The ending of a number's name in the parameter file for a variant; empty for the default."""
    return "" if variable == "temperature" else " from heat flow"


def receptor_column(variable: Variable, channel: Channel) -> str:
    """Column of a trace, or probe of a batch, that the receptors of a channel go by."""
    return f"{channel}_receptor_C" if variable == "temperature" else f"heat_flow_{channel}_receptor_W_per_m2"

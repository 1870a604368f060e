"""Which sensory variable an observer goes by.

Two variants: temperature at receptor depth, or heat flow there (the hypothesis of Shani and Lineykin 2021).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

from .channels import Channel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from thermicon.circuit import Trace

Variable = Literal["temperature", "heat flow"]
VARIABLES: tuple[Variable, ...] = get_args(Variable)
"""Every variant; the first is the default."""


def check_variable(variable: str) -> Variable:
    """The variable itself, or an error that says what there is.

    >>> check_variable("heat flow")
    'heat flow'
    """
    for known in VARIABLES:
        if variable == known:
            return known
    raise ValueError(f"there is no sensory variable {variable!r}: choose one of {', '.join(VARIABLES)}")


def drive_unit(variable: Variable) -> str:
    """Unit of receptor drive: K or W/m²."""
    return "K" if variable == "temperature" else "W/m²"


def source_of(variable: Variable) -> str:
    """How the parameter file ends the name of a number that depends on the variant; nothing for the default.

    >>> source_of("temperature"), source_of("heat flow")
    ('', ' from heat flow')
    """
    return "" if variable == "temperature" else " from heat flow"


def receptor_column(variable: Variable, channel: Channel) -> str:
    """Column of a trace, or probe of a batch, that the receptors of a channel go by.

    >>> receptor_column("heat flow", "cold")
    'heat_flow_cold_receptor_W_per_m2'
    """
    return f"{channel}_receptor_C" if variable == "temperature" else f"heat_flow_{channel}_receptor_W_per_m2"


def receptor_input(trace: Trace, variable: Variable, channel: Channel) -> NDArray[np.float64]:
    """What the receptors of a channel go by in a trace: °C, or W/m² into the skin, shape (rows,)."""
    found: NDArray[np.float64] = getattr(trace, receptor_column(variable, channel))
    return found

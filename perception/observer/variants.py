"""Which sensory variable an observer goes by, and which receptor model turns it into drive.

Two variables: temperature at receptor depth, or heat flow there (the hypothesis of Shani and
Lineykin 2021). Two models: `adapting`, this project's, and `ring-de-dear`, impulses counted over
a window, which exists for temperature alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

from .channels import Channel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from thermicon.circuit import Trace

Variable = Literal["temperature", "heat flow"]
Model = Literal["adapting", "ring-de-dear"]
VARIABLES: tuple[Variable, ...] = get_args(Variable)
MODELS: tuple[Model, ...] = get_args(Model)
VARIANTS: tuple[tuple[Variable, Model], ...] = (
    ("temperature", "adapting"),
    ("heat flow", "adapting"),
    ("temperature", "ring-de-dear"),
)
"""Every variable and model that go together; the first is the default."""


def check_variant(variable: str, model: str) -> tuple[Variable, Model]:
    """The pair itself, or an error that says what there is.

    >>> check_variant("heat flow", "adapting")
    ('heat flow', 'adapting')
    """
    if variable not in VARIABLES:
        raise ValueError(f"there is no sensory variable {variable!r}: choose one of {', '.join(VARIABLES)}")
    if model not in MODELS:
        raise ValueError(f"there is no receptor model {model!r}: choose one of {', '.join(MODELS)}")
    for known in VARIANTS:
        if (variable, model) == known:
            return known
    raise ValueError(f"the {model} model has constants for temperature alone: use it without {variable!r}")


def drive_unit(variable: Variable, model: Model) -> str:
    """Unit of receptor drive: K, W/m² or impulses."""
    if model == "ring-de-dear":
        return "impulses"
    return "K" if variable == "temperature" else "W/m²"


def source_of(variable: Variable, model: Model) -> str:
    """How the parameter file ends the name of a number that depends on the variant; nothing for the default.

    >>> source_of("temperature", "adapting"), source_of("heat flow", "adapting")
    ('', ' from heat flow')
    """
    if model == "ring-de-dear":
        return " from impulses"
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

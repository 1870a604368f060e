"""A rig that is known exactly so that its gate judges one corner."""

from thermicon.circuit import Rig

KEYS = (
    *("contact_resistance_relative", "ambient_K", "gain_relative", "heat_sink_K"),
    *("seebeck_relative", "conductance_relative", "plates_relative"),
)
WHY = "measured on our own bench in May"
SURE = (
    *(word for key in KEYS for word in ("--set", f"uncertainty.{key}=0")),
    *("--set", f'uncertainty.reason="{WHY}"'),
)
"""The same as options of a command."""
CERTAIN: dict[str, object] = {**{f"uncertainty.{key}": 0 for key in KEYS}, "uncertainty.reason": WHY}
"""The same as changes of a rig."""


def sure_rig(name: str = "thenar", *but: str) -> Rig:
    """The rig of that name without any uncertainty but these, such as `gain_relative`."""
    return Rig.load(name).with_(**{key: value for key, value in CERTAIN.items() if key.split(".")[1] not in but})

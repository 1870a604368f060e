"""The keys of a rig that can be fitted to a log."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass

from thermicon.base.files.inputs import InputError, shipped_table
from thermicon.base.words.near_words import did_you_mean, nearest_words

from ..rig.rig import Rig
from ..rig.rigfile import rig_keys, unknown_key
from ..rig.settings import flattened
from ..rig.uncertainty import Uncertainty


class FitError(InputError):
    """A log or a request that cannot be fitted: what, where, and what to change."""


@dataclass(frozen=True, slots=True)
class FitKey:
    """One parameter to fit: its key in a rig file, what people call it, and how to measure it without a fit (`direct`).

    `log`: a positive scale, fitted as its logarithm. `room` is how far the fit may move it, and `usual` the half width
    of an interval that says no more than is assumed anyway: a factor and a share where `log`, else in the key's unit.
    `uncertainty` is the key of [uncertainty] that its interval belongs to, or nothing.
    """

    key: str
    words: str
    log: bool
    room: float
    usual: float
    uncertainty: str
    direct: str


CONTACT = "contact.resistance_m2K_per_W"


def _table() -> dict[str, FitKey]:
    """The keys of ``data/fit-keys.toml``, in their order; `usual` is the shipped uncertainty unless given there."""
    keys = {}
    for key, row in shipped_table("fit-keys.toml").items():
        usual = row["usual"] if "usual" in row else getattr(Uncertainty(), row["uncertainty"])
        keys[key] = FitKey(**{"uncertainty": "", **row, "key": key, "usual": usual})
    return keys


_LAG = "a step of temperature on the sensor alone, such as dipping it into warm water"
_PROBE = re.compile(r"probe\.(?P<name>[\w-]+)\.lag_s")

COMMON = (CONTACT, "module.seebeck_V_per_K", "module.resistance_ohm")
"""What a log of display and voltage identifies on every rig with a module."""


UNDER_DISPLAY = (CONTACT, "skin.rest_C")
"""What a display tells that drives the skin without a known current, as on a thermode."""


def fittable(rig: Rig, alone: bool = False) -> tuple[str, ...]:
    """Return the keys that can be fitted on a rig, in the order of the circuit; `alone`: without a known current."""
    known = [
        key
        for key in (UNDER_DISPLAY if alone or rig.thermode else _table())
        if value_of(rig, key) is not None and (rig.controller or not key.startswith("controller."))
    ]
    return (*known, *(f"probe.{probe.name}.lag_s" for probe in rig.probes))


def possible_keys(rig: Rig, alone: bool = False) -> tuple[FitKey, ...]:
    """Return all keys that a fit can begin from, what most logs tell first; a lag of 0 has a bound there."""
    known = [key for key in fittable(rig, alone) if value_of(rig, key)]
    return free_keys(sorted(known, key=lambda key: key not in COMMON), rig, alone)


def free_keys(keys: Sequence[str], rig: Rig, alone: bool = False) -> tuple[FitKey, ...]:
    """The parameters to fit, `alone` without a known current; FitError for none, one twice, and one that cannot be."""
    names = [key.strip() for key in keys if key.strip()]
    if not names:
        raise FitError(f"no key to fit; name one or several, such as {COMMON[0]}")
    if twice := [name for place, name in enumerate(names) if name in names[:place]]:
        raise FitError(f"{twice[0]}: is given twice; name each key once")
    known = fittable(rig, alone)
    if faults := [_fault(name, rig, known) for name in names if name not in known]:
        raise FitError("\n".join(faults))
    lag = "lag of the thermistor {}"
    return tuple(
        _table().get(name) or FitKey(name, lag.format(name.split(".")[1]), False, 30.0, 0.1, "", _LAG) for name in names
    )


def _fault(name: str, rig: Rig, known: Sequence[str]) -> str:
    if name in _table() and set(known) <= {*UNDER_DISPLAY, *(key for key in known if _PROBE.fullmatch(key))}:
        why = f"rig {rig.name} is a thermode" if rig.thermode else "no log has a current"
        return f"{name}: {why}, so that the display is the drive, and only {', '.join(known)} can be fitted"
    if name in _table():
        table = name.partition(".")[0]
        return f"{name}: rig {rig.name} has no {table.replace('_', ' ')} with this key; it has {', '.join(known)}"
    if _PROBE.fullmatch(name):
        sensor = '[{name="thermistor", place="display", lag_s=0.2}]'
        return (
            f"{name}: rig {rig.name} has no such probe; describe the sensor first, by the key probe={sensor}, and "
            f"fit probe.thermistor.lag_s"
        )
    generic = re.sub(r"\.(layer|probe)\.[^.]+\.", r".\1.0.", name)
    if generic in rig_keys():
        return f"{name}: is a key of a rig, but no log identifies it; keys that can be fitted: {', '.join(known)}"
    if nearest_words(name, known, cutoff=0.55):
        return f"{name}: cannot be fitted; {did_you_mean(name, known, 1)}"
    return f"{unknown_key(name)}; keys that can be fitted: {', '.join(known)}"


def value_of(rig: Rig, key: str) -> float | None:
    """Return the value of a key that can be fitted, in the unit of the rig file; None where it is not given."""
    if key.startswith("module."):
        return float(getattr(rig.module, key.partition(".")[2]))
    if match := _PROBE.fullmatch(key):
        return next((probe.lag_s for probe in rig.probes if probe.name == match["name"]), None)
    value = flattened(json.loads(rig.document)).get(key, 0.0 if key.endswith(".lag_s") else None)
    if key == "driver.transconductance_A_per_V" and value is None:
        return rig.driver.transconductance_A_per_V
    return None if value is None else float(str(value))

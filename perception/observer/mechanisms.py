"""The mechanisms of the observer, and how each is turned off: what ablation takes out, alone and together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from thermicon.icons.near_words import did_you_mean

from .delays import LEG_M_PER_S

Without = frozenset[str]


@dataclass(frozen=True, slots=True)
class Mechanism:
    """A mechanism by name: what it is replaced by, and the parameters that are then not inferred, with their values."""

    name: str
    replaced_by: str
    fixed: Mapping[str, float] = field(default_factory=dict)


MECHANISMS = (
    Mechanism(
        "delays",
        "conduction of the leg, 2.1 and 0.5 m/s, and no way from cord to brain",
        {f"{channel} conduction velocity": velocity for channel, velocity in LEG_M_PER_S.items()},
    ),
    Mechanism(
        "depth",
        "0.15 and 0.30 mm counted from the surface at every site",
        {"cold receptor depth": 0.15, "warm receptor depth": 0.30},
    ),
    Mechanism("skin", "tabulated tissue under a light contact", {
        "contact resistance of a thermode": 5.4e-4, "effusivity of living skin": 1.0,
    }),
    Mechanism("cold limit", "any fall of temperature is cold, however warm", {"cold limit": 33.0}),
    Mechanism("warm limit", "any rise of temperature is warm, however cold", {"warm limit": 31.7}),
    Mechanism("ends of summation", "a power of area without ends"),
    Mechanism("transducer", "the square law, ψ ∝ u² near threshold", {"transducer exponent": 2.0}),
    Mechanism("gain noise", "additive noise alone", {"gain noise": 1e-6}),
    Mechanism("criterion between people", "one criterion for all", {"criterion between people": 1e-6}),
    Mechanism("decision between trials", "one decision time a person", {"decision time between trials": 1e-6}),
    Mechanism("choice time", "a choice takes as long as a simple reaction", {"choice time": 1e-6}),
    Mechanism("caution", "the criterion of limits after a pre-pulse too", {"caution after a pre-pulse": 1.0}),
    Mechanism("age", "no effect of age", {
        "cold sensitivity lost per decade": 0.0, "warm sensitivity lost per decade": 0.0,
    }),
    Mechanism("laboratories", "no difference between laboratories", {"sensitivity between laboratories": 1e-6}),
)  # fmt: skip


def find_mechanism(name: str) -> Mechanism:
    """A mechanism by name; a ValueError names the nearest.

    >>> find_mechanism("choice time").replaced_by
    'a choice takes as long as a simple reaction'
    """
    for mechanism in MECHANISMS:
        if mechanism.name == name:
            return mechanism
    raise ValueError(f"there is no mechanism {name!r}: {did_you_mean(name, {each.name for each in MECHANISMS})}")


def check_without(names: Iterable[str]) -> Without:
    """Names of mechanisms as a set; a ValueError for one that does not exist names the nearest.

    >>> sorted(check_without(["gain noise", "cold limit"]))
    ['cold limit', 'gain noise']
    """
    return frozenset(find_mechanism(name).name for name in names)

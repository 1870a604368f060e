"""The mechanisms of the observer, and how each is turned off: what ablation takes out, alone and together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from thermicon.icons.near_words import did_you_mean

from .channels import Channel
from .parts import LEG_M_PER_S

Without = frozenset[str]
Carrier = Literal["observer", "people", "rig", "inference"]

NONE = 1e-6
"""A parameter that is inferred in its logarithm is turned off at this value, which is as good as 0."""


@dataclass(frozen=True, slots=True)
class Mechanism:
    """A mechanism by name: what it is replaced by, and the parameters that are then not inferred, with their values.

    `carrier` is what it acts on: the `observer`, the `people` drawn around it, the `rig`, or the `inference` alone;
    `cure` says how it is turned off there.
    """

    name: str
    replaced_by: str
    fixed: Mapping[str, float] = field(default_factory=dict)
    carrier: Carrier = "observer"
    cure: str = ""

    def off(self, parameter: str) -> float:
        """Value of one of its parameters when it is turned off: that of the inference, but 0 for as good as 0."""
        value = self.fixed[parameter]
        return 0.0 if value == NONE else value


DEPTH_MM: dict[Channel, float] = {"cold": 0.15, "warm": 0.30}
"""Depths below the face of the skin, stratum corneum included: Ho 2018, as cited by Shani & Lineykin 2021."""
LIGHT_CONTACT_M2K_PER_W = 5.4e-4
"""Contact of the shipped rigs (Ho & Jones, for alumina); a strapped thermode presses harder and conducts better."""
IN_INFERENCE = "what it is worth stands in perception/data/ablation.csv"

MECHANISMS = (
    Mechanism(
        "delays",
        "conduction of the leg, 2.1 and 0.5 m/s, and no way from cord to brain",
        {f"{channel} conduction velocity": velocity for channel, velocity in LEG_M_PER_S.items()},
    ),
    Mechanism(
        "depth",
        "0.15 and 0.30 mm counted from the surface at every site",
        {f"{channel} receptor depth": depth for channel, depth in DEPTH_MM.items()},
        "rig",
        "give the rig skin.depth_from = \"surface\", "
        f"skin.cold_receptor_mm = {DEPTH_MM['cold']:.2f} and skin.warm_receptor_mm = {DEPTH_MM['warm']:.2f}",
    ),
    Mechanism(
        "skin",
        "tabulated tissue under a light contact",
        {"contact resistance of a thermode": LIGHT_CONTACT_M2K_PER_W, "effusivity of living skin": 1.0},
        "rig",
        "the shipped rigs have tabulated tissue already; for a light contact give the rig "
        f"contact.resistance_m2K_per_W = {LIGHT_CONTACT_M2K_PER_W:g}",
    ),
    # Limits that are off do nothing: they stay at the middles of their priors.
    Mechanism("cold limit", "any fall of temperature is cold, however warm", {"cold limit": 33.0}),
    Mechanism("warm limit", "any rise of temperature is warm, however cold", {"warm limit": 31.7}),
    Mechanism("ends of summation", "a power of area without ends"),
    Mechanism("transducer", "the square law, ψ ∝ u² near threshold", {"transducer exponent": 2.0}),
    Mechanism("gain noise", "additive noise alone", {"gain noise": NONE}),
    Mechanism(
        "criterion between people", "one criterion for all", {"criterion between people": NONE}, "people",
        'draw the people without it: draw_people(n, without=["criterion between people"])',
    ),
    Mechanism("decision between trials", "one decision time a person", {"decision time between trials": NONE}),
    Mechanism("choice time", "a choice takes as long as a simple reaction", {"choice time": NONE}),
    Mechanism(
        "caution", "the criterion of limits after a pre-pulse too", {"caution after a pre-pulse": 1.0}, "inference",
        IN_INFERENCE,
    ),
    Mechanism(
        "age", "no effect of age",
        {"cold sensitivity lost per decade": 0.0, "warm sensitivity lost per decade": 0.0}, "people",
        'draw the people without it: draw_people(n, without=["age"])',
    ),
    Mechanism(
        "laboratories", "no difference between laboratories", {"sensitivity between laboratories": NONE}, "inference",
        IN_INFERENCE,
    ),
)  # fmt: skip


def find_mechanism(name: str) -> Mechanism:
    """A mechanism by name; a ValueError names the nearest."""
    for mechanism in MECHANISMS:
        if mechanism.name == name:
            return mechanism
    raise ValueError(f"there is no mechanism {name!r}: {did_you_mean(name, {each.name for each in MECHANISMS})}")


def check_without(names: Iterable[str], carrier: Carrier) -> Without:
    """Names of mechanisms that act on a carrier, as a set.

    A ValueError names the nearest to one that does not exist, and says how one that acts elsewhere is turned off.
    """
    if isinstance(names, str):
        raise ValueError(f"mechanisms are given as a list of names, such as without=[{names!r}]")
    chosen = [find_mechanism(name) for name in names]
    for mechanism in chosen:
        if mechanism.carrier != carrier:
            where = f"acts on the {mechanism.carrier}, not on the {carrier}"
            cure = mechanism.cure or f"load the observer without it: Observer.load(without=[{mechanism.name!r}])"
            raise ValueError(f"the mechanism {mechanism.name!r} {where}: {cure}")
    return frozenset(mechanism.name for mechanism in chosen)

"""Checks of the values of a rig's keys."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, NamedTuple, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from thermicon.base.files.inputs import one_line, paragraph, shipped_table

PARAMETERS = ("seebeck_V_per_K", "resistance_ohm", "thermal_resistance_K_per_W")
"""The three parameters of a module in a rig file."""


Celsius = Annotated[float, Field(ge=-20, le=120)]
Name = Annotated[str, Field(min_length=1), AfterValidator(one_line)]
Text = Annotated[str, AfterValidator(one_line)]
Paragraph = Annotated[str, AfterValidator(paragraph)]

# Parts may be idealised (almost no resistance, almost infinite capacity); beyond this, sums lose all their digits.
Ideal = Annotated[float, Field(ge=1e-15, le=1e15)]
# A current source that heats or cools skin gives some amperes and volts, never thousands.
Amperes = Annotated[float, Field(ge=1e-6, le=1000)]
Volts = Annotated[float, Field(ge=1e-6, le=1000)]
# Times of a loop or a sensor: an icon lasts an hour at most.
Lag = Annotated[float, Field(ge=0, le=3600)]
Gain = Annotated[float, Field(ge=0, le=1e6)]
Millimetres = Annotated[float, Field(ge=1e-4, le=200)]
# Air at the least, diamond (2,200 W/(m·K)) at the most.
Conductivity = Annotated[float, Field(ge=1e-3, le=1e4)]
# Air (1.2 kg/m³) to osmium (22,590 kg/m³); 1 to 20,000 J/(kg·K), where hydrogen has 14,300.
Density = Annotated[float, Field(ge=0.1, le=3e4)]
HeatCapacity = Annotated[float, Field(ge=1, le=2e4)]
# The best perfused organ, the kidney, has some 0.07 /s.
Perfusion = Annotated[float, Field(ge=0, le=1)]
# Still air has some 5, boiling water some 1e5 W/(m²·K).
Film = Annotated[float, Field(ge=1e-3, le=1e6)]

Positive = Annotated[float, Field(gt=0)]


class KeyTable(BaseModel):
    """A table of a rig file, which checks each key, and then what they are together."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    def faults(self) -> Iterable[str]:
        """A sentence for each fault between keys that are possible by themselves."""
        return ()

    @model_validator(mode="after")
    def _together(self) -> Self:
        if sentences := list(self.faults()):
            raise ValueError("\n".join(sentences))
        return self


UNITS = {
    "min_CEM43": "min CEM43",
    "W_per_m2K": "W/(m²·K)",
    "m2K_per_W": "m²·K/W",
    "J_per_kgK": "J/(kg·K)",
    "kg_per_m3": "kg/m³",
    "W_per_mK": "W/(m·K)",
    "A_per_Ks": "A/Ks",
    "As_per_K": "As/K",
    "V_per_K": "V/K",
    "A_per_V": "A/V",
    "A_per_K": "A/K",
    "W_per_K": "W/K",
    "K_per_W": "K/W",
    "J_per_K": "J/K",
    "K_per_s": "K/s",
    "per_s": "1/s",
    "cm2": "cm²",
    "ohm": "Ω",
    "min": "min",
    "mm": "mm",
    "Hz": "Hz",
    "C": "°C",
    "A": "A",
    "V": "V",
    "K": "K",
    "W": "W",
    "s": "s",
}
"""Units at the ends of keys, the longest first, as people write them."""


def name_of(key: str) -> str:
    """Return a key without the unit that ends it.

    >>> name_of("contact.resistance_m2K_per_W"), name_of("skin.site")
    ('contact.resistance', 'skin.site')
    """
    return next((key.removesuffix(f"_{unit}") for unit in UNITS if key.endswith(f"_{unit}")), key)


def unit_of(key: str) -> str:
    """Return the unit that ends a key's name, written as people write it.

    >>> unit_of("contact.resistance_m2K_per_W"), unit_of("safety.session_min"), unit_of("skin.site")
    ('m²·K/W', 'min', '')
    """
    return next((written for unit, written in UNITS.items() if key.endswith(f"_{unit}")), "")


RIG_WORDS = "rig-words.toml"


def sentence(which: str, /, **values: object) -> str:
    """A sentence of ``data/rig-words.toml`` with the values that it names."""
    table, name = which.split(".")
    return str(shipped_table(RIG_WORDS)[table][name]).format(**values)


class Unusual(NamedTuple):
    """An unusual property of a rig: its kind, and a sentence with what to do."""

    kind: str
    text: str

    @property
    def brief(self) -> str | None:
        """The same in a few words; None where safety needs the sentence."""
        brief: dict[str, str] = shipped_table(RIG_WORDS)["brief"]
        return brief.get(self.kind)


def unusual(kind: str, /, **values: object) -> Unusual:
    """An unusual property of a rig, with the values that its sentence names."""
    return Unusual(kind, sentence(f"warnings.{kind}", **values))

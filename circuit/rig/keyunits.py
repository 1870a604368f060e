"""Units at the ends of the keys of a rig file, as people write them."""

from __future__ import annotations

_UNITS = (
    "V_per_K",
    "A_per_V",
    "A_per_Ks",
    "As_per_K",
    "A_per_K",
    "W_per_Ks",
    "W_per_K",
    "K_per_W",
    "m2K_per_W",
    "W_per_m2K",
    "W_per_mK",
    "kg_per_m3",
    "J_per_kgK",
    "J_per_K",
    "K_per_s",
)
_UNITS_SHORT = {
    "C": "°C",
    "ohm": "Ω",
    "per_s": "1/s",
    "cm2": "cm²",
    "mm": "mm",
    "A": "A",
    "V": "V",
    "K": "K",
    "W": "W",
    "Hz": "Hz",
    "s": "s",
    "min": "min",
    "min_CEM43": "min CEM43",
}


def name_of(key: str) -> str:
    """Return a key without the unit that ends it.

    >>> name_of("contact.resistance_m2K_per_W"), name_of("skin.site")
    ('contact.resistance', 'skin.site')
    """
    for unit in sorted((*_UNITS, *_UNITS_SHORT), key=len, reverse=True):
        if key.endswith("_" + unit):
            return key.removesuffix("_" + unit)
    return key


def unit_of(key: str) -> str:
    """Return the unit that ends a key's name, written as people write it.

    >>> unit_of("contact.resistance_m2K_per_W"), unit_of("safety.session_min"), unit_of("skin.site")
    ('m²·K/W', 'min', '')
    """
    for unit in sorted(_UNITS, key=len, reverse=True):
        if key.endswith("_" + unit):
            over, under = unit.split("_per_")
            pretty = [part.replace("m2K", "m²·K").replace("mK", "m·K").replace("kgK", "kg·K") for part in (over, under)]
            top, bottom = (part.replace("m3", "m³").replace("m2", "m²") for part in pretty)
            return f"{top}/({bottom})" if "·" in bottom else f"{top}/{bottom}"
    for unit, written in _UNITS_SHORT.items():
        if key.endswith("_" + unit) and not key.endswith("_per_" + unit):
            return written
    return ""

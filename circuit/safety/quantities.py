"""Codes of the quantities that rules limit."""

SKIN, DISPLAY, RECEPTOR, HOT_PLATE, RATE, DOSE, BURN, WARMER = range(8)
"""Codes of quantities: the columns of WATCHED, then what is computed from them; the last three add up."""

CODE_OF = {
    **dict.fromkeys(("skin surface", "numbness", "cold pain", "heat pain"), SKIN),
    "display": DISPLAY,
    "cold-receptor depth": RECEPTOR,
    "hot plate": HOT_PLATE,
    "rate of skin temperature": RATE,
    "thermal dose": DOSE,
    "Henriques integral": BURN,
}
"""Quantities of rules, other than the time of the display above a temperature."""

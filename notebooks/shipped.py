"""``thermicon rigs`` and ``thermicon library``: what comes with the program."""

from __future__ import annotations

from thermicon.notebooks.tables import show, table
from thermicon.notebooks.wording import number


def show_rigs() -> None:
    """Print the shipped rigs: site, temperature at rest, blood temperature and standing heat flow."""
    from thermicon.circuit import Rig, rig_names

    numbers = ("rest °C", "blood °C", "flux W/m²")
    made = table("name", "title", "site", *numbers, numbers=numbers)
    notes = []
    for name in rig_names():
        rig = Rig.load(name)
        flux = number(rig.resting_flux_W_per_m2, 0)
        made.add_row(name, rig.title, rig.site, number(rig.skin.rest_C), number(rig.blood_C, 2), flux)
        notes += [f"{name}: {warning}" for warning in rig.warnings]
    show(made, "", "flux: heat flow into bare skin at rest; negative, since skin loses heat.", *notes)


def show_library() -> None:
    """Print the shipped icon sets: icons, what they prescribe, what they are for, and their source."""
    from thermicon.icons import Family, library_names, load_library

    for position, name in enumerate(library_names()):
        icons = load_library(name)
        made = table("", "", "")
        made.show_header = False
        for icon in icons.entries:
            tags = f"({', '.join(icon.metadata.tags)})" if icon.metadata.tags else ""
            count = f", {len(icon):,} icons" if isinstance(icon, Family) else ""
            made.add_row(f"  {icon.name}{count}", icon.metadata.means or "", tags)
        source = "; ".join(text for text in (icons.metadata.by, icons.metadata.doi) if text)
        show(
            *([""] if position else []),
            f"{name}: {icons.title}" if icons.title else name,
            f"  prescribes {PRESCRIBES[icons.frame.control]}; source: {source or 'not stated'}",
            made,
        )


PRESCRIBES = {"skin": "the skin's surface", "display": "the display's temperature", "current": "the current"}

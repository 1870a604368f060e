"""``thermicon rigs``, ``library`` and ``devices``: what comes with the program."""

from __future__ import annotations

from thermicon.icons.number_text import number

from ..report.tables import show, table


def show_rigs() -> None:
    """Print the shipped rigs: site, resting temperature, blood temperature and resting heat flow."""
    from thermicon.circuit import Rig
    from thermicon.circuit.rig.rig import rig_names

    numbers = ("rest °C", "blood °C", "flux W/m²")
    made = table("name", "title", "site", *numbers, numbers=numbers)
    notes = []
    for name in rig_names():
        rig = Rig.load(name)
        flux = number(rig.resting_flux_W_per_m2, 0)
        made.add_row(name, rig.title, rig.site, number(rig.skin.rest_C), number(rig.blood_C, 2), flux)
        notes += [f"{name}: {warning}" for warning in rig.warnings]
    show(made, "", "flux: heat flow into bare skin at rest; negative because skin loses heat.", *notes)


def show_library() -> None:
    """Print the shipped icon sets: icons with their meanings, what they control, and their source."""
    from thermicon.icons import Family, load_library
    from thermicon.icons.files.shipped import library_names

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
            f"  controls {PRESCRIBES[icons.context.control]}; source: {source or 'not stated'}",
            made,
        )


def show_devices() -> None:
    """Print the shipped devices with input, range, resolution and rate, then the file formats."""
    from thermicon.circuit import Device
    from thermicon.circuit.delivery.device import device_names
    from thermicon.circuit.delivery.formats import format_names, load_format

    made = table("device", "driven by", "range", "resolution", "rate")
    devices = [Device.load(name) for name in device_names()]
    for device in devices:
        low, high = device.interval("set-point range" if device.unit == "°C" else "output range")
        unit = {"V": "V", "°C": "°C"}.get(device.unit, "A")
        bits, step = device.record("resolution"), device.record("set-point step")
        steps = f"{bits.central:g} bits" if bits else f"{step.central:g} K" if step else "–"
        fastest = next(
            (_rate(device.most(name)) for name in ("update rate", "carrier frequency") if device.record(name)),
            f"{device.most('tick') * 1e3:g} ms ticks",
        )
        made.add_row(device.name, device.driven_by, f"{number(low)} to {number(high)} {unit}", steps, fastest)
    forms = table("format", "content", "default device")
    for name in format_names():
        form = load_format(name)
        forms.add_row(name, form.title, form.device)
    played = [device.name for device in devices if device.played]
    tested = f"Tested on hardware: {', '.join(played)}." if played else "None of them has been tested on hardware yet."
    show(
        made,
        "",
        *(f"{device.name}: {device.title}" for device in devices),
        "",
        forms,
        "",
        tested,
        "Describe your own device in a .toml file like the shipped ones, with a source for each number.",
    )


def _rate(value_Hz: float) -> str:
    size, unit = next((size, unit) for size, unit in ((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz")) if value_Hz >= size)
    return f"{number(value_Hz / size)} {unit}"


PRESCRIBES = {"skin": "the skin surface temperature", "display": "the display temperature", "current": "the current"}

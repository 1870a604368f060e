"""``thermicon list``: everything that ships with the program."""

import shlex
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from thermicon.base.files.atomic import OutputError
from thermicon.base.files.inputs import InputError
from thermicon.base.words.installing import install
from thermicon.base.words.number_text import number

from ..files.outputs import check_output
from ..loading import load_rig
from ..messages import note, usage
from ..report.blocks import grid
from ..report.terminal import show
from .options import CrowdOptions, RigOptions, flag, opt, read_set, write_text


def list_command(
    rig: RigOptions,
    what: Annotated[
        Literal["icons", "rigs", "modules", "devices", "formats", "ports"] | None,
        typer.Argument(
            metavar="icons|rigs|modules|devices|formats|ports",
            show_default=False,
            help="What to list.  [default: all but ports]",
        ),
    ] = None,
    cite: Annotated[
        str | None,
        opt(
            "FILE", "Instead: two paragraphs for the methods section: icons, and prediction with --rig if it is given."
        ),
    ] = None,
    bibtex: Annotated[bool, flag("--bibtex", "With --cite: BibTeX of the program and of the set's sources.")] = False,
    copy: Annotated[
        tuple[str, Path] | None,
        opt(
            "NAME FILE", "Instead: write a shipped set (.cue), rig (with --set), device or study (.toml) to a new file."
        ),
    ] = None,
) -> None:
    """List shipped icon sets, rigs, modules, devices and formats of drives; cite them, or copy one to start from.

    `ports` are the serial ports of this computer, on one of which `thermicon play` finds a board.
    """
    if rig.rig and cite is None:
        raise usage("applies to the paragraph of --cite", "--rig")
    if rig.set and cite is None and copy is None:
        raise usage("applies to a copy of a rig, or to the paragraph of --cite", "--set")
    if [what, cite, copy].count(None) < 2:
        raise usage("list, --cite and --copy are different things: ask for one of them", "--cite" if cite else "--copy")
    if bibtex and cite is None:
        raise usage("belongs to --cite FILE", "--bibtex")
    if cite is not None:
        cite_file(cite, rig, bibtex)
    elif copy is not None:
        copy_shipped(*copy, rig.changes)
    else:
        shown = {"icons": show_icons, "rigs": show_rigs, "modules": show_modules, "devices": show_devices,
                 "formats": show_formats, "ports": show_ports}  # fmt: skip
        for place, each in enumerate([what] if what else [each for each in shown if each != "ports"]):
            if place:
                typer.echo("")
            shown[each]()


def cite_file(file: str, rig: RigOptions, as_bibtex: bool) -> None:
    """Print the methods paragraphs of a file, with a rig if given, or its BibTeX."""
    from thermicon.circuit.rig.rig_words import rig_summary
    from thermicon.icons.files.cite import bibtex, methods

    icons = read_set([file])
    where = rig.load(icons, file) if rig.given else None
    about = None if where is None else rig_summary(where, for_methods=True)
    crowd = f"{CrowdOptions.people} virtual people, seed {CrowdOptions.seed}"
    typer.echo(bibtex(icons) if as_bibtex else methods(icons, about, crowd))
    if not as_bibtex:
        note(f"note: {crowd} are what rank takes by default; state those of your command")


def copy_shipped(name: str, output: Path, changes: Sequence[str] = ()) -> None:
    """Write the file of a shipped set, rig, device or study under a new name; what is there already is kept.

    A rig with changes is called by its file.
    """
    from importlib import resources

    from thermicon.base.words.near_words import did_you_mean
    from thermicon.circuit.delivery.device import device_names
    from thermicon.circuit.rig.layout import layout_names
    from thermicon.circuit.rig.rig import rig_names
    from thermicon.icons.files.shipped import library_names

    from ..study.study_file import SHIPPED

    own = shlex.quote(str(output))
    kinds = (
        (library_names(), "icons", "library", "{}.cue", f"thermicon rank {own}"),
        (rig_names(), "circuit", "rigs", "{}.toml", f"thermicon rank six-icons --rig {own}"),
        (layout_names(), "circuit", "layouts", "{}.toml", f"thermicon simulate SET --rig {own}"),
        (device_names(), "circuit", "devices", "{}.toml", f"thermicon export SET --device {own} --to FORMAT -o drives"),
        (("study", "example"), "notebooks", "data", SHIPPED,
         f"write your set, rig and device into {own}, then thermicon study {own} -o study"),
    )  # fmt: skip
    for names, package, folder, file, following in kinds:
        if name in names:
            check_output(output, (Path(file).suffix,), f"a copy of {name}")
            if output.exists():
                raise OutputError(f"{output} already exists and was kept; give another name")
            if changes and folder != "rigs":
                raise usage(f"changes keys of a rig, and {name} is none: change the copy with a text editor", "--set")
            if changes:
                load_rig(name, changes).save(output, output.stem)
                note(f"wrote {output}")
            else:
                shipped = resources.files(f"thermicon.{package}").joinpath(folder, file.format(name))
                write_text(shipped.read_text(encoding="utf-8"), output)
            note(f"Next: {following}")
            return
    known = [each for names, *_ in kinds for each in names]
    raise usage(f"{name!r} is not shipped; {did_you_mean(name, known)}", "--copy")


def show_rigs() -> None:
    """Print the shipped rigs: site, resting temperature, blood temperature and resting heat flow."""
    from thermicon.circuit import Layout, Rig
    from thermicon.circuit.rig.layout import layout_names
    from thermicon.circuit.rig.rig import rig_names

    numbers = ("rest °C", "blood °C", "flux W/m²")
    rigs = [Rig.load(name) for name in rig_names()]
    rows = [
        (
            *(rig.name, rig.title, rig.site, number(rig.skin.rest_C)),
            *(number(rig.deep_C, 2), number(rig.resting_flux_W_per_m2, 0)),
        )
        for rig in rigs
    ]
    notes = [f"{rig.name}: {warning}" for rig in rigs for warning in rig.warnings]
    said = "flux: heat flow into bare skin at rest; negative because skin loses heat."
    layouts = [Layout.load(name) for name in layout_names()]
    elements = [(each.name, each.title, ", ".join(one.name for one in each.elements)) for each in layouts]
    show([grid(("name", "title", "site", *numbers), rows, numbers), "\n".join([said, *notes])])
    show([grid(("layout", "title", "elements"), elements)])


def show_modules() -> None:
    """Print the modules on record, a line for each data sheet."""
    from thermicon.circuit.rig.modules import FIGURES, module_rows

    said = "cm² of face, J/K of each plate (–: not on record), hot side. To use one: --set module.name=NAME"
    show([grid(("module", *FIGURES), module_rows(), FIGURES), said])


def show_icons() -> None:
    """Print the shipped icon sets: icons with their meanings, what they control, and their source."""
    from thermicon.icons import Family
    from thermicon.icons.files.shipped import library_names, load_library

    for position, name in enumerate(library_names()):
        icons, rows = load_library(name), []
        for icon in (*icons.entries, *icons.spatial):
            tags = f"({', '.join(icon.metadata.tags)})" if icon.metadata.tags else ""
            count = f", {len(icon):,} icons" if isinstance(icon, Family) else ""
            rows.append((f"  {icon.name}{count}", icon.metadata.means or "", tags))
        source = "; ".join(text for text in (icons.metadata.by, icons.metadata.doi) if text)
        if position:
            typer.echo("")
        controls = f"  controls {PRESCRIBES[icons.context.control]}; source: {source or 'not stated'}"
        show([f"{name}: {icons.title}\n{controls}" if icons.title else f"{name}\n{controls}"])
        show([grid(("", "", ""), rows)])


def show_devices() -> None:
    """Print the shipped devices with input, range, resolution and rate, and which were tested on hardware."""
    from thermicon.circuit import Device
    from thermicon.circuit.delivery.device import device_names

    devices = [Device.load(name) for name in device_names()]
    rows = []
    for device in devices:
        reach = next(record for record in device.records if record.quantity in ("set-point range", "output range"))
        low, high = device.interval(reach.quantity)
        bits, step = device.record("resolution"), device.record("set-point step")
        steps = f"{bits.central:g} bits" if bits else f"{step.central:g} K" if step else "–"
        fastest = next(
            (_rate(device.most(name)) for name in ("update rate", "carrier frequency") if device.record(name)),
            f"{device.most('tick') * 1e3:g} ms ticks",
        )
        rows.append((device.name, device.driven_by, f"{number(low)} to {number(high)} {reach.unit}", steps, fastest))
    played = [device.name for device in devices if device.played]
    tested = f"Tested on hardware: {', '.join(played)}." if played else "None of them has been tested on hardware yet."
    own = "Describe your own device in a .toml file like the shipped ones (--copy), with a source for each number."
    titles = "\n".join(f"{device.name}: {device.title}" for device in devices)
    live = ", ".join(device.name for device in devices if device.driven_by == "temperatures")
    lives = f"Plays live: {live}, simulated or on a board of your own (thermicon play; written from documents)."
    show(
        [
            grid(("device", "driven by", "range", "resolution", "rate"), rows),
            titles,
            f"{tested}\n{lives}\n{own}",
        ]
    )


def show_ports() -> None:
    """Print the serial ports of this computer, with maker and serial number where they have them."""
    try:
        comports: Any = import_module("serial.tools.list_ports").comports
    except ImportError as error:
        raise InputError(f"ports need pyserial, which is not installed: {install('pyserial')}") from error
    ports = sorted(comports())
    rows = [(port.device, port.manufacturer or "–", port.product or "–", port.serial_number or "–") for port in ports]
    titles = ("port", "maker", "product", "serial number")
    show([grid(titles, rows) if rows else "no serial port; a board is one once it is plugged in"])


def show_formats() -> None:
    """Print the file formats of drives, and the device that each is for."""
    from thermicon.circuit.delivery.formats import format_names, load_format

    forms = [(name, load_format(name)) for name in format_names()]
    show([grid(("format", "content", "default device"), [(name, form.title, form.device) for name, form in forms])])


def _rate(value_Hz: float) -> str:
    size, unit = next((size, unit) for size, unit in ((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz")) if value_Hz >= size)
    return f"{number(value_Hz / size)} {unit}"


PRESCRIBES = {"skin": "the skin surface temperature", "display": "the display temperature", "current": "the current"}

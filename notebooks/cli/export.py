"""``thermicon export``: icons as drive files with sidecars, or the reasons why they are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.icons.number_text import number

from ..files.export_folder import check_export_folder
from ..files.exporting import PreparedExport, others, prepare_icons, write
from ..messages import REFUSED, note, progress_bar
from ..report.gate_words import gate_words
from .cues import pick, read_set, warn_of_site

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
    from thermicon.circuit.delivery.prepare import Prepared

NUMBER = re.compile(r"\d+(\.\d+)?")
CAUTION = (
    "safety is a calculation, not a medical or ethical clearance; hardware on skin needs a temperature cut-off that "
    "works without software"
)


def export_file(
    file: str,
    to: str,
    device: str | None,
    icon: str | None,
    rig: Rig,
    tail_s: float,
    force: bool,
    folder: Path,
    pause_s: float | None = None,
) -> None:
    """Write the icons of a file (or the one named) as drives for a device; exit code 3 if that is refused."""
    from thermicon.circuit.delivery.formats import load_format
    from thermicon.circuit.delivery.pack import check_names

    form = load_format(to)
    check_export_folder(folder, replace=force)
    whole = read_set([file])
    chosen = pick(whole, icon)
    check_names([one.name for one in chosen], form)
    warn_of_site(file, whole, rig)
    with progress_bar("simulating") as progress:
        rest = others(whole, chosen)
        ready = prepare_icons(chosen, rest, rig, device, to, step=progress, tail_s=tail_s, pause_s=pause_s)
    for warning in ready.warnings:
        note(warning)
    if refused(ready, force):
        for line in (*map(icon_line, ready.prepared), *warning_lines(ready.prepared)):
            note(line)
        note(CAUTION)
        note("nothing was written")
        raise typer.Exit(REFUSED)
    report_icons(ready.prepared)
    written = write(ready, folder, overwrite=force, insist=force)
    count = len(ready.prepared)
    drives = "1 drive with its sidecar" if count == 1 else f"{count} drives with their sidecars"
    note(f"wrote {drives} into {folder}: {', '.join(_shown(written.names))}")
    if written.before is not None:
        note(f"the folder as it was before is {written.before}")
    note(f"to play: {form.how}")
    note(CAUTION)


def report_icons(ready: Sequence[Prepared]) -> None:
    """Report how every icon is played and how far that is from the design, and the gate's demands on the hardware.

    For drives played open loop, one more line gives the uncertainty due to an uncharacterised module.
    """
    for one in ready:
        note(icon_line(one))
    for line in warning_lines(ready):
        note(line)
    for about, text in gate_words(ready):
        note(f"{about}: {text}")
    spreads = [(one.spread, one.delivery.icon.name) for one in ready if one.spread is not None]
    if spreads:
        widest, name = max(spreads, key=lambda each: each[0].step_K[1] - each[0].step_K[0])
        note(f"{name}: {widest}")


def icon_line(one: Prepared) -> str:
    """How an icon is played and how far that is from the design."""
    delivery = one.delivery
    receptors = [each for each in one.deviation.places if "receptor" in each.place]
    largest = 1e3 * max(abs(each.largest_K) for each in receptors)
    rms = 1e3 * max(each.rms_K for each in receptors)
    return (
        f"{delivery.icon.name}: {number(delivery.file_s, 2)} s {steps_of(delivery)} on "
        f"{delivery.device.name}, receptors within {number(largest)} mK of the design (RMS {number(rms)} mK), "
        f"safety {one.verdict.colour} in {one.verdict.scenarios} scenarios"
    )


def warning_lines(ready: Sequence[Prepared]) -> Iterator[str]:
    """Every warning once, for its first icon; those that differ in numbers alone follow by name."""
    alike: dict[str, tuple[str, str, list[str]]] = {}
    for one in ready:
        for warning in one.warnings:
            name = one.delivery.icon.name
            kind = NUMBER.sub("#", str(warning))
            alike.setdefault(kind, (name, str(warning), []))[2].append(name)
    for name, warning, names in alike.values():
        others = [each for each in dict.fromkeys(names) if each != name]
        more = f"; alike, with numbers in their sidecars: {', '.join(others)}" if others else ""
        yield f"warning: {name}: {warning}{more}"


def refused(ready: PreparedExport, force: bool) -> bool:
    """Report why icons are refused or forced; True if nothing may be written."""
    found = ready.against
    final = any(not refusal.forcible for _, refusal in found)
    for name, refusal in found:
        stops = final or not force
        note(f"{'refused' if stops else 'forced'}: {name} {'is ' if refusal.kind != 'lossy' else ''}{refusal}")
    forcible = any(refusal.forcible for _, refusal in found)
    if forcible and not force and not final:
        note("--force exports it nevertheless, and the sidecar records that")
    return final or (forcible and not force)


def steps_of(delivery: DeliveredDrive) -> str:
    """Update rate of a drive, or its number of segments."""
    from thermicon.circuit.delivery.setpoints import Setpoints

    played = delivery.played
    if isinstance(played, Setpoints):
        return f"in {len(played.segments)} segments"
    return f"at {number(delivery.rate_Hz, 1)} Hz"


def _shown(names: Sequence[str], most: int = 6) -> list[str]:
    return [*names[:most], *([f"and {len(names) - most} more"] if len(names) > most else [])]

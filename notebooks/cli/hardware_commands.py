"""The commands for real hardware: ``export`` and ``devices``. ``main`` registers them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from ..messages import Missing, check_changes, load_rig, usage
from ..report.options import Changes, IconName, RigName, Tail, check_pause, check_tail


def export_command(
    file: Annotated[
        str | None,
        typer.Argument(metavar="FILE", help="A cue file, or the name of a shipped set.", show_default=False),
    ] = None,
    to: Annotated[
        str | None, typer.Option("--to", metavar="FORMAT", help="File format; thermicon devices lists them.")
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            readable=False,
            help="Folder for drives and sidecars; nothing else should be in it.",
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option("--device", metavar="DEVICE", help="A shipped device or a .toml file.  [default: by format]"),
    ] = None,
    icon: IconName = None,
    tail: Tail = 0.0,
    pause: Annotated[
        float | None,
        typer.Option("--pause", metavar="S", help="Seconds between plays, 0 to 600.  [default: the recovery time]"),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force",
            help="Replace files, and export icons that are lossy or not reached; unsafe ones never.",
        ),
    ] = False,
    rig: RigName = None,
    changes: Changes = None,
    verify: Annotated[
        Path | None,
        typer.Option(
            "--verify",
            metavar="DIR",
            readable=False,
            help="Write nothing; check that drives, sidecars, rig and program in DIR belong together.",
        ),
    ] = None,
) -> None:
    """Export drive files for hardware, each with a sidecar that describes it and its predicted effects.

    Every icon is simulated as the device delivers it. An icon that is unsafe, not reached, or loses too much on the
    device is refused with the reason; then nothing is written, and the exit code is 3.

    --verify DIR checks an exported folder; the exit code is 1 if its files do not belong together.
    """
    if verify is not None:
        options = {"--to": to, "-o": folder, "--device": device, "--icon": icon, "--pause": pause}
        _alone(file, {**options, "--rig": rig, "--set": changes})
        if force or tail:
            raise usage("takes no other argument; leave out --force and --tail", "--verify")
        from .verifying import verify_folder

        verify_folder(verify)
        return
    if file is None:
        raise Missing("argument 'FILE'")
    if to is None:
        raise Missing("option '--to'")
    if folder is None:
        raise Missing("option '-o' / '--output'")
    check_changes(changes or [])
    check_tail(tail)
    check_pause(pause)
    from .export import export_file

    export_file(file, to, device, icon, load_rig(rig, changes or []), tail, force, folder, pause)


def _alone(file: str | None, options: Mapping[str, object]) -> None:
    """Fail with a usage error unless --verify is all that is given."""
    given = ([f"the file {file}"] if file is not None else []) + [name for name, value in options.items() if value]
    if given:
        raise usage(f"takes no other argument; leave out {', '.join(given)}", "--verify")


def devices_command() -> None:
    """List the devices and file formats for export, and which devices have been tested on hardware."""
    from .shipped import show_devices

    show_devices()

"""The commands for real hardware: ``export`` and ``devices``. They are put on the program in ``cli``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from thermicon.notebooks.door import check_changes, load_rig
from thermicon.notebooks.options import Changes, IconName, OneFile, RigName, Tail, check_tail


def export_command(
    file: OneFile,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help="Kind of file; thermicon devices lists them.")],
    folder: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", readable=False, help="Folder for drives and sidecars.")
    ],
    device: Annotated[
        str | None,
        typer.Option("--device", metavar="DEVICE", help="A shipped device or a .toml file.  [default: by format]"),
    ] = None,
    icon: IconName = None,
    tail: Tail = 0.0,
    force: Annotated[
        bool,
        typer.Option("--force", help="Replace files, and export what is lossy or not reached; never what is unsafe."),
    ] = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Write drives for hardware, each with a sidecar that tells what it is and what it will do.

    Every icon is simulated as the device delivers it. What is unsafe, not reached, or loses too much on the device is
    refused with the reason; then nothing is written, and the exit code is 3.
    """
    check_changes(changes or [])
    check_tail(tail)
    from thermicon.notebooks.export import export_file

    export_file(file, to, device, icon, load_rig(rig, changes or []), tail, force, folder)


def devices_command() -> None:
    """List the devices and the formats that export knows, and whether a device was ever played."""
    from thermicon.notebooks.shipped import show_devices

    show_devices()

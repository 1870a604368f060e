"""What a page offers to download: links that carry their files, so that no address of the server serves any."""

from __future__ import annotations

import io
import zipfile
from base64 import b64encode
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ..report.blocks import fragment

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.circuit import Rig

TYPES = {
    ".cue": "text/plain",
    ".toml": "text/plain",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".pdf": "application/pdf",
    ".zip": "application/zip",
}
DPI = 200


def link(name: str, data: bytes) -> str:
    """A link that saves a file under a name.

    >>> link("a.cue", b"cue 1")
    '<a class="th-download" download="a.cue" href="data:text/plain;base64,Y3VlIDE=">a.cue</a>'
    """
    address = f"data:{TYPES.get(Path(name).suffix, 'application/octet-stream')};base64,{b64encode(data).decode()}"
    return fragment("download", name, address)


def figure_files(stem: str, figure: Figure) -> dict[str, bytes]:
    """A figure as PNG, SVG and PDF, by file name."""
    files = {}
    for kind in ("png", "svg", "pdf"):
        drawn = io.BytesIO()
        figure.savefig(drawn, format=kind, dpi=DPI, bbox_inches="tight", facecolor="white")
        files[f"{stem}.{kind}"] = drawn.getvalue()
    return files


def rig_text(rig: Rig) -> str:
    """The rig file of a rig."""
    with TemporaryDirectory(prefix="thermicon-") as folder:
        path = Path(folder) / "rig.toml"
        rig.save(path)
        return path.read_text(encoding="utf-8")


def zipped(files: Mapping[str, bytes]) -> bytes:
    """Files as one archive."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return held.getvalue()

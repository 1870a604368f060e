"""Which older files an export may replace: those that an export wrote, and only if no other drive is left without."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .outputs import OutputError

if TYPE_CHECKING:
    from thermicon.circuit.packing.claims import Claims

CURE = "give a folder of its own, such as -o drives"


def replaced_with(files: Mapping[str, bytes], there: Mapping[str, Path], folder: Path) -> tuple[str, ...]:
    """Return older files that go because their sidecars are replaced by those of other drives.

    ``files`` are those of an export, ``there`` the files of its folder. Raises OutputError where one that no export
    wrote would be replaced, or one that belongs to a drive that stays.
    """
    if not there:
        return ()
    from thermicon.circuit.packing.digests import digest

    claims = claims_in(there)
    ours = {*claims, *(name for each in claims.values() for name in each.digests)}
    for name, content in files.items():
        if name in there and name not in ours and there[name].read_bytes() != content:
            raise OutputError(not_ours(folder / name))
    kept = {sidecar: each for sidecar, each in claims.items() if sidecar not in files}
    for sidecar, each in kept.items():
        for name, known in each.digests.items():
            if name in files and digest(files[name]) != known:
                raise OutputError(
                    f"{folder / name} belongs to {sidecar} too, which would be left without it; export all icons of "
                    f"the set together, or {CURE}"
                )
    needed = {name for each in kept.values() for name in each.digests}
    gone = []
    for sidecar, each in claims.items():
        for name, known in each.digests.items() if sidecar in files else ():
            if name in files or name in needed or name in gone or name not in there:
                continue
            if digest(there[name].read_bytes()) != known:
                raise OutputError(
                    f"{folder / name} no longer matches its sidecar {sidecar}, and would be left without one; "
                    f"move it away, or {CURE}"
                )
            gone.append(name)
    return tuple(gone)


def not_ours(path: Path) -> str:
    """Why a file is not replaced that no export wrote."""
    return f"{path} was not written by an export, since no sidecar lists it, and is kept; move it away, or {CURE}"


def claims_in(there: Mapping[str, Path]) -> dict[str, Claims]:
    """What the sidecars among some files claim, by the names of the sidecars."""
    from thermicon.circuit.packing.claims import LONGEST, claims_of

    found = {}
    for name, path in there.items():
        if path.suffix == ".json" and path.stat().st_size <= LONGEST:
            claims = claims_of(path.read_bytes())
            if claims is not None:
                found[name] = claims
    return found

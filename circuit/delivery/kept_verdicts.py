"""Verdicts of the gate that are kept in the user's private cache folder.

A file is named by a hash of everything that its verdicts depend on, and begins with a hash of itself; it holds plain
values, from which nothing is executed. Whatever is not as it was written counts as absent, and is judged anew.
"""

from __future__ import annotations

import json
import os
import platform
import secrets
import stat
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from fractions import Fraction
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from thermicon.base.files.cache_folder import WRITABLE_BY_OTHERS, cache_folder, private_folder
from thermicon.base.numbers.program import DRIVES, SUFFIXES, code_digest

from ..rig.rules import Limits, Rule
from ..rig.uncertainty import Uncertainty
from ..safety.checks import Before, Check, Scenario
from ..safety.demands import CutOff, Demands, Harm, HeldCutOff, Loop, PolarityCheck, SingleFault
from ..safety.gate import Gate
from ..safety.repeated import Repeated
from .delivered_drive import DeliveredDrive
from .ways import worst_cases

TOOLS = ("numpy", "scipy", "numba", "llvmlite")
"""Packages whose version may change a digit of a verdict."""
LARGEST, MOST = 20_000_000, 100_000_000
"""Bytes of a file, and of all; the oldest give way."""
STARTED_S = time.time()
RECORDS = {
    record.__name__: record
    for record in (
        *(Before, Check, CutOff, Demands, Gate, Harm, HeldCutOff, Limits, Loop, PolarityCheck, Repeated, Rule),
        *(Scenario, SingleFault, Uncertainty),
    )
}
"""All that a verdict is made of, by name."""


def kept_or_judged(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> Sequence[Gate]:
    """What `worst_cases` finds, judged now or by this program before; only what may be written is kept."""
    try:
        folder, known_by = private_folder(cache_folder() / "verdicts"), digest_of(deliveries)
    except (OSError, TypeError):  # nowhere to keep it, or something that a digest cannot hold
        return worst_cases(deliveries, pause_s)
    known = read(folder / name_of(known_by, pause_s), len(deliveries))
    if known is not None:
        return known
    verdicts = worst_cases(deliveries, pause_s)
    if all(verdict.colour != "red" for verdict in verdicts) and not changed_since(STARTED_S):
        pauses_s = {verdict.repeated.pause_s for verdict in verdicts}
        with suppress(OSError, TypeError):  # a full disk, or something that a file cannot hold
            for pause in {pause_s, *pauses_s} if len(pauses_s) == 1 else {pause_s}:  # None stands for the pause found
                write(folder / name_of(known_by, pause), verdicts)
    return verdicts


def digest_of(deliveries: Sequence[DeliveredDrive]) -> str:
    """Hash of the program, of its tools, and of all that is delivered together, with rig and device."""
    tools = [import_module(tool).__version__ for tool in TOOLS]
    return sha256(text_of((code_digest(), sys.version, platform.machine(), tools, deliveries))).hexdigest()


def name_of(digest: str, pause_s: float | None) -> str:
    """The name of the file of verdicts with a pause."""
    return sha256(f"{digest} {pause_s!r}".encode()).hexdigest()


def changed_since(time_s: float) -> bool:
    """Whether the program on the disk was changed: what runs is then not what its digest is of."""
    root = Path(__file__).parents[2]
    sources = (path for package in DRIVES for path in (root / package.rpartition(".")[2]).rglob("*"))
    return any(max(path.stat().st_ctime, path.stat().st_mtime) > time_s for path in sources if path.suffix in SUFFIXES)


def read(path: Path, count: int) -> tuple[Gate, ...] | None:
    """Verdicts on so many drives; None where there is no file, or not one that this user wrote as it is."""
    try:
        state = path.lstat()
        foreign = sys.platform != "win32" and (state.st_uid != os.geteuid() or state.st_mode & WRITABLE_BY_OTHERS)
        if foreign or not stat.S_ISREG(state.st_mode) or state.st_size > LARGEST:
            return None
        seal, _, content = path.read_bytes().partition(b"\n")
        if seal != sealed(path, content):
            return None
        verdicts = record_of(json.loads(content))
        sound = len(verdicts) == count and all(type(one) is Gate and one.colour != "red" for one in verdicts)
    except (OSError, ValueError, TypeError, LookupError, AttributeError, RecursionError):
        return None
    return verdicts if sound else None


def write(path: Path, verdicts: Sequence[Gate]) -> None:
    """Keep verdicts whole or not at all, and remove the oldest where all take too much; raises OSError."""
    content = text_of(tuple(verdicts))
    if len(content) > LARGEST:
        return
    draft = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
    try:
        draft.write_bytes(sealed(path, content) + b"\n" + content)
        draft.chmod(0o600)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
    room = MOST
    with suppress(OSError):  # others write and remove at the same time
        for file in sorted(path.parent.iterdir(), key=lambda one: one.lstat().st_mtime, reverse=True):
            room -= file.lstat().st_size
            if room < 0:
                file.unlink()


def sealed(path: Path, content: bytes) -> bytes:
    """Hash of a file's content and of its name, so that none takes the place of another."""
    return sha256(path.name.encode() + content).hexdigest().encode()


def text_of(value: Any) -> bytes:
    """Records, arrays and plain values as JSON, equal only where all of their types and values are."""
    return json.dumps(plain(value)).encode()


def plain(value: Any) -> Any:
    """A value as a list of its type and content, or itself; raises TypeError for what has none."""
    name = type(value).__name__
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return [name, value.dtype.str, value.shape, sha256(value.tobytes()).hexdigest()]
    if is_dataclass(value):
        return [name, {field.name: plain(getattr(value, field.name)) for field in fields(value)}]
    if isinstance(value, BaseModel):
        return [name, {key: plain(getattr(value, key)) for key in type(value).model_fields}]
    if isinstance(value, Mapping):
        return ["dict", [[plain(key), plain(each)] for key, each in value.items()]]
    if isinstance(value, tuple | list):
        return ["tuple", [plain(each) for each in value]]
    return [name, str(value)] if isinstance(value, Fraction) else value


def record_of(value: Any) -> Any:
    """The record that `plain` wrote; raises LookupError for any other than those of a verdict."""
    if not isinstance(value, list):
        return value
    name, content = value
    if name == "tuple":
        return tuple(map(record_of, content))
    if name == "dict":
        return {record_of(key): record_of(each) for key, each in content}
    return RECORDS[name](**{key: record_of(each) for key, each in content.items()})

"""Verdicts of the gate that are kept in the user's private cache folder.

A file is named by a hash of everything that its verdicts depend on, and begins with a hash of itself; it holds plain
values, from which nothing is executed. Whatever is not as it was written counts as absent, and is judged anew.
"""

import json
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from fractions import Fraction
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from thermicon.base.files.cache_folder import cache_folder, private_folder, sealed_content, write_sealed
from thermicon.base.numbers.program import DRIVES, SUFFIXES, code_digest, numerics

from ..rig.rules import Limits, Rule
from ..rig.uncertainty import Uncertainty
from ..safety.checks import Before, Check, Scenario
from ..safety.demands import CutOff, Demands, Harm, HeldCutOff, Loop, PolarityCheck, SingleFault
from ..safety.gate import Gate
from ..safety.repeated import Repeated
from .delivered_drive import DeliveredDrive
from .ways import worst_cases

LARGEST, MOST, STARTED_S = 20_000_000, 100_000_000, time.time()
"""Bytes of a file and of all, of which the oldest give way; when this program began."""
SINGLE = CutOff, Demands, Harm, HeldCutOff, Loop, PolarityCheck, SingleFault
RECORDS: tuple[type, ...] = (Before, Check, Gate, Limits, Repeated, Rule, Scenario, Uncertainty, *SINGLE)
"""All that a verdict is made of."""


def kept_or_judged(deliveries: Sequence[DeliveredDrive], pause_s: float | None, about: str = "") -> Sequence[Gate]:
    """What `worst_cases` finds, judged now or by this program before; only what may be written is kept.

    `about`: what else its file is of, such as the layout.
    """
    try:
        folder = private_folder(cache_folder() / "verdicts")
        judged = text_of((code_digest(), numerics(), deliveries))
    except (OSError, TypeError):  # nowhere to keep it, or something that a hash cannot hold
        return worst_cases(deliveries, pause_s)
    path = folder / sha256(judged + repr(pause_s).encode() + about.encode()).hexdigest()
    if (known := read(path, len(deliveries))) is not None:
        return known
    verdicts = worst_cases(deliveries, pause_s)
    if all(verdict.colour != "red" for verdict in verdicts) and not changed_since(STARTED_S):
        with suppress(OSError, TypeError):  # a full disk, or something that a file cannot hold
            write(path, verdicts)
    return verdicts


def changed_since(time_s: float) -> bool:
    """Whether the program on the disk was changed: what runs is then not what its digest is of."""
    folders = [Path(__file__).parents[2] / package.rpartition(".")[2] for package in DRIVES]
    states = [path.stat() for folder in folders for path in folder.rglob("*") if path.suffix in SUFFIXES]
    return any(max(state.st_ctime, state.st_mtime) > time_s for state in states)


def read(path: Path, count: int) -> tuple[Gate, ...] | None:
    """Verdicts on so many drives; None where there is no file, or not one that this user wrote as it is."""
    if (content := sealed_content(path, LARGEST)) is None:
        return None
    try:
        verdicts = record_of(json.loads(content))
        sound = len(verdicts) == count and all(type(one) is Gate and one.colour != "red" for one in verdicts)
        return verdicts if sound else None
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
        return None


def write(path: Path, verdicts: Sequence[Gate]) -> None:
    """Keep verdicts whole or not at all, and remove the oldest where all take too much; raises OSError."""
    write_sealed(path, text_of(tuple(verdicts)))
    room = MOST
    with suppress(OSError):  # others write and remove at the same time
        for file in sorted(path.parent.iterdir(), key=lambda one: one.lstat().st_mtime, reverse=True):
            room -= file.lstat().st_size
            if room < 0:
                file.unlink()


def text_of(value: Any) -> bytes:
    """Records, arrays and plain values as JSON, equal only where all of their types and values are; else TypeError."""
    return json.dumps(plain(value)).encode()


def plain(value: Any) -> Any:
    """A value as a list of its type and content, or itself."""
    name = type(value).__name__
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return [name, value.dtype.str, value.shape, sha256(value.tobytes()).hexdigest()]
    if is_dataclass(value) or isinstance(value, BaseModel):
        names = type(value).model_fields if isinstance(value, BaseModel) else [field.name for field in fields(value)]
        return [name, {key: plain(getattr(value, key)) for key in names}]
    if isinstance(value, Mapping):
        return ["dict", [[plain(key), plain(each)] for key, each in value.items()]]
    if isinstance(value, tuple | list):
        return ["tuple", [plain(each) for each in value]]
    return [name, str(value)] if isinstance(value, Fraction) else value


def record_of(value: Any) -> Any:
    """What `plain` wrote of a verdict; raises LookupError for any other record."""
    if not isinstance(value, list):
        return value
    name, content = value
    if name == "tuple":
        return tuple(map(record_of, content))
    if name == "dict":
        return {record_of(key): record_of(each) for key, each in content}
    record = {record.__name__: record for record in RECORDS}[name]
    return record(**{key: record_of(each) for key, each in content.items()})

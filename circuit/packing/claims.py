"""What a sidecar claims: the files that belong to it, each with its digest."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

LONGEST = 64 * 2**20
"""Bytes; nothing longer is taken for a sidecar."""


@dataclass(frozen=True, slots=True)
class Claims:
    """The drive that a sidecar describes, and the digests (SHA-256) of it and of the files of its set, by name.

    A digest is empty where the sidecar holds none.
    """

    drive: str
    digests: Mapping[str, str]


def claims_of(content: bytes) -> Claims | None:
    """Return what a file claims as a sidecar; None where it is not a sidecar.

    >>> claims_of(b'{"thermicon": "0.1.0", "file": "a.csv", "drive_sha256": "77"}')
    Claims(drive='a.csv', digests={'a.csv': '77'})
    >>> claims_of(b"[1, 2]") is None
    True
    """
    held = table_of(content)
    if held is None or not isinstance(held.get("file"), str) or "thermicon" not in held:
        return None
    shared = held.get("set_files")
    named = {str(name): str(one) for name, one in shared.items()} if isinstance(shared, dict) else {}
    return Claims(held["file"], {held["file"]: str(held.get("drive_sha256") or ""), **named})


def table_of(content: bytes) -> dict[str, Any] | None:
    """Return the JSON object that a file holds, None where it holds none."""
    if len(content) > LONGEST:
        return None
    try:
        held = json.loads(content)
        json.dumps(held, ensure_ascii=False).encode("utf-8")  # half characters and endless nesting are no text
    except (ValueError, RecursionError):
        return None
    return held if isinstance(held, dict) else None

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
    document = table_of(content)
    if document is None or not isinstance(document.get("file"), str) or "thermicon" not in document:
        return None
    shared = document.get("set_files")
    named = {str(name): str(digest) for name, digest in shared.items()} if isinstance(shared, dict) else {}
    return Claims(document["file"], {document["file"]: str(document.get("drive_sha256") or ""), **named})


def table_of(content: bytes) -> dict[str, Any] | None:
    """Return the JSON object that a file holds, None where it holds none."""
    if len(content) > LONGEST:
        return None
    try:
        document = json.loads(content)
        json.dumps(document, ensure_ascii=False).encode("utf-8")  # half characters and endless nesting are no text
    except (ValueError, RecursionError):
        return None
    return document if isinstance(document, dict) else None

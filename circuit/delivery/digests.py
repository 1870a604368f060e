"""Digests that bind the files of an export together: of bytes, and of content that is written as JSON."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any


def digest(content: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal digits.

    >>> digest(b"")[:8]
    'e3b0c442'
    """
    return hashlib.sha256(content).hexdigest()


def digest_of_content(content: Any) -> str:
    """Return the SHA-256 of content as JSON with sorted keys, the text that a rig's document is kept in.

    >>> digest_of_content({"b": 1, "a": 2.5}) == digest(b'{"a": 2.5, "b": 1}')
    True
    """
    return digest(json.dumps(plain(content), sort_keys=True, ensure_ascii=False).encode("utf-8"))


def plain(content: Any) -> Any:
    """Return content as JSON can hold it: mappings, lists, finite numbers; NaN and infinity become None.

    >>> plain({1: (float("inf"), 2)})
    {'1': [None, 2]}
    """
    if isinstance(content, Mapping):
        return {str(key): plain(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [plain(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content

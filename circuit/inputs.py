"""Reading files that people wrote: one clear error each for what is not a readable text file."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path


class InputError(Exception):
    """Bad input, told in plain words: what, where, value, limit, unit, cure."""


def read_text(path: Path, what: str, limit_MB: float, error: type[InputError] = InputError) -> str:
    """Return the text of `path`, or raise `error` with a sentence that says what is wrong with the file.

    `what` names the kind of file in the message ("rig file"); files over `limit_MB` are refused before they are read.
    """
    try:
        if path.is_dir():
            raise error(f"{path}: this is a directory, not a {what}")
        size = path.stat().st_size
        if size > limit_MB * 1e6:
            raise error(f"{path}: {size / 1e6:.0f} MB is too large for a {what}; the limit is {limit_MB:g} MB")
        data = path.read_bytes()
    except FileNotFoundError:
        raise error(f"{path}: no such {what}") from None
    except OSError as problem:
        raise error(f"{path}: cannot be read ({problem.strerror or problem})") from None
    if not data.strip():
        raise error(f"{path}: the file is empty; a {what} was expected")
    if b"\0" in data:
        raise error(f"{path}: this is a binary file, not a {what} (a zero byte at offset {data.index(0)})")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{path}: not UTF-8 text (byte {problem.start}); save the {what} as UTF-8") from None


def signed(value: float, form: str = "g") -> str:
    """Return a number as people write it, with a real minus sign.

    >>> signed(-0.25), signed(-2.956, ".2f"), signed(3.0)
    ('−0.25', '−2.96', '3')
    """
    return f"{value:{form}}".replace("-", "−")


def nearest(word: str, known: Iterable[str], most: int = 3) -> str:
    """Return a "did you mean …" sentence with the nearest known words, or one that lists them all.

    >>> nearest("thenr", ["thenar", "shani2021"])
    'did you mean thenar?'
    >>> nearest("xyz", ["thenar", "shani2021"])
    'known: shani2021, thenar'
    """
    names = sorted(known)
    close = difflib.get_close_matches(word, names, n=most, cutoff=0.55)
    if close:
        return f"did you mean {' or '.join(close)}?"
    return f"known: {', '.join(names)}" if len(names) <= 12 else f"known: {', '.join(names[:12])}, …"

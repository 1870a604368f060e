"""Files that people hand in, read with a limit: only regular files, and never more bytes than the limit."""

import stat
from pathlib import Path
from typing import Literal

FileKind = Literal["folder", "device", "pipe", "socket"]


class NotRegular(Exception):
    """What is at a path cannot be read as a file; ``kind`` says what it is."""

    def __init__(self, kind: FileKind) -> None:
        super().__init__(f"this is a {kind}, not a file")
        self.kind = kind


class TooLarge(Exception):
    """A file has more bytes than may be read; ``size`` is what the system says it has, or what was read of it."""

    def __init__(self, size: int) -> None:
        super().__init__(f"{size:,} bytes")
        self.size = size


def read_limited(path: Path, most_bytes: int) -> bytes:
    """Return what is in a regular file of at most ``most_bytes``.

    Devices and pipes are refused before they are opened, since they may have no end or never answer; of a file that
    grows while it is read, no more than the limit is read. Raises NotRegular, TooLarge, and OSError or ValueError (a
    zero byte in the path) as the system does.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.cue"
    ...     _ = path.write_bytes(b"cue 1")
    ...     read_limited(path, 5)
    b'cue 1'
    """
    found = path.stat()
    if (kind := _kind(found.st_mode)) is not None:
        raise NotRegular(kind)
    if found.st_size > most_bytes:
        raise TooLarge(found.st_size)
    with path.open("rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise TooLarge(len(data))
    return data


def _kind(mode: int) -> FileKind | None:
    if stat.S_ISREG(mode):
        return None
    if stat.S_ISDIR(mode):
        return "folder"
    if stat.S_ISFIFO(mode):
        return "pipe"
    return "socket" if stat.S_ISSOCK(mode) else "device"

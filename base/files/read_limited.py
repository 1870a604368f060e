"""The reader of input files with a limit on their size."""

import stat
from pathlib import Path
from typing import Literal

FileKind = Literal["folder", "device", "pipe", "socket"]


class NotRegular(Exception):
    """A path that cannot be read as a file; ``kind`` says what it is."""

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
    """
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        named: dict[FileKind, bool] = {
            "folder": stat.S_ISDIR(found.st_mode),
            "pipe": stat.S_ISFIFO(found.st_mode),
            "socket": stat.S_ISSOCK(found.st_mode),
        }
        raise NotRegular(next((kind for kind, fits in named.items() if fits), "device"))
    if found.st_size > most_bytes:
        raise TooLarge(found.st_size)
    with path.open("rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise TooLarge(len(data))
    return data

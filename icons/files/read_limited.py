"""Input files, read with a limit of size."""

import errno
import stat
from pathlib import Path
from typing import Literal

from ..model.errors import whole_file

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


def bytes_of(path: Path, what: str, suffix: str, most_bytes: int, smaller: str) -> bytes | None:
    """Content of a file of icons, or None if there is none of this name; CueErrors name `what` it should hold."""
    try:
        return read_limited(path, most_bytes)
    except NotRegular as found:
        if found.kind == "folder":
            help = f"name a {suffix} file in it, such as {path / f'my-{what}{suffix}'}"
            raise whole_file("E002", str(path), f"a {what} is one file", help) from None
        raise whole_file("E003", str(path), str(found), "save what it gives as a file, and name that") from None
    except TooLarge as found:
        raise whole_file("E004", str(path), str(found), smaller) from None
    except (OSError, ValueError) as error:
        if getattr(error, "errno", None) in (errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG):
            return None
        said = getattr(error, "strerror", None) or error
        help = "check that it is there and that you may read it"
        raise whole_file("E003", str(path), f"the system says: {said}", help) from None

"""The content of a file of icons or the mistake that says why it cannot be read."""

import errno
from pathlib import Path

from thermicon.base.files.read_limited import NotRegular, TooLarge, read_limited

from ..model.errors import whole_file


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

"""Read cue files and the icon sets that ship with the package."""

import errno
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from ..language.parse import parse
from ..language.source import MOST_BYTES
from ..model.errors import whole_file
from ..model.iconset import IconSet
from ..model.words import nearest
from .input_files import NotRegular, TooLarge, read_limited


def library_names() -> tuple[str, ...]:
    """Return the names of the shipped sets, sorted.

    Returns
    -------
    tuple of str
        Names that ``load_library`` and ``read_cue`` accept.

    Examples
    --------
    >>> library_names()[:2]
    ('calibration-drive', 'cooling-step-skin')
    """
    return tuple(
        sorted(entry.name.removesuffix(".cue") for entry in _folder().iterdir() if entry.name.endswith(".cue"))
    )


def load_library(name: str) -> IconSet:
    """Return a shipped set.

    Parameters
    ----------
    name
        Its name, see ``library_names``.

    Returns
    -------
    IconSet
        The icons of the set.

    Raises
    ------
    CueErrors
        Where no set has this name; the message gives the most similar names.

    Examples
    --------
    >>> len(load_library("six-icons"))
    6
    """
    names = library_names()
    if name not in names:
        close = nearest(name, names)
        hint = f"did you mean {close}? " if close else ""
        help = f"{hint}shipped sets are: {', '.join(names)}"
        raise whole_file(
            "E001", name if name.isprintable() else repr(name), "neither a file nor a shipped set has this name", help
        )
    return parse(_folder().joinpath(f"{name}.cue").read_bytes(), f"{name}.cue")


def read_cue(source: str | Path) -> IconSet:
    """Return the set in a file, or a shipped set.

    Parameters
    ----------
    source
        Path of a cue file, or the name of a shipped set. A path that exists takes precedence.

    Returns
    -------
    IconSet
        The icons and families of the file.

    Raises
    ------
    CueErrors
        Where the file is missing, a folder, unreadable or too large, or its text has errors.

    Examples
    --------
    >>> read_cue("six-icons").context.control
    'display'
    """
    name = str(source)
    data = file_bytes(source)
    return load_library(name) if data is None else parse(data, name)


def file_bytes(source: str | Path) -> bytes | None:
    """Return what is in a file, or None when there is not one of this name.

    Raises CueErrors when it is a folder (but not one with the name of a shipped set), unreadable or too large.

    >>> file_bytes("six-icons") is None
    True
    """
    name = str(source)
    path = Path(source)
    try:
        if path.is_dir() and name in library_names():
            return None
        return read_limited(path, MOST_BYTES)
    except FileNotFoundError:
        return None
    except NotRegular as found:
        if found.kind == "folder":
            help = f"name a .cue file in it, such as {path / 'my-set.cue'}"
            raise whole_file("E002", name, "a set is one file", help) from None
        raise whole_file("E003", name, str(found), "save what it gives as a file, and name that") from None
    except TooLarge as found:
        help = f"a cue file has at most {MOST_BYTES:,} bytes; split the set"
        raise whole_file("E004", name, str(found), help) from None
    except OSError as error:
        if error.errno in (errno.ENOTDIR, errno.ENAMETOOLONG):
            return None
        help = "check that it is there and that you may read it"
        raise whole_file("E003", name, f"the system says: {error.strerror or error}", help) from None
    except ValueError:  # a zero byte in the name
        return None


def _folder() -> Traversable:
    return resources.files("thermicon.icons").joinpath("library")

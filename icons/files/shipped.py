"""Read cue files and the icon sets that ship with the package."""

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from ..language.parse import parse
from ..language.source import MOST_BYTES
from ..model.errors import whole_file
from ..model.iconset import IconSet
from ..model.words import nearest
from .input_files import bytes_of


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
    if "\0" in name or (name in library_names() and path.is_dir()):
        return None
    return bytes_of(path, "set", ".cue", MOST_BYTES, f"a cue file has at most {MOST_BYTES:,} bytes; split the set")


def _folder() -> Traversable:
    return resources.files("thermicon.icons").joinpath("library")

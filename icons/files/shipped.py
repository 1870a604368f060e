"""Icon sets by the name of a shipped set or a file."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.files.beside import beside

from ..language.parse import parse
from ..language.source import MOST_BYTES
from ..model.errors import whole_file
from ..model.family import Family
from ..model.icon import Icon
from ..model.iconset import Entry, IconSet, UnknownIcon
from ..model.spatial import SpatialIcon
from ..model.words import nearest
from .bytes_of import bytes_of

if TYPE_CHECKING:
    import pandas as pd

FOLDER = resources.files("thermicon.icons").joinpath("library")


@dataclass(frozen=True, slots=True)
class ShippedSet:
    """The library's entry of a set; members of families count, and are not made."""

    name: str
    icons: int
    title: str
    intent: str
    source: str


@dataclass(frozen=True, slots=True, repr=False)
class Library(Mapping[str, IconSet]):
    """Shipped sets by name; ``entries`` says of each what it is, and so does its table in a notebook."""

    sets: tuple[tuple[str, IconSet], ...]

    @property
    def entries(self) -> tuple[ShippedSet, ...]:
        """Name, number of icons, title, intent and source of every set."""
        found = []
        for name, icons in self.sets:
            means = dict.fromkeys(filter(None, (each.metadata.means for each in (*icons.entries, *icons.spatial))))
            source = "; ".join(filter(None, (icons.metadata.by, icons.metadata.doi))) or "not stated"
            found.append(ShippedSet(name, len(icons), icons.title, icons.metadata.means or "; ".join(means), source))
        return tuple(found)

    def to_frame(self) -> "pd.DataFrame":
        """Return a table with one row per set and the columns name, icons, title, intent, source."""
        import pandas as pd

        return pd.DataFrame(list(self.entries))

    def __getitem__(self, name: str) -> IconSet:
        found = dict(self.sets).get(name)
        if found is None:
            close = nearest(str(name), self)
            hint = f"did you mean {close}? " if close else ""
            raise UnknownIcon(f"no shipped set is called {name!r}; {hint}there are: {', '.join(self)}")
        return found

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in self.sets)

    def __len__(self) -> int:
        return len(self.sets)

    def __repr__(self) -> str:
        return "\n".join(f"{one.name:<20}{one.icons:>6,}  {one.title}" for one in self.entries)

    def _repr_html_(self) -> str:
        return str(self.to_frame().to_html(index=False))


def library() -> Library:
    """Return all shipped sets; in a notebook they appear as a table.

    Returns
    -------
    Library
        Sets by name; ``entries`` says what each is.

    Examples
    --------
    >>> sets = library()
    >>> sets["six-icons"]["cooling-step"].metadata.means
    'a quick, strong cooling'
    >>> [entry.icons for entry in sets.entries if entry.name == "six-icons"]
    [6]
    """
    return Library(tuple((name, load_library(name)) for name in library_names()))


def library_names() -> tuple[str, ...]:
    """Return the names of the shipped sets, which ``load_library`` and ``read_cue`` accept, sorted."""
    return tuple(sorted(entry.name.removesuffix(".cue") for entry in FOLDER.iterdir() if entry.name.endswith(".cue")))


def names_on_one_element() -> tuple[str, ...]:
    """The names of the shipped sets that need no layout of several elements."""
    return tuple(name for name in library_names() if not load_library(name).spatial)


@checked
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
        close = " or ".join(filter(None, (nearest(name, names), beside(name, ".cue"))))
        hint = f"did you mean {close}? " if close else ""
        help = f"{hint}shipped sets are: {', '.join(names)}"
        raise whole_file(
            "E001", name if name.isprintable() else repr(name), "neither a file nor a shipped set has this name", help
        )
    return parse(FOLDER.joinpath(f"{name}.cue").read_bytes(), f"{name}.cue")


Icons = IconSet | Entry | Iterable[Entry] | str | Path
"""What is taken where a set is needed: the set, its name or file, or icons."""


def set_of(icons: Icons, *, spatial: bool = False) -> IconSet:
    """A set as it is, by its name or file, or of icons; SeveralElements for a `spatial` one where none is taken."""
    found = read_cue(icons) if isinstance(icons, str | Path) else icons
    found = found if isinstance(found, IconSet) else IconSet.of(found)
    if not spatial:
        found.check_one_element()
    return found


def icons_of(icons: Icons) -> tuple[Icon, ...]:
    """The icons of what `set_of` takes, members of families among them; their contexts may differ."""
    if isinstance(icons, IconSet | Family | SpatialIcon | str | Path):
        return tuple(set_of(icons))
    given = (icons,) if isinstance(icons, Icon) else icons
    found: list[Icon] = []
    for each in given:
        found += [each] if isinstance(each, Icon) else each if isinstance(each, Family) else set_of(each)
    return tuple(found)


def spatial_of(icons: IconSet | Entry | tuple[Entry, ...]) -> tuple[SpatialIcon, ...]:
    """The icons on several elements of a set or of icons; none where they are on one."""
    if isinstance(icons, IconSet):
        return icons.spatial
    given = (icons,) if isinstance(icons, Entry) else icons
    return IconSet.of(given).spatial if given and all(isinstance(each, SpatialIcon) for each in given) else ()


def by_name(icons: Icons) -> dict[str, Icon]:
    """The icons of `icons_of`, each by its name; an `InputError` where two have one name."""
    known: dict[str, Icon] = {}
    for icon in icons_of(icons):
        if icon.name in known:
            raise InputError(f"two icons are called {icon.name}; give each a name of its own")
        known[icon.name] = icon
    return known


@checked
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
    """Return what is in a file, or None when none has this name; CueErrors for a folder, or what cannot be read."""
    name = str(source)
    path = Path(source)
    if "\0" in name or (name in library_names() and path.is_dir()):
        return None
    return bytes_of(path, "set", ".cue", MOST_BYTES, f"a cue file has at most {MOST_BYTES:,} bytes; split the set")

"""Cue files as input of a command: several files joined into one set, one icon of a set."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

from thermicon.icons.number_text import number

from ..messages import note, usage

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet


MOST_ICONS = 2000
"""More icons at once than anyone reads about; families may have 100,000."""


class JoinError(Exception):
    """Files that cannot be joined, because two of them have an icon of the same name."""


@dataclass(frozen=True, slots=True)
class Joined:
    """Several sets taken as one. Unlike those of an ``IconSet``, its icons may prescribe different things."""

    sets: tuple[IconSet, ...]
    files: tuple[str, ...]

    @property
    def title(self) -> str:
        """The titles of all sets, the name of its file for one that has none; nothing where none has a title."""
        if not any(each.title for each in self.sets):
            return ""
        return "; ".join(each.title or Path(file).name for file, each in zip(self.files, self.sets, strict=True))

    def __iter__(self) -> Iterator[Icon]:
        return (icon for each in self.sets for icon in each)

    def __len__(self) -> int:
        return sum(map(len, self.sets))

    def __str__(self) -> str:
        return "\n".join(map(str, self.sets))


def read_all(files: Sequence[str]) -> list[IconSet]:
    """Read every file; CueErrors carries what is wrong in all of them, not only in the first."""
    from thermicon.icons import CueErrors, read_cue
    from thermicon.icons.model.errors import CueError

    sets: list[IconSet] = []
    errors: list[CueError] = []
    more = 0
    for file in files:
        try:
            sets.append(read_cue(file))
        except CueErrors as found:
            errors += found.errors
            more += found.more
    if errors:
        raise CueErrors(tuple(errors), more)
    return sets


def read_set(files: Sequence[str]) -> IconSet:
    """Read files and join their icons into one set; JoinError when two icons share a name."""
    sets = read_all(files)
    if len(sets) == 1:
        return sets[0]
    owner: dict[str, str] = {}
    for file, each in zip(files, sets, strict=True):
        for icon in each:
            if icon.name in owner:
                raise JoinError(
                    f"{file}: the icon {icon.name} is also in {owner[icon.name]}; "
                    f"names must differ within a set, so rename one of them"
                )
            owner[icon.name] = file
    return cast("IconSet", Joined(tuple(sets), tuple(files)))


def warn_of_frames(files: Sequence[str], icons: IconSet, rig: Rig) -> tuple[str, ...]:
    """Warn on stderr of files for another site than the rig's, and of different baselines; return the warnings."""
    warnings: list[str] = []
    sets = icons.sets if isinstance(icons, Joined) else (icons,)
    levels: dict[float, list[str]] = {}
    for file, each in zip(files, sets, strict=True):
        warnings += warn_of_site(file, each, rig)
        own = each.context.baseline_C
        levels.setdefault(rig.skin.rest_C if own is None else own, []).append(Path(file).name)
    if len(levels) > 1:
        told = ", ".join(f"{number(level, 2)} °C in {' and '.join(names)}" for level, names in levels.items())
        warnings.append(f"baselines differ: {told}; between them the skin must adapt again, which the model leaves out")
        note(f"warning: {warnings[-1]}")
    return tuple(warnings)


def warn_of_site(file: str, icons: IconSet, rig: Rig) -> tuple[str, ...]:
    """Warn on stderr when a set is for another site than the rig's; return the warning, if there is one."""
    site = icons.context.site
    if site is None or site == rig.site:
        return ()
    warning = f"{file} is for the site {site}, the rig {rig.name} is for {rig.site}"
    note(f"warning: {warning}")
    return (warning,)


def pick(icons: IconSet, name: str | None, most: int = MOST_ICONS) -> list[Icon]:
    """Return the icon of this name, or all of them; an unknown name is an error that lists the nearest.

    More than ``most`` icons, as a family may have, are a usage error.
    """
    if name is not None:
        return [icons[name]]
    if len(icons) > most:
        first = next(iter(icons)).name
        raise usage(
            f"there are {len(icons):,} icons, and at most {most:,} are allowed; name one, such as {first}", "--icon"
        )
    return list(icons)


def only(icons: IconSet, name: str | None, where: str) -> Icon:
    """Return the icon of this name, or the only one there is; a usage error that lists them where there are more."""
    found = pick(icons, name)
    if len(found) > 1:
        names = ", ".join([icon.name for icon in found[:20]] + ["…"] * (len(found) > 20))
        raise usage(f"{where} has {len(found)} icons; name one of {names}", "--icon")
    return found[0]

"""An icon set: the icons and families of one file."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import chain
from pathlib import Path
from typing import overload

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.files.atomic import complete_or_absent
from thermicon.base.results.drawn import Drawn
from thermicon.base.words.clean_text import name_fault, text_fault

from .context import Context, Metadata
from .family import Family
from .format import set_text
from .icon import Icon, content_hash
from .members import Extremes
from .spatial import SpatialIcon
from .statements import played_icons
from .units import quantity
from .words import nearest

_MOST_NAMES = 50
Entry = Icon | Family | SpatialIcon


class SeveralElements(InputError):
    """A set for several elements was given where one for a single element is needed."""


class UnknownIcon(KeyError):
    """A set has no icon of this name; the message lists those that it has, nearest first."""

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True, slots=True)
class Members(Sequence[Icon]):
    """All icons of a set in its order, members of families among them, made when asked for."""

    entries: tuple[Icon | Family, ...]

    def __len__(self) -> int:
        return sum(len(entry) if isinstance(entry, Family) else 1 for entry in self.entries)

    @overload
    def __getitem__(self, index: int) -> Icon: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Icon, ...]: ...
    def __getitem__(self, index: int | slice) -> Icon | tuple[Icon, ...]:
        if isinstance(index, slice):
            return tuple(self[place] for place in range(*index.indices(len(self))))
        place = index + len(self) if index < 0 else index
        for entry in self.entries:
            count = len(entry) if isinstance(entry, Family) else 1
            if 0 <= place < count:
                return entry[place] if isinstance(entry, Family) else entry
            place -= count
        raise IndexError(f"there is no icon at {index}: the set has {len(self)}")

    def __iter__(self) -> Iterator[Icon]:
        return chain.from_iterable(entry if isinstance(entry, Family) else (entry,) for entry in self.entries)


@dataclass(frozen=True, slots=True, repr=False)
class IconSet(Drawn):
    """Icons and families with a common context; ``set["name"]`` is an icon, a family or a member of a family.

    Parameters
    ----------
    name
        Name of the set.
    title
        One line for people.
    context
        What the icons prescribe, the baseline in °C and the body site.
    metadata
        Intent, author, DOI, licence and tags of the set.
    entries
        Icons and families in the order of the file; ``icons`` has every icon, with the members of the families.
    spatial
        Icons on several elements, in place of entries where the context names elements.

    Raises
    ------
    ValueError
        For a set without icons, two of the same name, a context that differs from that of the set, and an icon that
        plays one that the set does not have.

    Examples
    --------
    >>> from thermicon.icons import read_cue
    >>> read_cue("cooling-step-skin")
    <IconSet cooling-step-skin: 1 icon, 8 s, control skin, baseline 32 °C>
    """

    name: str
    title: str
    context: Context
    metadata: Metadata
    entries: tuple[Icon | Family, ...]
    spatial: tuple[SpatialIcon, ...] = ()

    @classmethod
    @checked
    def of(cls, icons: Entry | Iterable[Entry], name: str = "", title: str = "") -> "IconSet":
        """Return a set of icons that have a context in common: one icon, or several in their order.

        >>> from thermicon.icons import back, cool, warm
        >>> dip, glow = Icon.of("dip", cool(by=4, at=2), back(at=2)), Icon.of("glow", warm(by=3, at=1), back(at=1))
        >>> IconSet.of([dip, glow], "alerts")
        <IconSet alerts: 2 icons, 4 to 6 s, control skin>
        """
        given = (icons,) if isinstance(icons, Entry) else tuple(icons)
        if not given:
            raise InputError("a set needs at least one icon")
        entries = tuple(icon for icon in given if not isinstance(icon, SpatialIcon))
        spatial = tuple(icon for icon in given if isinstance(icon, SpatialIcon))
        return cls(name, title, given[0].context, Metadata(), entries, spatial)

    @checked
    def save(self, path: str | Path) -> None:
        """Write the set as a `.cue` file, which `read_cue` reads as an equal set; an existing file is replaced."""
        if Path(path).suffix != ".cue":
            raise InputError(f"{path}: the name of a cue file ends in .cue; call it {Path(path).stem}.cue")
        with complete_or_absent(Path(path)) as draft:
            draft.write_text(str(self), encoding="utf-8", newline="\n")

    def __post_init__(self) -> None:
        object.__setattr__(self, "entries", tuple(self.entries))
        object.__setattr__(self, "spatial", tuple(self.spatial))
        if self.name and (wrong := name_fault(self.name)):
            raise ValueError(f"set: {wrong}")
        if self.title and (wrong := text_fault(self.title)):
            raise ValueError(f"title: {wrong}")
        if not (self.entries or self.spatial):
            raise ValueError("a set needs at least one icon")
        if self.entries if self.context.elements else self.spatial:
            raise ValueError("a set that names elements has spatial icons, and nothing but them; others have none")
        known: dict[str, Entry] = {}
        for entry in (*self.entries, *self.spatial):
            if entry.name in known:
                raise ValueError(f"two icons are called {entry.name}; give each a name of its own")
            if entry.context != self.context:
                raise ValueError(
                    f"the context of icon {entry.name} is not that of the set: {entry.context} and {self.context}"
                )
            known[entry.name] = entry
        for entry in self.entries:
            head, mark, _ = entry.name.partition("_")
            if mark and isinstance(family := known.get(head), Family) and entry.name in family:
                raise ValueError(f"icon {entry.name} has the name of a member of family {head}")
            for played in played_icons(entry.template if isinstance(entry, Family) else entry.statements):
                own = known.get(played.name, known.get(played.name.partition("_")[0]))
                if own != played and not (isinstance(own, Family) and played in own):
                    raise ValueError(f"icon {entry.name} plays {played.name}, which is not in the set")

    @property
    def icons(self) -> Members:
        """Every icon, with the members of families, as a sequence that makes them when asked for.

        Raises SeveralElements, with a cure, for a set whose icons are on several elements.
        """
        self.check_one_element()
        return Members(self.entries)

    def check_one_element(self) -> None:
        """Raise SeveralElements, with a cure, for a set whose icons are on several elements."""
        if self.spatial:
            raise SeveralElements(
                f"{self.name or 'this set'} is for several elements ({', '.join(self.context.elements)}), which only "
                "check, convert, simulate, rank, export and pictures take yet; "
                'for one element, leave out "elements" and "on"'
            )

    @property
    def families(self) -> tuple[Family, ...]:
        """The families, in the order of the file."""
        return tuple(entry for entry in self.entries if isinstance(entry, Family))

    @property
    def content_hash(self) -> str:
        """SHA-256 of the canonical text, as 64 hexadecimal digits: equal sets have equal hashes, everywhere."""
        return content_hash(str(self))

    def summary(self, start: float | None = None) -> Extremes:
        """Return durations, extremes and steepest rate over all icons; ``start`` as in ``Icon.corners``."""
        found = []
        for icon in self.spatial:
            lasts = icon.duration_s
            for one in (track.corners(start) for track in icon.tracks.values()):
                found.append(Extremes(lasts, lasts, one.lowest, one.highest, one.steepest_per_s))
        for entry in self.entries:
            if isinstance(entry, Family):
                found.append(entry.summary(start))
            else:
                one = entry.corners(start)
                found.append(Extremes(one.duration_s, one.duration_s, one.lowest, one.highest, one.steepest_per_s))
        return reduce(Extremes.joined, found)

    def __len__(self) -> int:
        return len(self.spatial) or len(self.icons)

    def __iter__(self) -> Iterator[Icon]:
        return iter(self.icons)

    def __contains__(self, item: object) -> bool:
        if isinstance(item, Icon):
            return self.find(item.name) == item
        return item in self.entries if isinstance(item, Family) else isinstance(item, str) and bool(self.find(item))

    def __getitem__(self, name: str) -> Icon:
        self.check_one_element()
        found = self.find(str(name))
        if found is not None:
            return found
        names = [entry.name for entry in self.entries]
        family = next((entry for entry in self.families if str(name).partition("_")[0] == entry.name), None)
        if family is not None:
            help = f"{family.name} is a family of {len(family):,}, with members such as {family[0].name}"
            raise UnknownIcon(f"no icon is called {name!r}; {help}")
        close = nearest(str(name), names)
        hint = f"did you mean {close}? " if close else ""
        hint = hint if isinstance(name, str) else f"by place, ask .icons[{name!r}]; "
        names = [entry.name if isinstance(entry, Icon) else f"{entry[0].name}, …" for entry in self.entries]
        more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
        raise UnknownIcon(f"no icon is called {name!r}; {hint}the set has: {', '.join(names[:_MOST_NAMES])}{more}")

    def find(self, name: str) -> Icon | None:
        """Return the icon, or the member of a family, of this name; None when there is none."""
        for entry in self.entries:
            if isinstance(entry, Icon) and entry.name == name:
                return entry
            if isinstance(entry, Family) and (member := entry.find(name)) is not None:
                return member
        return None

    def __str__(self) -> str:
        return set_text(self)

    def __repr__(self) -> str:
        found = self.summary()
        count = f"{len(self):,} icon" + ("s" if len(self) > 1 else "")
        length = f"{found.shortest_s:.6g}"
        if found.longest_s > found.shortest_s:
            length += f" to {found.longest_s:.6g}"
        baseline = self.context.baseline_C
        on = f" on {', '.join(self.context.elements)}" if self.spatial else ""
        rest = f", baseline {quantity(baseline, 'absolute')}" if baseline is not None else ""
        return f"<IconSet {self.name or '(unnamed)'}: {count}{on}, {length} s, control {self.context.control}{rest}>"

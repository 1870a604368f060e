"""Export in one call: files that play the icons or the reasons for refusing them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from thermicon.base.checks.arguments import checked
from thermicon.base.files.atomic import OutputError
from thermicon.base.files.inputs import InputError
from thermicon.base.words.number_text import count_of
from thermicon.icons import IconSet, SpatialIcon
from thermicon.icons.files.shipped import Icons, by_name, read_cue, spatial_of
from thermicon.icons.model.iconset import Entry

from ..rig.layout import AnyLayout, Layout
from ..rig.rig import Rig
from .device import Device
from .export_folder import HOW, check_export_folder, publish
from .formats import Format, load_format
from .kept_verdicts import kept_or_judged
from .pack import pack
from .prepare import Prepared, Refusal, prepare_set
from .ways import worst_cases

if TYPE_CHECKING:
    from ..safety.whole import Whole

CURE = "give a new or empty folder, or use the command thermicon export, which replaces an earlier export"


class ExportError(InputError):
    """An export that was refused, or a folder that cannot take one; the text says why and what to change."""


class Felt(Protocol):
    """The change by a device in the perception of one icon."""

    @property
    def icon(self) -> str:
        """Name of the icon."""

    def losses(self) -> tuple[str, ...]:
        """One sentence for each loss that is too large."""

    def to_dict(self) -> dict[str, object]:
        """Plain data for the sidecar."""


@dataclass(frozen=True, slots=True, eq=False)
class ExportChannel:
    """What one element plays: its rig, the device that drives it, and each icon as delivered, with its verdict.

    `element` is its name; empty where it is the only one.
    """

    rig: Rig
    device: Device
    prepared: tuple[Prepared, ...]
    element: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Export:
    """The result of `export`; `rig`, `device` and `prepared` are those of its first channel.

    Attributes
    ----------
    channels
        Each display element with its rig, its device and what that delivers of each icon; one unless the icons are on
        several elements.
    form
        The file format.
    felt
        How the device changes what is felt of each icon; empty where that was not asked for.
    force
        Whether what may be forced is packed in spite of the reasons against it.
    layout
        The layout of the icons' elements; None for icons on one element.
    whole
        The verdict on all elements together; None for one element, and where an icon is not safe by itself.
    icons
        The icons on several elements, in the order of what each channel has prepared.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> result = export(load_library("six-icons")["warming-step"], "tcs2", format="tcs2-serial")
    >>> result.refused, sorted(result.files)
    ((), ['warming-step.json', 'warming-step.tcs2.txt'])
    """

    channels: tuple[ExportChannel, ...]
    form: Format
    felt: tuple[Felt, ...] = ()
    force: bool = False
    layout: Layout | None = None
    whole: Whole | None = None
    icons: tuple[SpatialIcon, ...] = ()

    def __repr__(self) -> str:
        count = count_of(len(self.prepared), "icon")
        summary = f"REFUSED: {count_of(len(self.refused), 'cause')}"
        if files := self.files:
            size = sum(len(content) for content in files.values())
            summary = f"{count_of(len(files), 'file')}, {size / 1e3:.1f} kB"
        where = self.rig.name if self.layout is None else self.layout.name
        return f"Export({count} on {where} for {self.device.name} as {self.form.name}: {summary})"

    @property
    def rig(self) -> Rig:
        """The rig of the first channel."""
        return self.channels[0].rig

    @property
    def device(self) -> Device:
        """The device of the first channel."""
        return self.channels[0].device

    @property
    def prepared(self) -> tuple[Prepared, ...]:
        """What the device of the first channel delivers of each icon, with its verdict."""
        return self.channels[0].prepared

    @property
    def tracks(self) -> tuple[Prepared, ...]:
        """What every channel plays, icon by icon."""
        return tuple(one for icon in zip(*(channel.prepared for channel in self.channels), strict=True) for one in icon)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the drives before they are played, each with the name of its icon."""
        together = [] if self.whole is None else [f"all elements together: {text}" for text in self.whole.cautions]
        return (*together, *(f"{one.delivery.name}: {text}" for one in self.tracks for text in one.warnings))

    @property
    def refused(self) -> tuple[tuple[str, Refusal], ...]:
        """Every reason against writing, with the name of its icon; a forced export has reasons and files.

        Losses of perception are listed only without other reasons, from which they would follow.
        """
        found, losses = [], self._losses
        if self.whole is not None and self.whole.colour == "red":
            found.append(("the whole layout", Refusal("unsafe", f"{self.whole.reason}; {self.whole.cure}")))
        for one in self.tracks:
            name, causes = one.delivery.name, one.refusals
            if (felt := losses.get(name, ())) and not causes:
                more = f" (and {len(felt) - 1} more such)" if len(felt) > 1 else ""
                causes = (Refusal("lossy", f"{felt[0]}{more}; use a device with a finer resolution or a higher rate"),)
            found += [(name, refusal) for refusal in causes]
        return tuple(found)

    @property
    def barred(self) -> tuple[tuple[str, Refusal], ...]:
        """The reasons for which there are no files."""
        return tuple((name, refusal) for name, refusal in self.refused if not (self.force and refusal.forcible))

    @property
    def files(self) -> Mapping[str, bytes]:
        """Bytes by file name; empty where an icon was refused."""
        if self.barred:
            return {}
        if self.layout is not None:
            from .pack_elements import pack_elements

            return pack_elements(
                self.icons, [channel.prepared for channel in self.channels], self.form, self.layout, self.whole
            )
        return pack(
            self.prepared, self.form, felt={each.icon: each.to_dict() for each in self.felt}, losses=self._losses
        )

    @property
    def _losses(self) -> dict[str, tuple[str, ...]]:
        return {each.icon: each.losses() for each in self.felt}

    def write(self, folder: str | Path, replace: bool = False, how: str = HOW) -> Path | None:
        """Make the files the content of a folder, all or none; return where what they replace stands now, if anything.

        A folder with files is replaced only with `replace`, and only if an export wrote them; `how` tells a person how
        to ask for that. Raises OutputError for a folder that cannot be written, and where an icon is refused.
        """
        if stops := self.barred:
            raise OutputError("; ".join(f"{name}: {refusal}" for name, refusal in stops))
        return publish(self.files, Path(folder), replace, how)


@checked
def export(
    icons: Icons,
    rig: AnyLayout = None,
    device: Device | str | None = None,
    format: Format | str = "csv",
    *,
    tail_s: float = 0.0,
    pause_s: float | None = None,
    force: bool = False,
    folder: str | Path | None = None,
    felt: Callable[[Sequence[Prepared]], Sequence[Felt]] | None = None,
    step: Callable[[int, int], None] | None = None,
) -> Export:
    """Prepare icons for a device, judge them for safety in the worst case, and return the files that play them.

    Nothing is written unless `folder` is given, and nothing unsafe is ever packed or written.

    Parameters
    ----------
    icons
        A set, its name or file, or icons, which may later be played in any order; also those on several elements.
    rig
        The rig, or the name or file of one, or a layout of one; None: the shipped rig of the icons' site, else thenar.
        For icons on several elements a layout that has them, or its name or file.
    device
        The device that plays the drives, or the name or file of one; None: the usual device of the format.
    format
        The file format or its name, see `thermicon.circuit.delivery.formats`.
    tail_s
        Time in s that is played after the last corner of each icon.
    pause_s
        Pause in s between plays that the verdict assumes; None: the time that the rig needs to recover.
    force
        Whether to pack icons that miss their target or lose too much; their sidecars say so. Unsafe icons stay refused,
        and no kept verdict is used.
    folder
        A folder to write the files into; it must not exist or be empty, and gets all files or none.
    felt
        Finds how the device changes what is felt of the prepared icons; None, and on several elements: not compared.
    step
        Is called after each simulated icon with how many are done, of how many.

    Returns
    -------
    Export
        The files as bytes by name. Without files where an icon was refused: then `refused` says why.

    Raises
    ------
    ExportError
        Where a folder is given and an icon is refused, or the folder is not empty or cannot be written.
    InputError
        Where the device or format cannot play an icon at all, or the rig cannot hold its baseline.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> export(load_library("six-icons")["cooling-step"], "thenar", "dac-16")
    Export(1 icon on thenar for dac-16 as csv: 2 files, ... kB)

    """
    form = load_format(format) if isinstance(format, str) else format
    played = device if isinstance(device, Device) else Device.load(device or form.device)
    whole = read_cue(icons) if isinstance(icons, str | Path) else icons
    given = whole if isinstance(whole, IconSet | Entry) else tuple(whole)
    several = spatial_of(given)
    chosen = () if several else tuple(by_name(given).values())
    if not (several or chosen):
        raise ExportError("there is no icon to export; give at least one")
    layout = Layout.of(rig, (several or chosen)[0].context.site)
    if several:
        layout.check_elements(several[0].context.elements)
    else:
        on = layout.alone
    where = None if folder is None else Path(folder)
    try:
        if where is not None:
            where.parent.mkdir(parents=True, exist_ok=True)
            check_export_folder(where, how=CURE)
        judge = worst_cases if force else kept_or_judged
        if several:
            from .on_elements import DeliveredTracks, judged_together, prepare_elements  # not needed for one element

            about = judge if force else partial(kept_or_judged, about=layout.document)
            tracks = DeliveredTracks(layout, several, tail_s)
            ready = prepare_elements(tracks, played, form, judge=about, pause_s=pause_s, step=step)
            channels = [
                ExportChannel(element.rig, played, each, element.name)
                for element, each in zip(layout.elements, ready, strict=True)
            ]
            found = Export(tuple(channels), form, (), force, layout, judged_together(layout, ready), several)
        else:
            prepared = prepare_set(chosen, on, played, form, judge=judge, tail_s=tail_s, pause_s=pause_s, step=step)
            channel = ExportChannel(on, played, prepared)
            found = Export((channel,), form, () if felt is None else tuple(felt(prepared)), force)
        if where is not None:
            found.write(where, how=CURE)
    except OutputError as problem:
        raise ExportError(str(problem)) from None
    except OSError as problem:
        raise ExportError(f"cannot write {folder}: {problem.strerror or problem}") from None
    return found

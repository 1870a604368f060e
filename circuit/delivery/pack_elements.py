"""The files of an export on several elements in memory."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from thermicon.icons import SpatialIcon

from ..rig.layout import Layout
from ..safety.demands import Demands
from ..safety.whole import Whole
from .formats import Format, FormatError
from .formats.form import OneFile, Played
from .pack import check_names, digest, sealed, sidecar, sidecar_name, sidecar_text, written
from .prepare import Prepared

OF_ELEMENT = (
    *("rig_sha256", "rig", "played", "events", "reached", "reason", "predicted", "delivered_minus_designed"),
    *("open_loop_spread", "safety", "hardware_must_prevent", "warnings"),
)
"""Keys of a sidecar that each element has of its own, where one file holds them all."""


def pack_elements(
    icons: Sequence[SpatialIcon],
    channels: Sequence[Sequence[Prepared]],
    form: Format,
    layout: Layout,
    whole: Whole | None,
) -> dict[str, bytes]:
    """Return the files of icons on several elements: one drive for all where the format holds them, else one for each.

    `channels` are what each element plays of each icon, `whole` is the verdict on all elements together. Raises
    FormatError for what is not safe.
    """
    if whole is None or not whole.safe:
        raise FormatError("the elements are not safe together; nothing is packed")
    document = json.loads(layout.document)
    about = {
        "clock": "one",
        **whole.to_dict(),
        "layout_sha256": digest(layout.document.encode("utf-8")),
        "layout": {"name": layout.name, "document": document},
    }
    files: dict[str, bytes] = {}
    if form.together is None:
        alone = [_own(one) for icon in zip(*channels, strict=True) for one in icon]
        check_names([one.delivery.icon.name for one in alone], form)
        for one in alone:
            told = {**about, "elements": [element.name for element in layout.elements], "element": one.delivery.element}
            files |= _alone(one, form, told)
        return files
    check_names([one.delivery.icon.name for one in channels[0]], form)
    drives = [_written(icon, form, form.together) for icon in zip(*channels, strict=True)]
    shared = _player(channels, form, drives, whole)
    for icon, drive, *own in zip(icons, drives, *channels, strict=True):
        told = {"name": icon.name, "text": str(icon), "content_hash": icon.content_hash}
        known = {**about, "icon": {**told, "control": icon.context.control}}
        files |= _together(own, form, form.together, known, drive, shared)
    return {**files, **shared}


def _player(
    channels: Sequence[Sequence[Prepared]], form: Format, drives: Sequence[bytes], whole: Whole
) -> dict[str, bytes]:
    """The files of the whole set, where the format has a player."""
    if form.elements_player is None:
        return {}
    played, demands = {}, {}
    for own in channels:
        element = own[0].delivery.element
        demands[element] = Demands.strictest([one.verdict.demands for one in own])
        played[element] = [
            Played(
                one.delivery,
                form.file_name(one.delivery),
                sidecar_name(one.delivery.icon.name, form),
                one.verdict.colour,
                one.verdict.repeated.recovery_s,
                one.verdict.repeated.shortest_pause_s,
                drive,
            )
            for one, drive in zip(own, drives, strict=True)
        ]
    return form.elements_player(played, demands, whole.offset_s)


def _written(icon: Sequence[Prepared], form: Format, together: OneFile) -> bytes:
    for one in icon:
        written(one, form)
    return together.write([one.delivery for one in icon])


def _own(one: Prepared) -> Prepared:
    """What one element plays as an icon with a name of its own, after which its files are called."""
    icon = one.delivery.icon
    return replace(one, delivery=replace(one.delivery, icon=replace(icon, name=f"{icon.name}-{one.delivery.element}")))


def _alone(one: Prepared, form: Format, about: Mapping[str, object]) -> dict[str, bytes]:
    """Drive and sidecar of one element."""
    drive = written(one, form)
    told = {**sidecar(one, form, None, _over([one]), drive, {}), **about}
    name = one.delivery.icon.name
    return {sidecar_name(name, form): sidecar_text(sealed(told)), form.file_name(one.delivery): drive}


def _together(
    icon: Sequence[Prepared],
    form: Format,
    together: OneFile,
    about: Mapping[str, object],
    drive: bytes,
    set_files: Mapping[str, bytes],
) -> dict[str, bytes]:
    """The one drive of all elements, and its sidecar."""
    deliveries = [one.delivery for one in icon]
    first, name = deliveries[0], deliveries[0].icon.name
    own = [sidecar(one, form, None, _over([one]), drive, set_files) for one in icon]
    shared: dict[str, Any] = {key: value for key, value in own[0].items() if key not in OF_ELEMENT}
    shared["columns"] = [asdict(column) for column in together.columns(deliveries)]
    shared["forced_over"] = _over(icon)
    shared["forced"] = bool(shared["forced_over"])
    demands = Demands.strictest([one.verdict.demands for one in icon])
    shared["hardware_must_prevent"] = demands.to_dict()
    shared["elements"] = [
        {"element": one.element, "channel": channel, "track": told["icon"], **{key: told[key] for key in OF_ELEMENT}}
        for one, channel, told in zip(deliveries, together.channels(deliveries), own, strict=True)
    ]
    return {sidecar_name(name, form): sidecar_text(sealed({**shared, **about})), form.file_name(first): drive}


def _over(ready: Sequence[Prepared]) -> list[str]:
    """The reasons over which drives are forced, each once."""
    return list(dict.fromkeys(f"{one.delivery.name}: {refusal}" for one in ready for refusal in one.refusals))

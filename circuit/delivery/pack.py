"""The files of an export in memory."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

from thermicon.base.files.records import Record
from thermicon.base.numbers.program import own_version, this_program

from ..safety.demands import Demands
from ..safety.verdict import summarise
from .delivered_drive import DeliveredDrive, loss_table
from .device import Device
from .formats import Format, FormatError
from .formats.form import Played, events_in
from .prepare import Prepared, Refusal
from .setpoints import Setpoints, lag_of


def check_names(names: Sequence[str], form: Format) -> None:
    """Raise FormatError that names both where two icons would get files of one name.

    Names that differ only in capitals count as one, since some disks make no difference.
    """
    taken: dict[str, str] = {}
    for name in names:
        stem = form.stem(name)
        other = taken.setdefault(stem.casefold(), name)
        if other is name:
            continue
        if form.stem(other) == stem:
            raise FormatError(
                f"{other} and {name}: the files of both would be called {stem} in the format {form.name}; rename one, "
                f"or export them one by one, into two folders"
            )
        raise FormatError(
            f"{other} and {name}: differ only in capitals, so that one's files would overwrite the other's on disks "
            f"that make no difference; rename one, or export them one by one, into two folders"
        )


def pack(
    ready: Sequence[Prepared],
    form: Format,
    *,
    felt: Mapping[str, Mapping[str, object]] | None = None,
    losses: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, bytes]:
    """Return the files of an export: a sidecar and a drive for each cue, then what belongs to the set."""
    names = [cue.delivery.icon.name for cue in ready]
    check_names(names, form)
    drives = [(form.file_name(cue.delivery), written(cue, form)) for cue in ready]
    shared: dict[str, bytes] = {}
    if form.player is not None and ready:
        played = []
        for cue, name, (drive, content) in zip(ready, names, drives, strict=True):
            judged, repeated = cue.verdict.colour, cue.verdict.repeated
            times = repeated.recovery_s, repeated.shortest_pause_s
            played.append(Played(cue.delivery, drive, sidecar_name(name, form), judged, *times, content))
        shared = form.player(played, Demands.strictest([cue.verdict.demands for cue in ready]))
    files: dict[str, bytes] = {}
    for cue, name, (drive, content) in zip(ready, names, drives, strict=True):
        over = [str(refusal) for refusal in cue.refusals]
        over += [str(Refusal("lossy", text)) for text in (losses or {}).get(name, ())]
        beside = _predicted_file(cue.delivery, drive)
        about = sidecar(cue, form, (felt or {}).get(name), over, content, {**shared, **beside})
        files |= {sidecar_name(name, form): sidecar_text(sealed(about)), drive: content, **beside}
    return {**files, **shared}


def written(cue: Prepared, form: Format) -> bytes:
    """The drive of a cue; raises FormatError with its name where it cannot be written."""
    name, drive = cue.delivery.icon.name, form.file_name(cue.delivery)
    if unsafe := [str(refusal) for refusal in cue.refusals if not refusal.forcible]:
        raise FormatError(f"{name}: {unsafe[0]}")
    if drive.casefold() in form.set_files:
        raise FormatError(f"{name}: its drive {drive} would be taken for the set's own {drive.casefold()}; rename it")
    try:
        return form.write(cue.delivery)
    except FormatError as problem:
        raise FormatError(f"{name}: {problem}") from None


def _predicted_file(delivery: DeliveredDrive, drive: str) -> dict[str, bytes]:
    """The predicted display beside a table of set-points, which a log is compared with."""
    stem, _, suffix = drive.rpartition(".")
    if suffix != "csv" or not delivery.device.kind.regulated:
        return {}
    from .formats.tables import write_predicted

    return {f"{stem}.predicted.csv": write_predicted(delivery)}


def sidecar_name(name: str, form: Format) -> str:
    """Name of the sidecar of an icon."""
    return f"{form.stem(name)}.json"


NO_CLEARANCE = (
    "A simulation was checked against limits. This is not a medical or ethical clearance. Hardware that touches people "
    "needs a temperature cut-off of its own that works without any software."
)

OF_THE_TARGET = ("reached", "largest_miss_K", "largest_miss_s", "rms_miss_K")
"""Left out of `predicted`: a design is judged by its target (`reached`), what is delivered by the design."""


def sidecar(
    cue: Prepared,
    form: Format,
    felt: Mapping[str, object] | None,
    forced: Sequence[str],
    drive: bytes,
    set_files: Mapping[str, bytes],
) -> dict[str, Any]:
    """Everything known about one exported drive; units are in the names.

    `felt` is the report of perception, `forced` the reasons why the drive would have been refused (empty where it was
    not). `drive` and `set_files` are the bytes of its files, recorded by their digests.
    """
    delivery = cue.delivery
    icon, rig, outcome, device = delivery.icon, delivery.rig, delivery.outcome, _device(delivery.device)
    unit = "level_A" if icon.context.control == "current" else "level_C"
    warnings = [*rig.warnings, *delivery.warnings]
    if not delivery.device.played:
        warnings.append(f"{delivery.device.name}: no such device was ever driven by thermicon")
    return {
        "thermicon": own_version(),
        "program": this_program(),
        "what_it_is_not": NO_CLEARANCE,
        "format": {
            **{"name": form.name, "source": form.source, "how_to_play": form.how},
            **(form.facts(delivery) if form.facts else {}),
            "demands_met": form.met(cue.verdict.demands),
        },
        "file": form.file_name(delivery),
        "drive_sha256": digest(drive),
        "set_files": {name: digest(content) for name, content in set_files.items()},
        "columns": [asdict(column) for column in form.columns(delivery)],
        "icon": {
            "name": icon.name,
            "text": str(icon),
            "content_hash": icon.content_hash,
            "control": icon.context.control,
        },
        "rig_sha256": digest(rig.document.encode("utf-8")),
        "rig": {
            "name": rig.name,
            "content_hash": digest(rig.document.encode("utf-8")),
            "changes": list(rig.changes),
            "document": json.loads(rig.document),
        },
        "device_sha256": digest_of_content(device),
        "device": device,
        "update_rate_Hz": {"requested": delivery.requested_Hz, "realised": delivery.rate_Hz},
        "played": _played_facts(delivery),
        "events": [
            {"name": event.name, "time_s": event.time_s, unit: event.level, "level_of": icon.context.control}
            for event in events_in(delivery)
        ],
        "reached": None if outcome is None else outcome.reached,
        "reason": None if outcome is None else outcome.reason,
        "predicted": _predicted(delivery),
        "delivered_minus_designed": {
            place.place: {"largest_K": place.largest_K, "at_s": place.at_s, "rms_K": place.rms_K}
            for place in cue.deviation.places
        },
        "open_loop_spread": None if cue.spread is None else asdict(cue.spread),
        "perception": None if felt is None else dict(felt),
        "stated_losses": [_record(record) for record in loss_table()],
        "safety": cue.verdict.to_dict(),
        "hardware_must_prevent": cue.verdict.demanded,
        "warnings": warnings,
        "forced": bool(forced),
        "forced_over": list(forced),
        "seed": None,
    }


def sidecar_text(content: Mapping[str, Any]) -> bytes:
    """Return a sidecar as JSON; missing numbers are null, never NaN."""
    return (json.dumps(plain(content), ensure_ascii=False, indent=2, allow_nan=False) + "\n").encode("utf-8")


def sealed(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a sidecar with the SHA-256 of its own text, which is that of the file without this key."""
    bare = {key: value for key, value in content.items() if key != "sidecar_sha256"}
    return {**bare, "sidecar_sha256": digest(sidecar_text(bare))}


def _played_facts(delivery: DeliveredDrive) -> dict[str, object]:
    played = delivery.played
    if isinstance(played, Setpoints):
        return {
            "segments": len(played.segments),
            "tick_s": played.tick_s,
            "step_K": played.step_K,
            "baseline_C": float(played.level_C[0]),
            "least_level_C": float(played.level_C.min()),
            "greatest_level_C": float(played.level_C.max()),
            "icon_begins_at_s": 0.0,
            "duration_s": delivery.file_s,
            "cue_ends_at_s": played.cue_s,
            "lag_s": lag_of(delivery.device),
            "clock": (
                "times count from the start command; the display follows with the lag, which is a delay and not "
                "counted as a miss or a loss"
            ),
        }
    scale = played.scale
    unit = {"1": "duty", "°C": "C"}.get(scale.unit, scale.unit)
    return {
        "samples": len(played.codes),
        "icon_begins_at_s": delivery.lead_s,
        "duration_s": delivery.file_s,
        f"offset_{unit}": scale.offset,
        f"step_{unit}": scale.step,
        "lowest_code": scale.lowest,
        "highest_code": scale.highest,
        f"low_level_{unit}": scale.offset + scale.step * scale.lowest,
        f"high_level_{unit}": scale.offset + scale.step * scale.highest,
        f"rest_{unit}": float(played.command[0]),
        f"least_command_{unit}": float(played.command.min()),
        f"greatest_command_{unit}": float(played.command.max()),
    }


def _predicted(delivery: DeliveredDrive) -> dict[str, object]:
    numbers = {**summarise(delivery.trace).to_dict(), "duration_s": delivery.file_s}
    return {key: value for key, value in numbers.items() if key not in OF_THE_TARGET}


def _device(device: Device) -> dict[str, object]:
    named = {field.name: getattr(device, field.name) for field in fields(device) if field.name != "records"}
    return {**named, "records": [_record(record) for record in device.records]}


def _record(record: Record) -> dict[str, object]:
    keys = ("quantity", "unit", "value", "low", "high", "source", "conditions", "confidence")
    return {key: value for key in keys if (value := getattr(record, key)) not in (None, "")}


def digest(content: bytes) -> str:
    """Return the SHA-256 of bytes in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def digest_of_content(content: Any) -> str:
    """Return the SHA-256 of content as JSON with sorted keys, the text that a rig's document is kept in."""
    return digest(json.dumps(plain(content), sort_keys=True, ensure_ascii=False).encode("utf-8"))


def plain(content: Any) -> Any:
    """Return content as JSON can hold it: mappings, lists, finite numbers; NaN and infinity become None."""
    if isinstance(content, Mapping):
        return {str(key): plain(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [plain(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content

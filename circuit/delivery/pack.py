"""Prepared cues packed into files: a drive and a sidecar for each, and the files of the set; nothing is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .formats import Format, FormatError
from .formats.form import Played
from .prepare import Prepared
from .prevent import must_prevent
from .refusal import Refusal
from .sidecar import sealed, sidecar, sidecar_text


def check_names(names: Sequence[str], form: Format) -> None:
    """Raise FormatError that names both where two icons would get files of one name.

    Names that differ only in capitals count as one, since some disks make no difference.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> check_names(["dip", "double-dip"], load_format("csv"))
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
                f"or export them into two folders, one by one with --icon"
            )
        raise FormatError(
            f"{other} and {name}: differ only in capitals, so that one's files would overwrite the other's on disks "
            f"that make no difference; rename one, or export them into two folders, one by one with --icon"
        )


def pack(
    ready: Sequence[Prepared],
    form: Format,
    *,
    felt: Mapping[str, Mapping[str, object]] | None = None,
    losses: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, bytes]:
    """Return the files of an export: a sidecar and a drive for each cue, then what belongs to the set.

    Parameters
    ----------
    ready
        The prepared cues; one with refusals is marked as forced.
    form
        The file format.
    felt
        For each cue, by its name, the report of perception on the delivered drive.
    losses
        For each cue, by its name, sentences on what is lost in delivery.

    Returns
    -------
    dict
        Bytes by file name; nothing is written.

    Raises
    ------
    FormatError
        Where two cues would get the same name, or one is unsafe.

    Examples
    --------
    >>> from thermicon.circuit import Device, Rig
    >>> from thermicon.circuit.delivery.prepare import prepare_set
    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icon, form = load_library("six-icons")["warming-step"], load_format("tcs2-protocol-ini")
    >>> list(pack(prepare_set([icon], Rig.load("tcs2"), Device.load("qst-tcs2"), form), form))
    ['warming-step.json', 'warming-step.protocol.ini']
    """
    check_names([cue.delivery.icon.name for cue in ready], form)
    drives = {}
    for cue in ready:
        name = cue.delivery.icon.name
        if unsafe := [str(refusal) for refusal in cue.refusals if not refusal.forcible]:
            raise FormatError(f"{name}: {unsafe[0]}")
        drive = form.file_name(cue.delivery)
        if drive.casefold() in form.set_files:
            raise FormatError(
                f"{name}: its drive {drive} would be taken for the set's own {drive.casefold()}; rename it"
            )
        try:
            drives[name] = drive, form.write(cue.delivery)
        except FormatError as problem:
            raise FormatError(f"{name}: {problem}") from None
    shared: dict[str, bytes] = {}
    if form.player is not None and ready:
        names = [cue.delivery.icon.name for cue in ready]
        played = [_played(cue, drives[name][0], form) for cue, name in zip(ready, names, strict=True)]
        shared = form.player(played, must_prevent([{"hardware_must_prevent": cue.verdict.demanded} for cue in ready]))
    files: dict[str, bytes] = {}
    for cue in ready:
        name = cue.delivery.icon.name
        drive, content = drives[name]
        over = [str(refusal) for refusal in cue.refusals]
        over += [str(Refusal("lossy", text)) for text in (losses or {}).get(name, ())]
        about = sidecar(
            cue.delivery, form, cue.deviation, cue.verdict.to_dict(), (felt or {}).get(name), over,
            demanded=cue.verdict.demanded, drive=content, set_files=shared, spread=cue.spread,
        )  # fmt: skip
        files[sidecar_name(name, form)] = sidecar_text(sealed(about))
        files[drive] = content
    return {**files, **shared}


def _played(cue: Prepared, file: str, form: Format) -> Played:
    """A drive with its verdict, for the player of a set."""
    known = cue.verdict.to_dict()
    recovery, shortest = (
        float(value) if isinstance(value := known.get(key), (int, float)) else None
        for key in ("recovery_s", "shortest_pause_s")
    )
    return Played(
        cue.delivery, file, sidecar_name(cue.delivery.icon.name, form), cue.verdict.colour, recovery, shortest
    )


def sidecar_name(name: str, form: Format) -> str:
    """Name of the sidecar of an icon.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> sidecar_name("double-dip", load_format("c-array"))
    'double_dip.json'
    """
    return f"{form.stem(name)}.json"

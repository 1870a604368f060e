"""``thermicon export``: icons as drive files or the reasons why they are refused."""

from __future__ import annotations

import stat
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.base.checks.arguments import advised
from thermicon.base.files.atomic import OutputError
from thermicon.base.words.number_text import number
from thermicon.circuit.delivery.export_folder import before_of, check_export_folder
from thermicon.perception.identification.exported import felt_in, others

from ..loading import DEFAULT_RIG
from ..messages import BAD_INPUT, OPTIONS, REFUSED, MissingArgument, note, progress_bar, usage
from ..report.blocks import grid
from ..report.gate_words import CAUTION, gate_words, spread_text, steps_of, warning_lines
from ..report.terminal import show
from .on_elements import elements_asked, together_line
from .options import IconName, NoFile, RigOptions, Tail, flag, opt, out, pick, read_set

if TYPE_CHECKING:
    from thermicon.circuit import Export, Layout, Rig
    from thermicon.circuit.delivery.prepare import Prepared
    from thermicon.icons import Icon, SpatialIcon

LONGEST_PAUSE_S = 600.0
"""As in `thermicon.circuit.safety.repeated`, repeated here to avoid its imports."""
REPLACED = "--force replaces the folder"
LARGEST = 2**30
"""Bytes; a larger file is no drive of any format's device, and is not read."""


def export_command(
    rig: RigOptions,
    file: NoFile = None,
    to: Annotated[str | None, opt("FORMAT", "File format; thermicon list formats has them.")] = None,
    folder: Annotated[
        Path | None,
        out("DIR", "Folder for drives and sidecars; nothing else should be in it.", "-o", "--output"),
    ] = None,
    device: Annotated[str | None, opt("DEVICE", "A shipped device or a .toml file.  [default: by format]")] = None,
    icon: IconName = None,
    tail: Tail = 0.0,
    pause: Annotated[
        float | None, opt("S", "Seconds between plays.  [default: the recovery time]", 0.0, LONGEST_PAUSE_S)
    ] = None,
    force: Annotated[
        bool, flag("--force", "Replace files, and export icons that are lossy or not reached; unsafe ones never.")
    ] = False,
    verify: Annotated[
        Path | None,
        out("DIR", "Write nothing; check that drives, sidecars, rig and program in DIR belong together.", "--verify"),
    ] = None,
) -> None:
    """Export drive files for hardware, each with a sidecar that describes it and its predicted effects.

    Every icon is simulated as the device delivers it. An icon that is unsafe, not reached, or loses too much on the
    device is refused with the reason, as is one that cannot be judged; then nothing is written, and the exit code is 3.

    --verify DIR checks an exported folder; the exit code is 1 if its files do not belong together.
    """
    if verify is not None:
        options: dict[str, object] = {"--to": to, "-o": folder, "--device": device, "--icon": icon, "--pause": pause}
        options |= {"--rig": rig.rig, "--set": rig.set, "--force": force, "--tail": tail}
        given = [*([f"the file {file}"] if file else []), *(name for name, value in options.items() if value)]
        if given:
            raise usage(f"takes no other argument; leave out {', '.join(given)}", "--verify")
        verify_folder(verify)
        return
    if file is None:
        raise MissingArgument("argument 'FILE'")
    if to is None:
        from thermicon.circuit.delivery.formats import format_names

        names = ", ".join(format_names())
        raise MissingArgument(f"option '--to': {names}; thermicon list formats says what takes each")
    if folder is None:
        raise MissingArgument("option '-o' / '--output'")
    from thermicon.circuit import export
    from thermicon.circuit.delivery.formats import load_format
    from thermicon.circuit.delivery.pack import check_names
    from thermicon.circuit.safety.playmap import UnjudgedError

    form, whole = load_format(to), read_set([file])
    check_export_folder(folder, force, REPLACED)
    chosen: list[Icon] | list[SpatialIcon]
    where: Rig | Layout
    felt, warned = None, list[str]()
    if whole.spatial:
        where, chosen = elements_asked(whole, icon, rig, file)
    else:
        where, chosen = rig.load(whole, file), pick(whole, icon)
        if rig.rig is None and where.name == DEFAULT_RIG:
            note(f"on the {where.name} rig; --rig names another")
        felt = partial(felt_in, rest=others(whole, chosen), warn=warned.append, tail_s=tail)
    check_names([one.name for one in chosen], form)
    try:
        with progress_bar("simulating", "judging all together") as progress:
            ready = export(
                chosen, where, device, form, tail_s=tail, pause_s=pause, force=force, felt=felt, step=progress
            )  # fmt: skip
    except UnjudgedError as problem:
        note(f"refused: {problem}", always=True)
        note("nothing was written", always=True)
        raise typer.Exit(REFUSED) from None
    for warning in warned:
        note(f"warning: {warning}")
    if refused(ready):
        for line in (*map(icon_line, ready.tracks), *(f"warning: {line}" for line in warning_lines(ready.tracks))):
            note(line)
        note(CAUTION)
        note("nothing was written", always=True)
        raise typer.Exit(REFUSED)
    report_icons(ready.tracks)
    if ready.whole is not None:
        note(together_line(ready.whole))
        for caution in ready.whole.cautions:
            note(f"warning: all elements together: {caution}")
    before = ready.write(folder, force, REPLACED)
    count = sum(name.endswith(".json") for name in ready.files)
    drives = "1 drive with its sidecar" if count == 1 else f"{count} drives with their sidecars"
    note(f"wrote {drives} into {folder}: {', '.join(_shown(list(ready.files)))}")
    if before is not None:
        note(f"the folder as it was before is {before}")
    alone = f"; {form.together.told}" if whole.spatial and form.together else ""
    note(f"to play: {form.how}{alone}")
    note(CAUTION)
    if not whole.spatial:
        note("Next: test it with people; thermicon list --copy study study.toml writes a study to start from")


def report_icons(ready: Sequence[Prepared]) -> None:
    """Report how every icon is played and how far that is from the design, and the gate's demands on the hardware.

    For drives played open loop, one more line gives the uncertainty due to an uncharacterised module.
    """
    for one in ready:
        note(icon_line(one))
    for line in warning_lines(ready):
        note(f"warning: {line}")
    for about, text in gate_words(ready):
        note(f"{about}: {text}")
    spreads = [(one.spread, one.delivery.name) for one in ready if one.spread is not None]
    if spreads:
        widest, name = max(spreads, key=lambda each: each[0].step_K[1] - each[0].step_K[0])
        note(f"{name}: {spread_text(widest)}")


def icon_line(one: Prepared) -> str:
    """One line on an icon's play and its deviation from the design."""
    delivery = one.delivery
    receptors = [each for each in one.deviation.places if "receptor" in each.place]
    largest = 1e3 * max(abs(each.largest_K) for each in receptors)
    rms = 1e3 * max(each.rms_K for each in receptors)
    return (
        f"{delivery.name}: {number(delivery.file_s, 2)} s {' '.join(steps_of(delivery))} on "
        f"{delivery.device.name}, receptors within {number(largest)} mK of the design (RMS {number(rms)} mK), "
        f"safety {one.verdict.colour} in {one.verdict.scenarios} scenarios"
    )


def refused(ready: Export, *, may_force: bool = True) -> bool:
    """Report why icons are refused or forced; True if nothing may be written."""
    found, force = ready.refused, ready.force
    final = not may_force or any(not refusal.forcible for _, refusal in found)
    for name, refusal in found:
        stops = final or not force
        told = advised(refusal.text, refusal.changes, OPTIONS)
        note(
            f"{'refused' if stops else 'forced'}: {name} {'is ' if refusal.kind != 'lossy' else ''}{told}", always=True
        )
    forcible = any(refusal.forcible for _, refusal in found)
    if forcible and not force and not final:
        note("--force exports it nevertheless, and the sidecar records that")
    return bool(ready.barred)


def _shown(names: Sequence[str], most: int = 6) -> list[str]:
    return [*names[:most], *([f"and {len(names) - most} more"] if len(names) > most else [])]


def verify_folder(folder: Path) -> None:
    """Check the files of an export folder and show which belong together; exit code 1 if some do not."""
    from thermicon.circuit.delivery.verify import verify

    files, others = _read(folder)
    found = verify(files)
    if found.claims:
        rows = [
            (_clean(claims.drive), _clean(sidecar), "yes" if found.belongs(sidecar) else "NO")
            for sidecar, claims in found.claims.items()
        ]
        show([grid(("drive", "sidecar", "belongs"), rows, names=("drive", "sidecar"))])
    for name, what in others:
        note(f"note: {_clean(name)} is a {what} and was not checked")
    for finding in found.findings:
        if finding.kind == "told":
            note(f"note: {_clean(str(finding))}")
    wrong = [finding for finding in found.findings if finding.kind == "wrong"]
    for finding in wrong:
        told = replace(finding, file=str(folder)) if finding.file == "." else finding
        note(f"wrong: {_clean(str(told))}", always=True)
    if wrong:
        note(f"{folder}: {len(wrong)} {'thing does' if len(wrong) == 1 else 'things do'} not belong together")
        raise typer.Exit(BAD_INPUT)
    count = len(found.claims)
    drives = "1 drive and its sidecar belong" if count == 1 else f"{count} drives and their sidecars belong"
    show([f"{folder}: {drives} together"])


def _read(folder: Path) -> tuple[dict[str, bytes], list[tuple[str, str]]]:
    """Plain files of a folder by name, and what else is in it."""
    if not folder.is_dir():
        if folder.exists():
            raise OutputError(f"cannot verify {folder}: it is a file; give the folder of an export")
        left = before_of(folder)
        more = f"; an export was interrupted, and the folder as it was is {left}" if left.exists() else ""
        raise OutputError(f"cannot verify {folder}: there is no such folder{more}")
    files, others = {}, []
    for path in sorted(folder.iterdir()):
        state = path.lstat()
        if not stat.S_ISREG(state.st_mode):
            others.append((path.name, "link" if path.is_symlink() else "folder" if path.is_dir() else "device"))
        elif state.st_size > LARGEST:
            others.append((path.name, f"file of {state.st_size / 2**30:.1f} GiB"))
        else:
            files[path.name] = path.read_bytes()
    return files, others


def _clean(text: str) -> str:
    """Text of files without what could move a terminal's cursor."""
    return "".join(each if each.isprintable() else "?" for each in text)

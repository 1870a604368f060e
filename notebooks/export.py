"""``thermicon export``: icons to drive files and sidecars, or the reasons why not."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.notebooks.cues import pick, read_set, warn_of_site
from thermicon.notebooks.door import REFUSED, note
from thermicon.notebooks.outputs import check_folder, write_together
from thermicon.notebooks.progress import progress_bar
from thermicon.notebooks.wording import number

if TYPE_CHECKING:
    from thermicon.circuit import Device, Realised, Rig
    from thermicon.circuit.delivery.export import Prepared, Refusal
    from thermicon.circuit.delivery.formats import Format
    from thermicon.icons import Icon
    from thermicon.perception import FeltChange

AFTER_S = 10.0
"""How long perception follows every icon after the longest has ended, as ``rank`` does."""

MOST_COMPARED = 60
"""In a larger set d′ is looked at only among the icons that are exported, and among more than these not at all."""

CAUTION = (
    "safety is a calculation, no medical or ethical clearance; hardware on skin needs a temperature cut-off that works "
    "without software"
)


def export_file(
    file: str, to: str, device: str | None, icon: str | None, rig: Rig, tail_s: float, force: bool, folder: Path
) -> None:
    """Write the icons of a file (or the one named) as drives for a device; leaves with 3 where that is refused."""
    from thermicon.circuit import Device
    from thermicon.circuit.delivery.export import check_names, pack
    from thermicon.circuit.delivery.formats import load_format

    form = load_format(to)
    played = Device.load(device or form.device)
    check_folder(folder)
    whole = read_set([file])
    chosen = pick(whole, icon)
    check_names([one.name for one in chosen], form)
    warn_of_site(file, whole, rig)
    ready = prepare_all(chosen, rig, played, form, tail_s)
    felt = compare_felt(ready, others(whole, chosen), rig, played, tail_s)
    losses = {change.icon: change.losses() for change in felt}
    tell(ready)
    if refused(ready, losses, force):
        note(CAUTION)
        note("nothing was written")
        raise typer.Exit(REFUSED)
    files = pack(ready, form, felt={change.icon: change.to_dict() for change in felt}, losses=losses)
    write_together(files, folder, replace=force)
    drives = "1 drive with its sidecar" if len(ready) == 1 else f"{len(ready)} drives with their sidecars"
    note(f"wrote {drives} into {folder}: {', '.join(_shown(list(files)))}")
    note(f"to play: {form.how}")
    note(CAUTION)


def others(whole: Iterable[Icon], chosen: Sequence[Icon]) -> list[Icon]:
    """The icons of a set that are not exported but compared with; none where the set is large."""
    names = {icon.name for icon in chosen}
    left = [icon for icon, _ in zip(whole, range(MOST_COMPARED + 1), strict=False) if icon.name not in names]
    return left if len(left) + len(chosen) <= MOST_COMPARED else []


def prepare_all(icons: Sequence[Icon], rig: Rig, device: Device, form: Format, tail_s: float) -> list[Prepared]:
    """Realise and judge every icon."""
    from thermicon.circuit.delivery.export import prepare

    ready = []
    with progress_bar("realising") as progress:
        for done, icon in enumerate(icons, 1):
            ready.append(prepare(icon, rig, device, form, tail_s=tail_s))
            if progress is not None:
                progress(done, len(icons))
    return ready


def compare_felt(
    ready: Sequence[Prepared],
    rest: Sequence[Icon],
    rig: Rig,
    device: Device,
    tail_s: float,
    warn: Callable[[str], None] = note,
) -> tuple[FeltChange, ...]:
    """What the device changes of the exported icons for a nominal person, beside the others of the set."""
    from thermicon.circuit.delivery.realise import realise, traces_until
    from thermicon.circuit.inputs import InputError
    from thermicon.perception import judge_delivered

    everyone = [one.realised for one in ready]
    for icon in rest:
        try:
            everyone.append(realise(icon, rig, device, tail_s=tail_s))
        except InputError as problem:
            warn(f"warning: {icon.name} cannot be played, so nothing is compared with it: {problem}")
    end = max(realised.end_s for realised in everyone) + AFTER_S
    groups = [everyone] if len(everyone) <= MOST_COMPARED else [[realised] for realised in everyone]
    if len(groups) > 1:
        warn(f"warning: {len(everyone)} icons are too many to compare with each other; d′ is left out")
    felt: list[FeltChange] = []
    for group in groups:
        traces = [traces_until(realised, end) for realised in group]
        names = [realised.icon.name for realised in group]
        felt += judge_delivered(names, [each for each, _ in traces], [each for _, each in traces])
    return tuple(felt[: len(ready)])


def tell(ready: Sequence[Prepared]) -> None:
    """Say of every icon how it is played and how far that is from the design, and what is to be known of it.

    Where the drives are played open loop, one more line says what a module that was not measured leaves open.
    """
    for one in ready:
        for line in told_of(one):
            note(line)
    spreads = [(one.spread, one.realised.icon.name) for one in ready if one.spread is not None]
    if spreads:
        widest, name = max(spreads, key=lambda each: each[0].step_K[1] - each[0].step_K[0])
        note(f"{name}: {widest}")


def told_of(one: Prepared) -> Iterator[str]:
    """How an icon is played and how far that is from the design, then a warning a line."""
    realised = one.realised
    receptors = [each for each in one.apart.places if "receptor" in each.place]
    largest = 1e3 * max(abs(each.largest_K) for each in receptors)
    rms = 1e3 * max(each.rms_K for each in receptors)
    yield (
        f"{realised.icon.name}: {number(realised.file_s, 2)} s {steps_of(realised)} on "
        f"{realised.device.name}, receptors within {number(largest)} mK of the design (rms {number(rms)} mK), "
        f"safety {one.verdict.colour} in {one.verdict.scenarios} scenarios"
    )
    for warning in (*realised.told, *one.verdict.cautions):
        yield f"warning: {realised.icon.name}: {warning}"


def refusals(ready: Sequence[Prepared], losses: Mapping[str, Sequence[str]]) -> list[tuple[str, Refusal]]:
    """Every reason against exporting, with the name of its icon; `losses` are what perception adds."""
    from thermicon.circuit.delivery.export import Refusal

    names = [one.realised.icon.name for one in ready]
    return [
        (name, refusal)
        for name, one in zip(names, ready, strict=True)
        for refusal in (*one.refusals, *(Refusal("lossy", text) for text in losses.get(name, ())))
    ]


def refused(ready: Sequence[Prepared], losses: Mapping[str, Sequence[str]], force: bool) -> bool:
    """Say why icons are refused, and whether any is."""
    found = refusals(ready, losses)
    for name, refusal in found:
        stops = not (force and refusal.forcible)
        note(f"{'refused' if stops else 'forced'}: {name} {'is ' if refusal.kind != 'lossy' else ''}{refusal}")
    final = any(not refusal.forcible for _, refusal in found)
    forcible = any(refusal.forcible for _, refusal in found)
    if forcible and not force and not final:
        note("--force exports it as it is, and the sidecar says so")
    return final or (forcible and not force)


def steps_of(realised: Realised) -> str:
    """How the updates of a drive are told: so many a second, or so many segments."""
    from thermicon.circuit import Setpoints

    played = realised.played
    if isinstance(played, Setpoints):
        return f"in {len(played.segments)} segments"
    return f"at {number(realised.rate_Hz, 1)} Hz"


def _shown(names: Sequence[str], most: int = 6) -> list[str]:
    return [*names[:most], *([f"and {len(names) - most} more"] if len(names) > most else [])]

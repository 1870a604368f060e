"""The perception of delivered beside designed icons for the sidecars of an export."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from thermicon.circuit.delivery.prepare import Prepared
    from thermicon.icons import Icon

    from .delivered import DeliveredChange, PerceivedChange

MOST_COMPARED = 60
"""In a larger set, d′ is computed only among the exported icons; beyond this number, not at all."""


def others(whole: Iterable[Icon], chosen: Sequence[Icon]) -> list[Icon]:
    """The other icons of the set, which are only compared with; none in a large set."""
    names = {icon.name for icon in chosen}
    left = [icon for icon, _ in zip(whole, range(MOST_COMPARED + 1), strict=False) if icon.name not in names]
    return left if len(left) + len(chosen) <= MOST_COMPARED else []


def felt_in(
    ready: Sequence[Prepared],
    rest: Sequence[Icon] = (),
    warn: Callable[[str], None] = lambda text: None,
    tail_s: float = 0.0,
) -> tuple[PerceivedChange, ...]:
    """The argument ``felt`` of `circuit.export`: detection by people, and d′ of a nominal person within a set.

    ``rest`` are the icons of the set that are not exported, ``warn`` takes what cannot be compared, ``tail_s`` is
    simulated after the last corner.
    """
    from thermicon.base.files.inputs import InputError
    from thermicon.circuit.delivery.deliver import traces_until
    from thermicon.circuit.delivery.ways import deliver
    from thermicon.circuit.solver.simulate import duration_s

    from .delivered import PEOPLE, detected_as_delivered, judge_delivered
    from .population import TAIL_S, run_end_s

    everyone = [one.delivery for one in ready]
    rig, device = everyone[0].rig, everyone[0].device
    for icon in rest:
        try:
            everyone.append(deliver(icon, rig, device, tail_s=tail_s))
        except InputError as problem:
            warn(f"{icon.name} cannot be played, so nothing is compared with it: {problem}")
    end = max(delivery.end_s for delivery in everyone) + TAIL_S
    run_end = run_end_s(duration_s(delivery.icon, rig) for delivery in everyone)
    groups = [everyone] if len(everyone) <= MOST_COMPARED else [[delivery] for delivery in everyone]
    if len(groups) > 1:
        warn(f"{len(everyone)} icons are too many to compare with each other; d′ is left out")
    felt: list[PerceivedChange] = []
    by_people: list[DeliveredChange | None] = []
    for group in groups:
        traces = [traces_until(delivery, end) for delivery in group]
        names = [delivery.icon.name for delivery in group]
        felt += judge_delivered(names, [each for each, _ in traces], [each for _, each in traces])
        for place, delivery in enumerate(group):
            if len(by_people) == len(ready):
                break
            try:
                by_people.append(detected_as_delivered(delivery, *traces[place], end_s=run_end))
            except InputError as problem:
                warn(f"{delivery.icon.name}: detection is that of the nominal person alone: {problem}")
                by_people.append(None)
    return tuple(
        change if detection is None else replace(change, detection=detection, people=PEOPLE)
        for change, detection in zip(felt, by_people, strict=False)
    )

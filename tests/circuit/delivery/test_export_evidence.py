"""Evidence that nothing unsafe is written: adversarial drives replayed by an independent circuit.

All are slow: sixteen are looked at one by one, and 10,000 judged in parts of 100, two at a time, or as many as
THERMICON_EVIDENCE says.
"""

import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.delivery.adversarial import some_case
from tests.circuit.delivery.evidence import PER_PART, Told, run_part
from tests.circuit.delivery.exported_files import read_file, sidecar_in
from tests.circuit.delivery.one_drive import worst_case
from tests.circuit.delivery.replay import AFTER, Held, Player, Worst, judged
from tests.circuit.delivery.spice_replay import by_ngspice
from thermicon.circuit import Gate
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import pack

DRIVES = int(os.environ.get("THERMICON_EVIDENCE", "10000"))
BY_NGSPICE, WITHIN_K = 300, 5e-3
WIDER_K = 4.0


def too_kind(delivery: DeliveredDrive) -> Gate:
    """A gate whose limits of temperature are wider by 4 K, and whose other limits are twice what they are."""
    limits = delivery.rig.limits
    rules = tuple(
        replace(rule, limit=rule.limit + (WIDER_K if rule.upper else -WIDER_K) if rule.unit == "°C" else 2 * rule.limit)
        for rule in limits.rules
    )
    return worst_case(replace(delivery, rig=replace(delivery.rig, limits=replace(limits, rules=rules))), 20.0)


@pytest.mark.slow
@pytest.mark.parametrize(("part", "count", "red"), [(1003, 4, 1), (1000, 12, 2)])
def test_a_few_drives_are_safe_as_written(part: int, count: int, red: int) -> None:
    told = run_part(part, count, look=1)
    assert told.unsafe == []
    assert told.counts["written"] >= 2
    assert told.counts["red"] >= red, "drives that must not be written are among them"
    assert told.refused_margins
    assert min(told.refused_margins) < 0, "the replay finds what the gate refuses to be unsafe"


@pytest.mark.slow
def test_what_a_weakened_gate_writes_is_found_unsafe() -> None:
    told = run_part(1001, 60, gate=too_kind)
    assert len(told.unsafe) >= 3, told.counts


@pytest.mark.slow
def test_nothing_unsafe_is_written() -> None:
    count = min(DRIVES, PER_PART)
    told = Told()
    with ProcessPoolExecutor(2) as pool:
        for part in pool.map(partial(run_part, count=count), range(max(1, DRIVES // count))):
            told.add(part)
    margins = np.array(told.refused_margins)
    print(dict(told.counts), f"{np.mean(margins > 0.1):.1%} of refused drives are safe by 0.1 K or a hundredth")
    assert told.unsafe == []
    assert told.counts["written"] > 0.25 * told.counts["judged"]
    assert np.mean(margins > 0.1) < 0.5, "a gate that refuses everything is safe and of no use"
    if DRIVES >= 1000:
        for reason in ("skin surface", "display", "rate of skin temperature", "thermal dose", "hot plate"):
            assert told.counts[f"refused: {reason}"], reason
        assert told.counts["refused for repetition"]


@pytest.mark.slow
def test_ngspice_agrees_on_what_is_written(tool: Callable[[str], str], tmp_path: Path) -> None:
    far, done, number = 0.0, 0, 0
    while done < min(BY_NGSPICE, DRIVES):
        rng = np.random.default_rng([22, number])
        case, number = some_case(rng, number, tmp_path), number + 1
        if case is None or len(case.ready) > 1 or case.ready[0].verdict.colour == "red":
            continue
        form = load_format(case.form)
        try:
            files = pack(case.ready, form)
        except FormatError:
            continue
        held = read_file(files, "a")
        if not isinstance(held, Held) or held.end_s > 10 or (held.square_A2 != held.mean_A**2).any():
            continue
        player, worst = Player(sidecar_in(files, "a")["rig"]["document"], rng, 0), Worst()
        judged(player, held, [20.0], [], worst)
        nearest = max((far, rule) for rule, far in worst.beyond.items() if rule in worst.world)[1]
        rows, steps, ended = player.play(held, player.rest(held))
        after = player.follow(ended, (0.0, 0.0), (*AFTER[:1], (0.1, 40)))
        ours = np.concatenate([rows, after[1:]])[:, :, :, 0]
        times = np.concatenate([[0.0], np.cumsum([*steps, *[0.01] * 100, *[0.1] * 40])])
        for world in {0, worst.world[nearest]}:
            at, theirs = by_ngspice(tool("ngspice"), player.circuit, world, held, tmp_path)
            calm = np.array([np.interp(times + 2e-6, at, column) for column in theirs.T]).T
            apart = float(np.abs(calm - ours[:, world])[:-1].max())
            far = max(far, apart)
            assert apart < WITHIN_K, (repr(case), world, apart)
        done += 1
    print(f"{done} files in two worlds each, temperatures within {far * 1e3:.2f} mK")

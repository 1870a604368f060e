"""What a log of live play tells."""

import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.live.conftest import EVIDENCE, SEED
from tests.circuit.live.thermostat import demands_of, drives_of
from thermicon.circuit import Export, Rig, fit, play_live
from thermicon.circuit.fitting.log import read_log
from thermicon.circuit.live.controller import SimulatedController, settings_of
from thermicon.circuit.live.live_player import LivePlayer, play_in_order
from thermicon.circuit.live.play_live import SimulatedTime, live_numbers
from thermicon.circuit.live.play_log import PlayLog
from thermicon.circuit.play.logged_line import LineRow
from thermicon.circuit.play.watch import Stopped

CONTACT = "contact.resistance_m2K_per_W"
Ready = Callable[[str, float], Export]


def logged(number: int, folder: Path, ready: Ready) -> tuple[float, float, float, float]:
    """Truth, fitted value and interval of the contact, by one log of a device whose contact is another."""
    rng, found = np.random.default_rng([SEED, 3, number]), ready("readme", 100.0)
    truth = found.rig.contact.resistance_m2K_per_W * float(np.exp(rng.uniform(np.log(0.6), np.log(1.5))))
    drive, now = list(drives_of(found).values())[int(rng.integers(3))], SimulatedTime()
    settings = settings_of(demands_of(found), float(abs(drive.trace.current_A).max()))
    line = SimulatedController(found.rig.with_(**{CONTACT: truth}), settings, now, seed=int(rng.integers(1e9)))
    player = LivePlayer(line, live_numbers(demands_of(found), True), PlayLog(folder), now, now.sleep)
    assert not play_in_order(player, [drive], 0.0)
    (play,) = player.log.finish({})
    log = folder / play.files[0]
    if number % 2:  # a board has no voltmeter
        head, *rows = log.read_text().splitlines()
        log.write_text("\n".join([head, *(row[: row.rindex(",") + 1] for row in rows)]) + "\n")
    (contact,) = [each for each in fit([read_log(log)], found.rig).parameters if each.key == CONTACT]
    assert contact.identified
    return truth, contact.value, contact.low, contact.high


def test_a_log_tells_the_contact(tmp_path: Path, ready: Ready) -> None:
    truth, value, low, high = logged(1, tmp_path, ready)
    assert low < truth < high
    assert value == pytest.approx(truth, rel=0.15)


@pytest.mark.slow
def test_intervals_of_logs_hold_the_truth(tmp_path: Path, ready: Ready) -> None:
    rows = []
    for number in range(min(20, EVIDENCE)):
        (folder := tmp_path / str(number)).mkdir()
        rows.append(logged(number, folder, ready))
    truth, value, low, high = np.array(rows).T
    print(f"{np.sum((low <= truth) & (truth <= high))} of {len(rows)}; half widths {(high - low) / 2 / value}")
    assert np.sum((low <= truth) & (truth <= high)) >= 0.85 * len(rows)
    assert np.median((high - low) / 2.0 / value) <= 0.25


def test_files_of_a_play(tmp_path: Path) -> None:
    folder = tmp_path / "monday"
    result = play_live("six-icons", "thenar", order=["double-dip", "double-dip"], folder=folder)
    files = [name for play in result.plays for name in play.files]
    assert sorted(path.name for path in folder.iterdir()) == sorted(["rig.toml", *files])
    rig = Rig.load(folder / "rig.toml")
    assert [(probe.name, probe.place, probe.lag_s) for probe in rig.probes] == [
        ("loop", "display", 0.1), ("second", "display", 0.1),
    ]  # fmt: skip
    assert "simulated" in rig.notes[-1]
    first, again = (read_log(folder / play.files[0]) for play in result.plays)
    off = first.time_s < first.time_s[0] + 15.0
    assert not first.column("current_A")[off].any(), "a log begins without power"
    rows = [line.split(",") for line in (folder / files[0]).read_text().splitlines()]
    (began,) = [row for row in rows if row[0] == "0.0000"]
    events = [(float(row[0]), row[3]) for row in rows[1:] if row[3] and float(row[0]) > 0.0]
    assert events[0] == (0.01, "ramp start")
    assert float(began[rows[0].index("set_point_C")]) == pytest.approx(32.0, abs=0.1)
    about = json.loads((folder / files[2]).read_text())
    assert about["device"] == "a simulated controller"
    assert about["proofs"]["fell_K"] > about["status"]["polarity_check"]["display_change_at_least_K"]
    assert 0.0 < about["rms_K"] < 0.06
    assert again.time_s[0] == pytest.approx(-10.0, abs=0.2), "the second log begins where the first one ends"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no device that is always full")
def test_a_full_disk_stops_the_play_and_what_was_measured_is_kept(tmp_path: Path, ready: Ready) -> None:
    log, row = PlayLog(tmp_path), LineRow(0.0, 32.0, 32.0, 32.0, 0.1, None)
    log.open(next(iter(drives_of(ready("readme", 10.0)).values())))
    log.close()
    with Path("/dev/full").open("w", buffering=1, encoding="utf-8") as full, suppress(OSError):
        log._file = full
        with pytest.raises(Stopped, match=r"the log cannot be written \(No space left on device\); make room, or give"):
            log.take([row], 0.0)
    log.take([row._replace(time_s=0.01)], 0.01)
    (play,) = log.finish({})
    assert play.columns["time_s"].tolist() == [0.0, 0.01]
    assert len((tmp_path / play.files[0]).read_text().splitlines()) == 3


def test_a_log_that_cannot_be_finished_keeps_what_was_played_and_says_why(tmp_path: Path, ready: Ready) -> None:
    log, row = PlayLog(tmp_path), LineRow(0.0, 32.0, 32.0, 32.0, 0.1, None)
    log.open(next(iter(drives_of(ready("readme", 10.0)).values())))
    log.take([row], 0.0)
    (tmp_path / "arrived.predicted.csv").mkdir()
    (play,) = log.finish({})
    assert play.files == ()
    assert play.columns["time_s"].tolist() == [0.0]
    assert len((tmp_path / "arrived.log.csv").read_text().splitlines()) == 2
    assert "arrived.log.csv has no prediction beside it" in log.unfinished

"""What a device plays beside the design."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.circuit.live.thermostat import Thermostat, played
from thermicon.circuit import play_live
from thermicon.circuit.live.ready import ReadySet
from thermicon.icons import load_library

FROM_REST_K, FIRST_K = 0.060, 0.120


@pytest.mark.parametrize("rate_Hz", [10.0, 100.0])
@pytest.mark.parametrize("name", ["readme", "six-icons"])
def test_skin_follows_the_design(name: str, rate_Hz: float, ready: Callable[[str, float], ReadySet]) -> None:
    """On the independent circuit, as the rig is given."""
    found = ready(name, rate_Hz)
    device = Thermostat(found.rig, found.demands, np.random.default_rng(1), world=0)
    drives = list(found.drives.values())
    _, plays, why = played(device, found, [drives[0], *drives], pause_s=60.0)
    assert not why
    times, skin_C = np.array(device.skin_C).T
    end_s = times[-1]
    for place, (drive, play) in enumerate(zip([drives[0], *drives], plays, strict=True)):
        assert play.ended
        begun_s = end_s - sum(later.columns["time_s"][-1] - later.columns["time_s"][0] for later in plays[place + 1 :])
        begun_s -= play.columns["time_s"][-1] + 0.01 * len(plays[place + 1 :])
        rows_s = np.arange(0.0, drive.trace.time_s[-1], 0.01)
        designed_C = np.interp(rows_s, drive.designed.time_s, drive.designed.skin_C)
        rms_K = np.sqrt(np.mean((np.interp(begun_s + rows_s, times, skin_C) - designed_C) ** 2))
        print(
            f"{name} {rate_Hz:g} Hz {place} {drive.name}: skin {1e3 * rms_K:.0f} mK, display {1e3 * play.rms_K:.0f} mK"
        )
        assert rms_K < (FROM_REST_K if place else FIRST_K)


def test_the_simulated_controller_plays_what_is_predicted() -> None:
    result = play_live(load_library("six-icons"), "thenar", order=["double-dip", "warming-step", "double-dip"])
    assert not result.stopped
    assert [play.name for play in result.plays] == ["double-dip", "warming-step", "double-dip"]
    assert all(play.ended and play.rms_K < FROM_REST_K for play in result.plays)

import math

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.observer.observer import Channel
from thermicon.perception.sensation.sensation import area_factor, sensation


@pytest.mark.parametrize(("channel", "unit"), [("cold", 0.08), ("warm", 0.15)])
def test_sensation_is_a_power_then_logarithmic(observer: Observer, channel: Channel, unit: float) -> None:
    u = np.array([0.0, 0.01, 0.02, 1.0, 100.0, 200.0])
    psi = sensation(unit * u, channel, observer)
    assert psi[0] == 0.0
    assert psi[3] == pytest.approx(1.0, rel=1e-12)
    assert psi[2] / psi[1] == pytest.approx(4.0, rel=1e-3)
    assert psi[5] - psi[4] == pytest.approx(2 * 12.0 * math.log(2.0), rel=1e-2)
    assert psi == pytest.approx(observer.transducer.psi(u), rel=1e-12)


def test_area_and_person_scale_the_drive(observer: Observer) -> None:
    drive = np.array([0.0, 0.16])
    quarter = sensation(drive, "cold", observer, area_m2=9e-4 / 4)
    smaller = area_factor(9.0 / 4, 9.0, 0.7)
    assert quarter[1] == pytest.approx(sensation(drive * smaller, "cold", observer)[1], rel=1e-12)
    rows = sensation(np.stack([drive, drive]), "cold", observer, threshold=[1.0, 2.0])
    assert rows[1, 1] == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(ValueError, match=r"area of contact must be above 0 m², not 0 m²"):
        sensation(drive, "cold", observer, area_m2=0.0)

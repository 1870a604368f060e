"""How well a drive identifies a rig: the criterion by which the shipped calibration drive was chosen.

D-optimality: the determinant of the covariance of the parameters, here as the geometric mean of their standard
deviations, so that it reads as a share. Rigs of different skin and contact are averaged, since a drive is chosen before
the rig is known.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.fitting.forward import runs_of
from thermicon.circuit.fitting.identify import NOISE_K, NOISE_V, with_channels
from thermicon.circuit.fitting.keys import free_keys
from thermicon.circuit.fitting.laboratory import COLUMNS, synthetic_log
from thermicon.circuit.fitting.problem import Problem
from thermicon.circuit.fitting.solve import covariance_of
from thermicon.icons import Icon, parse

IDENTIFIED = (
    "contact.resistance_m2K_per_W",
    "module.seebeck_V_per_K",
    "module.resistance_ohm",
    "module.thermal_resistance_K_per_W",
    "module.cold_plate_J_per_K",
)
"""Keys that the calibration drive was chosen for, all free at once."""

RIGS = ("thenar", "forearm", "shani2021")
RATE_HZ = 10.0
"""Rows per second of the logs that are compared."""

CANDIDATES = {
    "one step": "cool by 8 °C at 3 °C/s\n hold for 30 s\n return at 3 °C/s\n rest for 22 s",
    "slow ramps": "cool by 9 °C at 0.6 °C/s\n warm by 15 °C at 0.6 °C/s\n return at 1 °C/s\n rest for 12 s",
    "square wave": "square by 6 °C every 14 s for 56 s",
    "sine": "sine by 6 °C every 14 s for 56 s",
}
"""Drives of one minute that people would try first, after a rest of 2 s."""


def candidate(name: str) -> Icon:
    """Return one of the candidates as an icon.

    >>> candidate("sine").name
    'candidate'
    """
    body = CANDIDATES[name]
    return parse(
        f"cue 1\nset trial {{\n site thenar\n control display\n baseline 32 °C\n}}\n"
        f"icon candidate {{\n rest for 2 s\n {body}\n}}\n"
    )["candidate"]


def mean_deviation(icon: Icon, rigs: Sequence[str | Rig] = RIGS, keys: Sequence[str] = IDENTIFIED) -> float:
    """Return the geometric mean of the parameters' relative standard deviations (D-optimality) from a log of a cue.

    Parameters
    ----------
    icon
        The cue.
    rigs
        Rigs or their names, averaged geometrically.
    keys
        Scales that are fitted at once.

    Returns
    -------
    float
        A share: 0.01 is 1 %.
    """
    logs = []
    for name in rigs:
        rig = name if isinstance(name, Rig) else Rig.load(name)
        free = free_keys(keys, rig)
        log = synthetic_log(
            rig, seed=0, icon=icon, columns=["display_C"], noise_K=0.0, offset_sd_K=0.0, rate_Hz=RATE_HZ
        )
        problem = Problem.of(rig, free, runs_of([log], rig, False), fixed_skin=True)
        problem = with_channels(problem, problem.first, COLUMNS, only=True)
        sigma = [NOISE_K if channel.temperature else NOISE_V for _, _, channel in problem.channels()]
        covariance = covariance_of(problem, problem.jacobian(problem.first, sigma), [1.0] * len(sigma))
        sign, logarithm = np.linalg.slogdet(covariance[: len(free), : len(free)])
        assert sign > 0
        logs.append(logarithm / (2 * len(free)))
    return float(np.exp(np.mean(logs)))

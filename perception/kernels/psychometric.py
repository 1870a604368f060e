"""Compiled reading of psychometric functions: sizes at which each person reports given shares, guesses taken out."""

from __future__ import annotations

from typing import Any

from thermicon.circuit.compiled import kernel

GUESSED = 0.999
"""Share of the reports at the smallest size that counts as guessed; less than all, so that none is divided by 0."""
RISE = 1e-9
"""Added from size to size, so that no share stands at two sizes."""


def _psychometric(reported: Any, log_sizes: Any, shares: Any, logs: Any) -> None:
    """Logs (people, shares) of the sizes at which corrected reports (people, sizes) reach these shares, linear between.

    A share that is not reached by the largest size lies beyond it, as far as the rest is missing.
    """
    people, sizes = reported.shape
    for person in range(people):
        guesses = GUESSED * reported[person, 0]
        for k in range(shares.size):
            share = shares[k]
            below, reached, place = 0.0, False, log_sizes[0]
            highest = -1.0
            for j in range(sizes):
                highest = max(highest, (reported[person, j] - guesses) / (1.0 - guesses))
                corrected = highest + RISE * j
                if not reached and corrected >= share:
                    reached = True
                    if j > 0:
                        part = (share - below) / (corrected - below)
                        place = log_sizes[j - 1] + part * (log_sizes[j] - log_sizes[j - 1])
                below = corrected
            logs[person, k] = place if reached else log_sizes[sizes - 1] + share - below


_compile: Any = kernel(nogil=True)
psychometric: Any = _compile(_psychometric)

"""Tables in the forms of instruments and programs, made from one line each of `instruments.txt`."""

import re
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

TIME = np.arange(60) / 10
CURRENT = np.round(0.1 + 0.4 * np.clip(TIME - 1, 0, 2) / 2, 4)
DISPLAY = np.round(32 - 4 * np.clip(TIME - 1, 0, 3) / 3, 1)
BEGIN = datetime(2026, 3, 2, 23, 59, 58)
EPOCH_S, DATENUM = 1772495998.0, 740044.0


class Form(NamedTuple):
    """A form of table: its class, its name, where the form is described, seconds between rows, and its text."""

    group: str
    name: str
    source: str
    step_s: float
    text: str


def form(line: str) -> Form:
    """The form on a line of `instruments.txt`."""
    group, name, source, step, above, row, below = (part.replace("⏎", "\n").replace("→", "\t") for part in
                                                    re.split(" ¦ ?", line.rstrip("\n"), maxsplit=6))  # fmt: skip
    head = [above] if above else []
    again = "\n" + "\n".join(line for line in above.split("\n")[-2:] if line)
    rows = [row.format(**fields(k, float(step) / 0.1, again)) for k in range(len(TIME))]
    return Form(group, name, source, float(step), "\n".join([*head, *rows, *([below] if below else [])]) + "\n")


def fields(k: int, slower: float, again: str) -> dict[str, Any]:
    """What a row may hold: t (s), c (°C), K, a (A), ma, d, e, dn (clocks), ending in c with a decimal comma."""
    t, c, a = float(TIME[k] * slower), float(DISPLAY[k]), float(CURRENT[k])
    at = BEGIN + timedelta(milliseconds=round(1000 * t))
    seconds = (at - BEGIN).total_seconds()
    return {
        "k": k + 1, "t": t, "c": c, "K": c + 273.15, "a": a, "ma": 1000 * a, "d": at, "m": at.microsecond // 1000,
        "ds": at.microsecond // 100_000, "e": EPOCH_S + t, "ems": 1000 * (EPOCH_S + t), "ens": 1e9 * (EPOCH_S + t),
        "ms": 1000 * t + 5000, "ch": f"{1000 * t + 5000:,.0f}".replace(",", "'"), "sas": f"{at:%d%b%Y}".upper(),
        "tc": f"{t:.1f}".replace(".", ","), "cc": f"{c:.2f}".replace(".", ","),
        "dn": DATENUM + (BEGIN - BEGIN.replace(hour=0, minute=0, second=0)).total_seconds() / 86400 + seconds / 86400,
        "again": again if k == 30 else "",
    }  # fmt: skip


FORMS = [form(line) for line in Path(__file__).with_name("instruments.txt").read_text("utf-8").splitlines()
         if not line.startswith("#")]  # fmt: skip


def right(time_s: Any, level_C: Any, made: Form) -> bool:
    """Whether times and temperatures are those that were written."""
    time = (np.asarray(time_s) - time_s[0]) * 0.1 / made.step_s
    error = np.abs(np.interp(time, TIME, DISPLAY) - level_C).max()
    return bool(error < 0.02 and abs(time[-1] - TIME[-1]) < 2e-2 and 57 <= len(time) <= 61)


Read = Callable[[Path], Any]

"""Tables in the forms of instruments and programs, each made from one line of a text file."""

import json
import re
from datetime import timedelta
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tests.notebooks.files.test_forms import BEGIN, CURRENT, DISPLAY, TIME

EPOCH_S, DAY, WIDE = 1772495998.0, 46083.99997685185, str.maketrans("0123456789.", "０１２３４５６７８９．")


class Form(NamedTuple):
    """A table: its class, its name, the source of its form, the options of its command, what is said, and the text."""

    group: str
    name: str
    source: str
    options: dict[str, Any]
    said: str
    step_s: float
    text: str


def _filled(step: str, above: str, row: str, below: str) -> tuple[float, str]:
    above, row, below = (part.replace("⏎", "\n").replace("→", "\t") for part in (above, row, below))
    again = "\n" + "\n".join(line for line in above.split("\n")[-2:] if line)
    rows = [row.format(**_fields(k, float(step) / 0.1, again)) for k in range(len(TIME))]
    return float(step), "\n".join([*([above] if above else []), *rows, *([below] if below else [])]) + "\n"


def _fields(k: int, slower: float, again: str) -> dict[str, Any]:
    """What a row may hold: t (s), c (°C), K, a (A), ma, d, e, dn (clocks), ending in c with a decimal comma."""
    t, c, a = float(TIME[k] * slower), float(DISPLAY[k]), float(CURRENT[k])
    at = BEGIN + timedelta(milliseconds=round(1000 * t))
    ohm = 1e4 * np.exp(3950 * (1 / (c + 273.15) - 1 / 298.15))
    return {
        "k": k + 1, "k0": k, "t": t, "c": c, "K": c + 273.15, "a": a, "ma": 1000 * a, "d": at, "doy": f"{at:%j}",
        "m": at.microsecond // 1000, "ds": at.microsecond // 100_000, "e": EPOCH_S + t, "ems": 1000 * (EPOCH_S + t),
        "ens": 1e9 * (EPOCH_S + t), "ms": 1000 * t + 5000, "ch": f"{1000 * t + 5000:,.0f}".replace(",", "'"),
        "sas": f"{at:%d%b%Y}".upper(), "tc": f"{t:.1f}".replace(".", ","), "cc": f"{c:.2f}".replace(".", ","),
        "day": DAY + t / 86400, "dn": DAY + 693_960 + t / 86400, "unpadded": f"{int(t)}.{round(1000 * (t % 1))}",
        "wide_t": f"{t:.1f}".translate(WIDE), "wide_c": f"{c:.3f}".translate(WIDE), "count": 1023 * ohm / (ohm + 1e4),
        "again": again if k == 30 else "",
    }  # fmt: skip


def _lines(name: str, parts: int) -> list[list[str]]:
    lines = Path(__file__).with_name(name).read_text("utf-8").splitlines()
    return [re.split(" ¦ ?", line, maxsplit=parts) for line in lines if not line.startswith("#")]


FORMS = [Form(group, name, source, {}, "", *_filled(*made))
         for group, name, source, *made in _lines("instruments.txt", 6)]  # fmt: skip
MET = [Form("met", name, "", json.loads(options.replace("\\", "\\\\")), said, *_filled(*made))
       for name, options, said, *made in _lines("met_tables.txt", 6)]  # fmt: skip


def right(time_s: Any, level_C: Any, made: Form) -> bool:
    """Whether times and temperatures are those that were written, to the digits that the form has."""
    time = (np.asarray(time_s) - time_s[0]) * 0.1 / made.step_s
    error = np.abs(np.interp(time, TIME, DISPLAY) - level_C).max()
    return bool(error < 0.06 and abs(time[-1] - TIME[-1]) < 2e-2 and 57 <= len(time) <= 61)

"""The command line of a study."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def pressed_key(text: str) -> tuple[float, str]:
    """A key at a simulated time, S:KEY."""
    at, _, key = text.partition(":")
    try:
        at_s = float(at)
    except ValueError:
        at_s = -1.0
    if not (0.0 <= at_s < float("inf") and key):
        raise argparse.ArgumentTypeError(f"{text} is not S:KEY, a time in s and a key, such as 60:escape")
    return at_s, key


def share(text: str) -> float:
    """A number from 0 to 1."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text} is not a share; give 0 to 1, such as 0.8")
    return value


def threshold_K(text: str) -> float:
    """A temperature change above 0 K."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a threshold; give K above 0, such as 0.4")
    return value


def options(study: Mapping[str, Any]) -> argparse.Namespace:
    """What the command line chooses for a study."""
    keys = study["keys"]
    parser = argparse.ArgumentParser(description=study["title"] or f"the study {study['name']}")
    parser.add_argument("--participant", metavar="LABEL", help="whose trials to run")
    parser.add_argument("--output", type=Path, help="folder for answers and events  [data, or simulated]")
    parser.add_argument("--resume", action="store_true", help="go on after the last trial")
    parser.add_argument("--collect", action="store_true", help="join the answers of all participants and end")
    parser.add_argument("--bench", type=Path, metavar="FILE.py", help="your functions measured_C(), send(), off()")
    parser.add_argument("--channel", help="analogue output, such as Dev1/ao0")
    parser.add_argument("--device", choices=("board", "simulated"), help="plays by itself, fed by this script")
    parser.add_argument("--port", help="serial line of the thermode or the board, such as COM3")
    parser.add_argument(
        "--stated", action="append", default=[], metavar="TEXT",
        help="who provides what the board does not hold: 'DEMAND: WHAT, WHO'",
    )  # fmt: skip
    parser.add_argument("--marker", default=study["marker"], help="none, serial:PORT, parallel:ADDRESS or ni:LINES")
    parser.add_argument("--start-key", default=keys["start"])
    parser.add_argument("--stop-key", default=keys["stop"])
    parser.add_argument("--abort-key", default=keys["abort"])
    parser.add_argument("--window", action="store_true", help="a window in place of the whole screen")
    parser.add_argument("--simulate", action="store_true", help="no hardware: a virtual person and a clock that jumps")
    parser.add_argument("--seed", type=int, default=0, help="seed of the virtual person  [0]")
    parser.add_argument(
        "--correct", type=share, default=0.8, metavar="SHARE",
        help="share that the virtual person names rightly, 0 to 1  [0.8]",
    )  # fmt: skip
    parser.add_argument("--threshold", type=threshold_K, metavar="K", help="threshold of the virtual person in K")
    parser.add_argument(
        "--press", type=pressed_key, action="append", default=[], metavar="S:KEY",
        help="a key at a simulated time in s, such as 60:escape",
    )  # fmt: skip
    parser.add_argument("--verbose", action="store_true", help="print what the screen would show")
    return parser.parse_args()

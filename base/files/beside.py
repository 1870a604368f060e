"""The file of the same folder whose name is most like that of a missing file."""

import os
import re
from itertools import islice
from pathlib import Path

from ..words.near_words import nearest_words, proposals

MOST_LOOKED_AT = 1000
"""Files of a folder among which a similar name is looked for."""


def beside(path: str | Path, ending: str = "") -> str:
    """A file of the same folder with a similar name and ending, which may have been meant; empty without one.

    A path of Windows is proposed as the Linux that runs in it has it.
    """
    if os.name != "nt" and re.match(r"[A-Za-z]:[\\/]", str(path)):
        return f"/mnt/{str(path)[0].lower()}{str(path)[2:]}".replace("\\", "/")
    wanted = Path(path)
    try:
        there = [each for each in islice(wanted.parent.iterdir(), MOST_LOOKED_AT) if not each.name.startswith(".")]
    except (OSError, ValueError):
        return ""
    suffix = wanted.suffix or ending
    longer = f"{wanted.name}." if wanted.suffix else f"{wanted.name}{ending}."
    alike = [
        each
        for each in there
        if each.name.startswith(longer) or not suffix or nearest_words(suffix, [each.suffix], cutoff=0.7)
    ]
    names = {each.name if wanted.suffix else each.stem: each.name for each in alike}
    close = proposals(wanted.name, names, cutoff=0.7)
    return str(wanted.with_name(names[close[0]])) if close else ""

"""The inputs of ``thermicon compare``: of which kind they are, and which options apply to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..messages import usage

TABLES = (".csv", ".parquet")
NAMES = {"rig": "a rig", "icon": "an icon", "set": "an icon set", "table": "a trace or log"}
HOW = "a rig is a name or a .toml file, an icon FILE:ICON, a set a .cue file or a name, a trace or log .csv or .parquet"

RIGS = "belongs to two sets"
CLOCKS = "belongs to a trace and a log, which have clocks of their own"


@dataclass(frozen=True, slots=True)
class Request:
    """Options of ``compare``: the file with icons for two rigs, one icon only, the rig with its changes, alignment."""

    file: str | None = None
    icon: str | None = None
    rig: str | None = None
    changes: tuple[str, ...] = ()
    align: bool = False
    rigs: tuple[str, ...] = ()


def kind_of(text: str, option: str) -> str:
    """Return what an argument names, a rig, icon, set or table; a usage error if that is not clear.

    >>> [kind_of(text, "A") for text in ("thenar", "my.toml", "six-icons:double-dip", "my.cue", "log.csv")]
    ['rig', 'rig', 'icon', 'set', 'table']
    """
    from thermicon.circuit.rig.rig import rig_names
    from thermicon.icons.files.shipped import library_names

    suffix = Path(text).suffix.lower()
    file, colon, _ = text.rpartition(":")
    matches = {
        "rig": suffix == ".toml" or text in rig_names(),
        "set": suffix == ".cue" or text in library_names(),
        "table": suffix in TABLES,
        "icon": bool(colon) and (Path(file).suffix.lower() == ".cue" or file in library_names()),
    }
    kinds = [kind for kind, is_match in matches.items() if is_match]
    if len(kinds) == 1:
        return kinds[0]
    if kinds:
        both = " and ".join(NAMES[kind] for kind in kinds)
        raise usage(f"{text} is the name of {both}; give the one you mean as a file", option)
    if Path(text).exists():
        raise usage(f"{text}: its name does not show what it is; {HOW}", option)
    from thermicon.icons.near_words import did_you_mean

    raise usage(f"{text} cannot be compared; {did_you_mean(text, (*rig_names(), *library_names()))} ({HOW})", option)


def kind_of_both(first: str, second: str) -> str:
    """Return the kind that both are; a usage error where they differ."""
    kinds = kind_of(first, "A"), kind_of(second, "B")
    if kinds[0] == kinds[1]:
        return kinds[0]
    raise usage(
        f"{first} is {NAMES[kinds[0]]} and {second} is {NAMES[kinds[1]]}; both must be of the same kind"
        f"{_cure(set(kinds))}",
        "B",
    )


def _cure(kinds: set[str]) -> str:
    if kinds == {"icon", "set"}:
        return ": write the one icon of the set as FILE:ICON"
    if "table" in kinds:
        return ": write a trace first with thermicon simulate FILE --icon NAME -o trace.csv"
    return f" ({HOW})"


def check_request(kind: str, request: Request) -> None:
    """Fail with a usage error for an option that does not apply to this kind."""
    given = {
        "--file": request.file is not None,
        "--icon": request.icon is not None,
        "--rig": request.rig is not None,
        "--set": bool(request.changes),
        "--rigs": bool(request.rigs),
        "--align": request.align,
    }
    misplaced = {
        "rig": {"--rig": "the two rigs are A and B", "--align": CLOCKS, "--rigs": RIGS},
        "icon": {
            "--file": "belongs to two rigs",
            "--icon": "the two icons are A and B",
            "--align": CLOCKS,
            "--rigs": RIGS,
        },
        "set": {"--file": "belongs to two rigs; the two sets are A and B", "--align": CLOCKS},
        "table": {
            "--file": "belongs to two rigs",
            "--rig": "traces and logs are compared as they are",
            "--set": "traces and logs are compared as they are",
            "--rigs": RIGS,
        },
    }
    for option, why in misplaced[kind].items():
        if given[option]:
            raise usage(why, option)

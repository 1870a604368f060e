"""All checks in order, each on its own: one that fails is a finding, and the others still run."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from itertools import chain

from .packages import PROGRAM, Finding, first_line, installed_version

CHECKS = (
    ("Python", "packages", "check_python"),
    (PROGRAM, "packages", "check_program"),
    ("files", "machine", "check_data"),
    ("packages", "packages", "check_required"),
    ("extras", "packages", "check_extras"),
    ("ngspice", "machine", "check_ngspice"),
    ("cache", "machine", "check_cache"),
    ("kernel", "machine", "check_kernel"),
    ("self-test", "self_test", "check_self_test"),
)
"""What is checked, the module of this room that does it, and its function: the slowest last."""

FAULTY = 1
"""The exit code where there is a fault; that of bad input."""


def examine() -> Iterator[Finding]:
    """Run every check, each imported when its turn comes.

    Yields
    ------
    Finding
        At least one per check, as soon as it is known. A check that cannot run gives a fault.

    """
    for name, module, function in CHECKS:
        try:
            check: Callable[[], Iterable[Finding]] = getattr(import_module(f".{module}", __package__), function)
            yield from check()
        except Exception as error:
            cure = "mend the faults above, then run this again; else install thermicon in a new environment"
            yield Finding(name, "fault", f"cannot be checked ({first_line(error)})", cure)


def doctor(as_json: bool = False, cannot_start: BaseException | None = None) -> int:
    """Print every finding, and return the exit code: 0 without a fault, 1 with one.

    Parameters
    ----------
    as_json
        Print one JSON object at the end, instead of one line per finding as it is known.
    cannot_start
        Why the command line cannot be imported, which is then the first finding.

    Returns
    -------
    int
        The exit code.

    """
    findings: list[Finding] = []
    for finding in chain(commands(cannot_start), examine()):
        findings.append(finding)
        if not as_json:
            sys.stdout.write(f"{finding.line}\n")
            sys.stdout.flush()
    count = {state: sum(each.state == state for each in findings) for state in ("fault", "note")}
    if as_json:
        data = {
            PROGRAM: installed_version(PROGRAM),
            "ok": not count["fault"],
            "findings": [each.to_dict() for each in findings],
        }
        sys.stdout.write(json.dumps(data, indent=1) + "\n")
    else:
        sys.stdout.write(f"\n{summary(count['fault'], count['note'])}\n")
    return FAULTY if count["fault"] else 0


def commands(cannot_start: BaseException | None) -> Iterator[Finding]:
    """Yield why the command line cannot be imported, if it cannot."""
    if cannot_start is not None:
        cure = "mend the other faults, then run this again; else install thermicon in a new environment"
        yield Finding("commands", "fault", f"cannot be imported ({first_line(cannot_start)})", cure)


def summary(faults: int, notes: int) -> str:
    """Say what the findings mean.

    >>> summary(0, 0), summary(0, 1)
    ('Nothing is missing.', 'thermicon works. 1 note: something optional can be added or tidied.')
    >>> summary(2, 1)
    '2 faults: what stands behind each of them cures it. Begin with the first.'
    """
    if faults:
        return f"{faults} fault{'s' * (faults > 1)}: what stands behind each of them cures it. Begin with the first."
    if notes:
        return f"thermicon works. {notes} note{'s' * (notes > 1)}: something optional can be added or tidied."
    return "Nothing is missing."

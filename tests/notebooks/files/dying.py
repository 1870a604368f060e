"""Run by a test in a process of its own: exports that end at each of their events in turn.

Arguments: folder, case, way (kill, interrupt, full), first event, step. Prints a JSON line for each event: what the
folder and the one before held then, what else stood beside them, and what stood there after the next export.
"""

import contextlib
import errno
import hashlib
import io
import json
import os
import shutil
import signal
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from thermicon.base.files.atomic import OutputError
from thermicon.circuit.delivery.export_folder import claims_of, publish

EVENTS = ("mkdir", "open", "write", "fsync", "rename", "unlink", "rmdir", "chmod", "close")


def drive(name: str, content: bytes) -> dict[str, bytes]:
    """A drive with its sidecar, as far as their claims go."""
    about = {"thermicon": "0", "file": f"{name}.csv", "drive_sha256": hashlib.sha256(content).hexdigest()}
    return {f"{name}.json": json.dumps(about).encode(), f"{name}.csv": content}


OLD = {**drive("a", b"old"), **drive("b", b"old too")}
NEW = {**drive("a", b"new"), **drive("c", b"new too")}
CASES: dict[str, Mapping[str, bytes] | None] = {"new": None, "empty": {}, "forced": OLD}


def held(folder: Path) -> dict[str, str] | None:
    """What a folder holds; None where it is missing."""
    return {path.name: path.read_text() for path in folder.iterdir()} if folder.is_dir() else None


def patch(at: int, way: str) -> Callable[[], int]:
    """Let the event of this number end the process, interrupt it, or fail; returns a count of the events so far."""
    count = 0

    def meets(real: Callable[..., Any]) -> Callable[..., Any]:
        def event(*arguments: Any, **extra: Any) -> Any:
            nonlocal count
            count += 1
            if count == at:
                if way == "kill":
                    os.kill(os.getpid(), signal.SIGKILL)
                if way == "interrupt":
                    raise KeyboardInterrupt
                raise OSError(errno.ENOSPC, "No space left on device")
            return real(*arguments, **extra)

        return event

    for name in EVENTS:
        setattr(os, name, meets(getattr(os, name)))
    io.open = meets(io.open)
    return lambda: count


def end_at(number: int, way: str, goal: Path) -> int:
    """Export in a child that meets its end at an event; returns 0 where it had fewer events, else how it ended."""
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        return os.waitstatus_to_exitcode(status)
    code, leave = 9, os._exit
    counted = patch(number, way)
    with contextlib.suppress(BaseException):
        try:
            publish(NEW, goal, replace=True)
            code = 0 if counted() < number else 7
        except KeyboardInterrupt:
            code = 8
        except OutputError as error:
            code = 6 if "No space left" in str(error) else 5
    leave(code)


def put(folder: Path, files: Mapping[str, bytes]) -> None:
    """Make a folder with files."""
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)


def main(folder: Path, case: str, way: str, first: int, step: int) -> None:
    """End one case at every event that is due."""
    os.chdir(folder)
    claims_of(b"{}")  # loads what an export needs, once for all children
    for number in range(first, 10_000, step):
        for left in folder.iterdir():
            shutil.rmtree(left)
        goal, before = folder / "drives", folder / "drives.before"
        if (there := CASES[case]) is not None:
            put(goal, there)
        put(before, drive("older", b"older"))
        code = end_at(number, way, goal)
        if code == 0:
            break
        told = {"event": number, "code": code, "then": held(goal), "before": held(before)}
        told["left"] = [path.name for path in folder.iterdir() if path not in (goal, before)]
        for name in told["left"]:  # type: ignore[union-attr]
            shutil.rmtree(folder / name)
        publish(drive("later", b"last"), goal, replace=True)
        told |= {"after": held(goal), "at_last": sorted(path.name for path in folder.iterdir())}
        print(json.dumps(told), flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], sys.argv[3], int(sys.argv[4]), int(sys.argv[5]))

"""Runs a script on a disk that fails: it is full after so many bytes, or the process is killed there.

    python faulty_disk.py full|kill BYTES LOG SCRIPT [ARGUMENT …]

What the script writes by `os.write` is counted, without what it only tries in a `.lock` file; what it has on the disk
when `os.fsync` returns is appended to LOG, as the promise that must be kept.
"""

import errno
import os
import runpy
import signal
import sys
from pathlib import Path

write, fsync = os.write, os.fsync


def main(fault: str, count: str, log: str, script: str, *arguments: str) -> None:
    """Replace what reaches the disk, and run the script."""
    left = int(count)
    pending: dict[int, bytes] = {}

    def failing_write(file: int, content: bytes) -> int:
        nonlocal left
        if Path(f"/proc/self/fd/{file}").readlink().suffix == ".lock":
            return write(file, content)
        if left >= len(content):
            left -= len(content)
            pending[file] = pending.get(file, b"") + bytes(content)
            return write(file, content)
        part, left = bytes(content[:left]), 0
        if part:
            write(file, part)
        if fault == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if part:
            return len(part)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def logging_fsync(file: int) -> None:
        fsync(file)
        with Path(log).open("ab") as promised:
            promised.write(pending.pop(file, b""))

    os.write, os.fsync = failing_write, logging_fsync
    sys.argv = [script, *arguments]
    runpy.run_path(script, run_name="__main__")


if __name__ == "__main__":
    main(*sys.argv[1:])

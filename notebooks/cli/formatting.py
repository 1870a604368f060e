"""``thermicon fmt``: format cue files in canonical layout, in place, or only list them."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import typer

from ..files.outputs import OutputError, check_output, complete_or_absent
from ..messages import BAD_INPUT, note


def format_files(files: Sequence[str], check: bool) -> None:
    """Write files in canonical layout, each whole or not at all; with ``check``, print those that would change.

    Files in which something is wrong stay as they are: all their errors go to stderr, and the exit code is 1, as it is
    when a check finds a file that would change.
    """
    from thermicon.icons import CueErrors

    problems: list[str] = []
    changes = False
    for file in files:
        try:
            before = _read(file)
            after = canonical(before, file)
            if not check and after != before:
                _write(Path(file), after)
        except (CueErrors, OutputError) as error:
            problems.append(str(error))
            continue
        changes |= after != before
        if not check:
            typer.echo(f"{file}: {'unchanged' if after == before else 'formatted'}")
        elif after != before:
            typer.echo(file)
    if problems:
        note("\n\n".join(problems))
    if problems or (check and changes):
        raise typer.Exit(BAD_INPUT)


def canonical(data: bytes, file: str) -> bytes:
    """Return a cue file in canonical layout; CueErrors when it is not sound.

    Line ends are those of the first line, Windows' or not, and a byte order mark is taken away.

    >>> canonical(b"\\xef\\xbb\\xbfcue 1\\r\\nicon x{ hold for 1 s }", "x.cue")
    b'cue 1\\r\\n\\r\\nicon x {\\r\\n  hold for 1 s\\r\\n}\\r\\n'
    """
    from thermicon.icons import format_text

    text = format_text(data, file)
    first, newline, _ = data.partition(b"\n")
    return (text.replace("\n", "\r\n") if newline and first.endswith(b"\r") else text).encode()


def _read(file: str) -> bytes:
    from thermicon.icons import load_library
    from thermicon.icons.files.shipped import file_bytes, library_names

    data = file_bytes(file)
    if data is None and file in library_names():
        raise OutputError(f"{file}: a shipped set cannot be changed; give the name of your own file")
    if data is None:
        load_library(file)  # raises an error with the nearest name
        raise OutputError(f"{file}: no such file")
    return data


def _write(path: Path, data: bytes) -> None:
    check_output(path, (), "a cue file")
    with complete_or_absent(path) as draft:
        draft.write_bytes(data)
        shutil.copymode(path, draft)

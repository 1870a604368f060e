"""``thermicon lab``: the notebooks copied to a folder and opened in JupyterLab."""

import json
import os
import subprocess
import sys
import tempfile
from contextlib import ExitStack, suppress
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from thermicon.base.files.atomic import check_folder, complete_or_absent, stopped_cleanly
from thermicon.base.words.installing import install

from ..messages import fail, interrupted, note, usage
from .options import flag, opt

FOLDER = Path("thermicon-notebooks")
FILES = (".cue", ".csv", ".ipynb", ".json", ".py", ".toml", ".txt")
"""Endings of files: who gives one wants something else than a folder of that name."""
FIRST = "01_first_icon.ipynb"
PROMPT = "--ServerApp.kernel_websocket_connection_class=thermicon.notebooks.cli.prompt_socket.PromptSocket"
"""Option of JupyterLab by which answers of a kernel on this machine do not wait; a gateway has a socket of its own."""
NO_NEWS = {"@jupyterlab/apputils-extension:notification": {"fetchNews": "false"}}
"""Default of JupyterLab by which it does not ask whether to show its news; what a person chose there stays."""
ENDS_ITSELF_S, TIDIES_UP_S = 3.0, 10.0


def lab_command(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", readable=False, help="Folder for the notebooks; it is created if missing.")
    ] = FOLDER,
    files_only: Annotated[bool, flag("--files-only", "Only copy the notebooks, for use in your own Jupyter.")] = False,
    no_browser: Annotated[bool, flag("--no-browser", "Print the address and open no browser.")] = False,
    port: Annotated[int | None, opt("N", "Port on this machine.  [default: 8888]", 1, 65535)] = None,
    allow_root: Annotated[bool, flag("--allow-root", "Let JupyterLab run as root, as in a container.")] = False,
    force: Annotated[bool, flag("--force", "Also replace notebooks that are there by the shipped ones.")] = False,
) -> None:
    """Copy the notebooks to a folder and open JupyterLab there; Ctrl-C stops it.

    Notebooks that are there already are kept.
    """
    if allow_root and files_only:
        raise usage("is for JupyterLab; nothing else refuses to run as root", "--allow-root")
    if folder.suffix.lower() in FILES:
        raise usage(f"{str(folder)!r} is the name of a file, not of a folder; give one, such as {FOLDER}", "DIR")
    if not files_only and find_spec("jupyterlab") is None:
        fail(f"lab needs jupyterlab, which is not installed: {install('jupyterlab')}")
    written, kept = copy_notebooks(folder, force)
    there = f", {len(kept)} there already (--force replaces them)" if kept else ""
    note(f"{folder}: wrote {len(written)} notebooks{there}")
    if not files_only:
        serve([*command_of(folder, no_browser, port), *(["--allow-root"] if allow_root else [])])


def copy_notebooks(folder: Path, force: bool = False) -> tuple[list[str], list[str]]:
    """Put the shipped notebooks into a folder, which is made if missing; names of those written, and of those kept.

    All that are not there are written, or none; with ``force``, those too that are there. Raises OutputError where the
    folder cannot be used.
    """
    check_folder(folder)
    shipped = shipped_notebooks()
    kept = [name for name in shipped if (folder / name).exists() and not force]
    written = [name for name in shipped if name not in kept]
    made = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        with stopped_cleanly(), ExitStack() as drafts:  # all are written before the first gets its name
            for name in written:
                drafts.enter_context(complete_or_absent(folder / name)).write_bytes(shipped[name])
    except BaseException:
        if made:
            with suppress(OSError):
                folder.rmdir()
        raise
    return written, kept


def shipped_notebooks() -> dict[str, bytes]:
    """The notebooks of this version by name, in order."""
    found = [path for path in resources.files("thermicon.notebooks").iterdir() if path.name.endswith(".ipynb")]
    return {path.name: path.read_bytes() for path in sorted(found, key=lambda path: path.name)}


def command_of(folder: Path, no_browser: bool, port: int | None) -> list[str]:
    """The command that opens JupyterLab on the first notebook in a folder.

    With -P, Python imports nothing from the folder that it is started in.
    """
    words = [sys.executable, "-P", "-m", "jupyterlab", str(folder.resolve() / FIRST)]
    if "JUPYTER_GATEWAY_URL" not in os.environ:
        words.append(PROMPT)
    words += ["--no-browser"] if no_browser else []
    return words + ([f"--port={port}"] if port is not None else [])


def environment(folder: Path) -> dict[str, str]:
    """What JupyterLab runs in, with defaults of ours in a folder."""
    (folder / "labconfig").mkdir()
    (folder / "labconfig" / "default_setting_overrides.json").write_text(json.dumps(NO_NEWS), encoding="utf-8")
    paths = [str(folder), *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    return {**os.environ, "PYTHONSAFEPATH": "1", "JUPYTER_CONFIG_PATH": os.pathsep.join(paths)}


def serve(command: list[str]) -> None:
    """Run JupyterLab until it ends or Ctrl-C ends it; it is given the time to stop its kernels.

    It runs in an empty folder, since servers of Jupyter take settings, which are programs, from where they are started;
    kernels run in the folder of their notebooks, and import nothing from there (PYTHONSAFEPATH).
    """
    note("press Ctrl-C to stop")
    # Without a terminal to ask at, a server ends at once on Ctrl-C, which reaches it as well as this process.
    with (
        stopped_cleanly(),
        tempfile.TemporaryDirectory(prefix="thermicon-", ignore_cleanup_errors=True) as empty,
        subprocess.Popen(command, cwd=empty, env=environment(Path(empty)), stdin=subprocess.DEVNULL) as server,
    ):
        try:
            code = server.wait()
        except KeyboardInterrupt:
            for end, wait_s in ((server.terminate, ENDS_ITSELF_S), (server.kill, TIDIES_UP_S)):
                try:
                    server.wait(wait_s)
                    break
                except subprocess.TimeoutExpired:
                    end()
            raise interrupted() from None
    if code != 0:
        fail(f"jupyterlab ended with an error (exit code {code}); its messages are above")

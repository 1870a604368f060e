"""Control of JupyterLab in a real browser."""

import json
import os
import subprocess
import sys
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Locator, Page

from tests.builders import answers, free_port

STARTS_WITHIN_S = 60.0
RUNS_WITHIN_S = 90.0
SETTINGS = {
    "notebook-extension/tracker": {"windowingMode": "none"},  # cells out of sight are in the page as well
    "apputils-extension/notification": {"fetchNews": "false", "checkForUpdates": False},
    "docmanager-extension/plugin": {"autosave": False},
}
PANEL = "window.jupyterapp.shell.currentWidget"


@dataclass(frozen=True)
class Server:
    """A server on a port of its own; ``folder`` is what it serves, ``log`` what it said."""

    url: str
    folder: Path
    log: Path


@contextmanager
def running(module: str, options: Sequence[str], folder: Path, own: Path) -> Iterator[Server]:
    """``python -m MODULE OPTIONS`` in a folder, with settings and runtime files under ``own`` only, until the end."""
    own.mkdir(parents=True, exist_ok=True)
    port, log = free_port(), own / f"{module}.log"
    command = [sys.executable, "-m", module, *options, "--no-browser", f"--port={port}"]
    address = f"http://127.0.0.1:{port}"
    with log.open("wb") as said:
        process = subprocess.Popen(
            command, cwd=folder, env=environment(own), stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT
        )
        try:
            assert answers(f"{address}/api", process.poll, STARTS_WITHIN_S), log.read_text(errors="replace")[-4000:]
            yield Server(address, folder, log)
        finally:
            process.terminate()
            try:
                process.wait(15)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def environment(own: Path) -> dict[str, str]:
    """The environment of a server that neither reads nor writes anything of the person's Jupyter."""
    places = {
        "JUPYTER_CONFIG_DIR": own / "config",
        "JUPYTER_DATA_DIR": own / "data",
        "JUPYTER_RUNTIME_DIR": own / "runtime",
        "JUPYTERLAB_SETTINGS_DIR": own / "settings",
        "JUPYTERLAB_WORKSPACES_DIR": own / "workspaces",
        "IPYTHONDIR": own / "ipython",
    }
    for plugin, held in SETTINGS.items():
        path = own / "settings" / "@jupyterlab" / f"{plugin}.jupyterlab-settings"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(held), encoding="utf-8")
    return {**os.environ, **{name: str(path) for name, path in places.items()}}


def end_kernels(server: Server) -> None:
    """End every notebook's kernel on a JupyterLab server."""
    with urllib.request.urlopen(f"{server.url}/api/sessions", timeout=10) as answer:
        sessions = json.load(answer)
    for session in sessions:
        asked = urllib.request.Request(f"{server.url}/api/sessions/{session['id']}", method="DELETE")
        urllib.request.urlopen(asked, timeout=30).close()


def open_notebook(page: Page, server: Server, name: str) -> Locator:
    """Open a notebook of a JupyterLab server alone in the window, wait for its kernel, and return the notebook."""
    page.goto(f"{server.url}/doc/tree/{name}?reset")
    return _wait_until_open(page, name)


def _wait_until_open(page: Page, name: str) -> Locator:
    page.wait_for_function("window.jupyterapp !== undefined", timeout=1e3 * STARTS_WITHIN_S)
    page.wait_for_function(f"{PANEL}?.context?.isReady && {PANEL}.context.path === {json.dumps(name)}")
    wait_for_idle(page)
    notebook = page.locator(".jp-NotebookPanel:not(.lm-mod-hidden) .jp-Notebook")
    notebook.wait_for()
    return notebook


def wait_for_idle(page: Page, timeout_s: float = STARTS_WITHIN_S) -> None:
    """Wait until the kernel of the notebook has nothing to do."""
    page.wait_for_function(
        f"{PANEL}.sessionContext.session?.kernel?.status === 'idle' && {PANEL}.sessionContext.isReady",
        timeout=1e3 * timeout_s,
    )


def run_all(page: Page, timeout_s: float = RUNS_WITHIN_S) -> None:
    """Run all cells and wait until the last has answered; stops, as JupyterLab does, at the first error."""
    command(page, "notebook:run-all-cells", timeout_s)
    wait_for_idle(page)


def restart_kernel(page: Page) -> None:
    """Restart the kernel, without the question whether to; outputs and widgets stay in the page as they were."""
    page.evaluate(f"() => {PANEL}.sessionContext.session.kernel.restart()")
    wait_for_idle(page)


def command(page: Page, name: str, timeout_s: float = 30.0, **arguments: str) -> None:
    """Run a command of JupyterLab and wait for its end."""
    page.evaluate(
        "([name, arguments]) => { window.__done = false; window.jupyterapp.commands.execute(name, arguments).then("
        "() => { window.__done = true; }, error => { window.__done = String(error); }); }",
        [name, arguments],
    )
    page.wait_for_function("window.__done !== false", timeout=1e3 * timeout_s)
    ended = page.evaluate("window.__done")
    assert ended is True, f"{name}: {ended}"


def reload(page: Page) -> None:
    """Save the notebook and reload the browser's page, as a person does who goes on later; the kernel keeps running."""
    save(page)
    name = page.evaluate(f"{PANEL}.context.path")
    page.reload()
    _wait_until_open(page, name)


def dark(page: Page, wanted: bool = True) -> None:
    """Put JupyterLab into its dark theme, or back into its light one; the choice is kept until the server ends."""
    theme = f"JupyterLab {'Dark' if wanted else 'Light'}"
    command(page, "apputils:change-theme", theme=theme)
    page.wait_for_function(f"document.body.dataset.jpThemeName === '{theme}'")


def save(page: Page) -> None:
    """Save the notebook, as Ctrl-S does."""
    command(page, "docmanager:save")


def errors_in(page: Page) -> list[str]:
    """What the cells that ended with an error say: name, value and traceback."""
    outputs = page.evaluate(f"() => {PANEL}.content.widgets.flatMap(cell => cell.model.outputs?.toJSON() ?? [])")
    found = [output for output in outputs if output["output_type"] == "error"]
    return [f"{each['ename']}: {each['evalue']}\n" + "\n".join(each["traceback"]) for each in found]

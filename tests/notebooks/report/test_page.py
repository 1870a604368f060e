"""``thermicon lab --page`` as attackers meet it: other names, no token, many pages, other folders."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

from thermicon.icons.atomic import OutputError
from thermicon.notebooks.files.outputs import PAGE_FOLDER, below_start

POSIX = sys.platform != "win32"
TRAPS = ("voila", "jupyterlab", "json", "numba", "IPython", "ipykernel", "jupyter_server_config", "voila_config")


class NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: object) -> None:
        return None


def ask(address: str, host: str | None = None) -> tuple[int, str]:
    """Status and text of an answer; redirects are not followed."""
    request = urllib.request.Request(address, headers={} if host is None else {"Host": host})
    try:
        with urllib.request.build_opener(NoRedirect).open(request, timeout=60) as answer:
            return answer.status, answer.read().decode("utf-8", "replace")
    except urllib.error.HTTPError as refused:
        return refused.code, refused.read().decode("utf-8", "replace")


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    """Address with its token, and the folder, of a page whose folder is full of traps."""
    whole = tmp_path_factory.mktemp("page")
    folder = whole / "mine"
    folder.mkdir()
    for name in TRAPS:
        (folder / f"{name}.py").write_text(f"open({str(whole / ('ran-' + name))!r}, 'w')\n")
    (folder / "secret.png").write_bytes(b"secret")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = {f"JUPYTER_{name.upper()}_DIR": str(whole / name) for name in ("config", "data", "runtime")}
    command = [sys.executable, "-P", "-m", "thermicon.notebooks.cli.main", "lab", ".", "--page", "--no-browser"]
    log = whole / "log"
    with log.open("wb") as said:
        program = subprocess.Popen(
            [*command, "--port", str(port)], cwd=folder, env={**os.environ, **own}, stdout=said, stderr=said
        )
    try:
        for _ in range(600):
            if found := re.search(r"http://localhost:\d+/\?token=\S+", log.read_text(errors="replace")):
                break
            assert program.poll() is None, log.read_text(errors="replace")
            time.sleep(0.1)
        assert found is not None
        yield found[0].replace("localhost", "127.0.0.1"), folder
    finally:
        program.send_signal(signal.SIGTERM)
        program.wait(30)


def test_the_page_needs_its_token(served: tuple[str, Path]) -> None:
    address, _ = served
    bare = address.partition("?")[0]
    assert len(address.partition("token=")[2]) >= 32
    status, _ = ask(bare)
    assert status == 302, "to the form that asks for the token"
    assert ask(f"{bare}?token=guess")[0] == 302
    assert ask(f"{bare}api/kernels/00000000-0000-0000-0000-000000000000")[0] in (302, 403)


ODD = [
    "templates/", "templates/lab", "templates/lab/%2f", "templates/lab/x", "templates/lab/other/x",
    "templates/lab/static/", "templates/lab/static/%2f", "templates/lab/static/..%2f..%2f..",
    "templates/lab/static/%00", "templates//lab/static/x", "templates/.%2fstatic%2fx", "static/%00", "static/%2f",
    "files/%00", "../logout",
]  # fmt: skip


def test_an_odd_address_without_the_token_is_refused_as_any_other(served: tuple[str, Path]) -> None:
    address, _ = served
    bare = address.partition("?")[0]
    answers = {odd: ask(f"{bare}voila/{odd}".replace("voila/../", ""))[0] for odd in ODD}
    assert set(answers.values()) <= {302, 403}, answers
    assert ask(f"{bare}voila/templates/lab/static/voila.js")[0] == 200


OTHERS = ["attacker.example", "attacker.example:{port}", "localhost", "localhost.attacker.example:{port}"]


@pytest.mark.parametrize("host", OTHERS)
def test_the_page_answers_only_under_names_of_this_machine(served: tuple[str, Path], host: str) -> None:
    address, _ = served
    port = re.findall(r":(\d+)", address)[0]
    for place in (address, address.replace("?", "voila/static/style.css?")):
        status, text = ask(place, host.format(port=port))
        assert (status, text) == (
            403, "This page answers only on this machine, under localhost or 127.0.0.1 with its port.\n"
        )  # fmt: skip


def test_no_file_of_the_folder_is_served(served: tuple[str, Path]) -> None:
    address, _ = served
    for name in ("secret.png", "json.py", "workbench.ipynb", "../log"):
        status, text = ask(address.replace("?", f"voila/files/{name}?"))
        assert status in (403, 404)
        assert "secret" not in text


@pytest.mark.slow
def test_one_page_is_rendered_and_too_many_are_refused(served: tuple[str, Path]) -> None:
    from concurrent.futures import ThreadPoolExecutor

    from thermicon.notebooks.cli.page_server import MOST_KERNELS

    address, folder = served
    with ThreadPoolExecutor(MOST_KERNELS + 1) as pool:
        answers = list(pool.map(ask, [address] * (MOST_KERNELS + 1)))
    assert sorted(status for status, _ in answers) == [200] * MOST_KERNELS + [503]
    refused = next(text for status, text in answers if status == 503)
    assert f"{MOST_KERNELS} pages are open, which is the most: close one" in refused
    assert not list(folder.parent.glob("ran-*")), "a file of the folder was imported"


@pytest.mark.parametrize("typed", ["..", "../elsewhere", "a/../../b", "/", "link", "link/deeper"])
def test_the_page_writes_only_below_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, typed: str) -> None:
    start = tmp_path / "start"
    start.mkdir()
    (start / "link").symlink_to(tmp_path)
    monkeypatch.setenv(PAGE_FOLDER, str(start))
    with pytest.raises(OutputError, match=r"is outside the folder of this page; it writes only below .*start, into a"):
        below_start(Path(typed))
    assert below_start(Path("drives")) == (start / "drives").resolve()
    assert below_start(Path()) == start.resolve()
    monkeypatch.delenv(PAGE_FOLDER)
    assert below_start(Path(typed)) == Path(typed)

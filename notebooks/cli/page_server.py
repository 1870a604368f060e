"""The server of ``thermicon lab --page``: Voila for one person on this machine, who has the token in the address.

Voila answers anybody who reaches its port, under any name. Here every request names this machine (so that no page of
another site can reach it by changing what its own name stands for), pages and kernels need the token, no file of the
folder is served, and only so many kernels run at once.
"""

from __future__ import annotations

import html
import secrets
import tempfile
import threading
import webbrowser
from pathlib import Path
from typing import Any

from jupyter_server.auth.identity import IdentityProvider
from jupyter_server.auth.logout import LogoutHandler
from jupyter_server.services.kernels.kernelmanager import AsyncMappingKernelManager
from tornado.httputil import HTTPServerRequest
from tornado.web import HTTPError, RequestHandler
from traitlets.config import Config
from voila.app import Voila  # type: ignore[import-untyped]
from voila.static_file_handler import TemplateStaticFileHandler  # type: ignore[import-untyped]

from .prompt_socket import PromptSocket

NAMES = ("localhost", "127.0.0.1", "[::1]")
"""Names of this machine that a request may come under."""

MOST_KERNELS = 6
"""Pages open at once; each has a kernel of its own, which takes some 300 MB."""

IDLE_S, LOOKED_AT_S = 600, 60
"""A kernel whose page is closed ends after this time; how often that is looked at."""


class Kernels(AsyncMappingKernelManager):
    """The kernels of the page: a limited number, none of which imports from the folder it runs in."""

    starting = 0

    async def start_kernel(self, **given: Any) -> Any:  # type: ignore[override]
        """Start a kernel for a page, or refuse it with a sentence where too many run."""
        if len(self) + self.starting >= MOST_KERNELS:
            said = f"{MOST_KERNELS} pages are open, which is the most: close one, wait a moment and load this again"
            raise HTTPError(503, said, reason=said)
        self.starting += 1
        try:
            extra = [*given.pop("extra_arguments", []), "--InteractiveShellApp.ignore_cwd=True"]
            return await super().start_kernel(**given, extra_arguments=extra)
        finally:
            self.starting -= 1


class Refused(RequestHandler):
    """The answer to a request under a name that is not this machine's."""

    def prepare(self) -> None:
        """Refuse it, whatever is asked for."""
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"This page answers only on this machine, under {' or '.join(NAMES[:2])} with its port.\n")


class TemplateFiles(TemplateStaticFileHandler):  # type: ignore[misc]
    """Style sheets and scripts of Voila's templates; an address that cannot name one is refused as a wrong one is."""

    async def get(self, path: str, include_body: bool = True) -> None:
        """Answer with the file. Voila's own handler fails at an address without its three parts or with a zero byte."""
        try:
            await super().get(path, include_body)
        except (ValueError, AssertionError):
            raise HTTPError(403) from None


class PageServer(Voila):  # type: ignore[misc]
    """Voila with a token, a check of the Host header and a limit of kernels."""

    name = "voila"

    def initialize(self, argv: Any = None) -> None:
        """Read options and the user's own settings; what guards the page is not up to either."""
        super().initialize(argv)
        self.token = secrets.token_urlsafe(24)
        self.identity_provider_class = IdentityProvider
        self.kernel_websocket_connection_class = PromptSocket
        self.voila_configuration.multi_kernel_manager_class = Kernels
        self.voila_configuration.file_allowlist = []
        self.update_config(
            Config(
                Kernels={"cull_idle_timeout": IDLE_S, "cull_interval": LOOKED_AT_S, "cull_connected": False},
            )
        )

    def init_settings(self) -> dict[str, Any]:
        """Settings of the application; it is not for other machines."""
        found: dict[str, Any] = super().init_settings()
        return {**found, "allow_remote_access": False, "local_hostnames": ["localhost"]}

    def init_handlers(self) -> list[Any]:
        """Voila's handlers without that of logging out, for which Voila has no page."""
        found = [rule for rule in super().init_handlers() if rule[1] is not LogoutHandler]
        return [(rule[0], TemplateFiles) if rule[1] is TemplateStaticFileHandler else rule for rule in found]

    @property
    def display_url(self) -> str:
        """Address to open, with the token."""
        return f"{self._url('localhost')}?token={self.token}"

    def listen(self) -> None:
        """Answer requests that name this machine, and no others."""
        application = self.app
        found = application.find_handler

        def guarded(request: HTTPServerRequest, **given: Any) -> Any:
            if is_local(request.headers.get("Host", ""), self.port):
                return found(request, **given)
            return application.get_handler_delegate(request, Refused)

        application.find_handler = guarded
        super().listen()

    def launch_browser(self) -> None:
        """Open the page by a file that only this user can read: the arguments of a browser can be seen by all."""
        try:
            browser = webbrowser.get(self.browser or None)
        except webbrowser.Error:
            return
        with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
            address = html.escape(self.display_url, quote=True)
            file.write(
                f'<!doctype html><meta http-equiv="refresh" content="0; url={address}"><a href="{address}">open</a>'
            )
        threading.Thread(target=browser.open, args=(Path(file.name).as_uri(),), daemon=True).start()


def is_local(host: str, port: int) -> bool:
    """Whether a Host header names this machine, with the port that is served.

    >>> is_local("localhost:8866", 8866), is_local("127.0.0.1:8866", 8866), is_local("[::1]:8866", 8866)
    (True, True, True)
    >>> is_local("attacker.example:8866", 8866), is_local("localhost", 8866), is_local("", 8866)
    (False, False, False)
    """
    return host.strip().lower() in {f"{name}:{port}" for name in NAMES}


if __name__ == "__main__":
    PageServer.launch_instance()

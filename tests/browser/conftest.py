"""A real browser with JupyterLab on the shipped notebooks."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from tests.browser.jupyter import Server, end_kernels, errors_in, open_notebook, run_all, running
from thermicon.notebooks.cli.lab import PROMPT

if TYPE_CHECKING:
    from tests.browser.staticpage import Bench

CHROMIUMS = ("chromium", "chromium-browser", "google-chrome")
WINDOW = {"width": 1280, "height": 800}
LAB = (
    "--ServerApp.ip=127.0.0.1",
    "--IdentityProvider.token=",
    "--ServerApp.allow_root=True",
    "--ServerApp.disable_check_xsrf=True",
    "--ServerApp.port_retries=0",
    "--LabApp.expose_app_in_browser=True",
    PROMPT,
)


expect.set_options(timeout=30_000)  # a machine with busy cores answers late, which is not what these tests ask

SMOKE = "test_a_view_greets_and_draws_the_first_frame"
"""The test of this folder that belongs to the ordinary suite; all others are slow, or benchmarks, which run alone."""


@pytest.hookimpl(tryfirst=True)  # before pytest deselects what is slow
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last: Playwright keeps an event loop running in this thread, which breaks others."""
    items.sort(key=lambda item: Path(__file__).parent in item.path.parents)
    for item in (one for one in items if Path(__file__).parent in one.path.parents):
        if getattr(item, "originalname", item.name) != SMOKE and not item.get_closest_marker("benchmark"):
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def browser(tool: Callable[[str], str]) -> Iterator[Browser]:
    """Debian's chromium, without a window. Missing, the test is skipped, or fails where tools are required."""
    path = next((found for name in CHROMIUMS if (found := shutil.which(name))), None) or tool("chromium")
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A new window of 1280 x 800 that shares nothing with other tests."""
    context = browser.new_context(viewport=WINDOW, accept_downloads=True)
    context.set_default_timeout(30_000)
    yield context.new_page()
    context.close()


@pytest.fixture(scope="session")
def jupyterlab(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Server]:
    """One JupyterLab for all tests, since it takes seconds to start."""
    own = tmp_path_factory.mktemp("lab")
    (own / "notebooks").mkdir()
    with running("jupyterlab", LAB, own / "notebooks", own / "jupyter") as server:
        yield server


@pytest.fixture
def lab(jupyterlab: Server) -> Iterator[Server]:
    """JupyterLab on the notebooks as ``thermicon lab --files-only`` puts them, fresh and without a kernel."""
    from thermicon.notebooks.cli.lab import copy_notebooks

    theme = jupyterlab.log.parent / "settings/@jupyterlab/apputils-extension/themes.jupyterlab-settings"
    theme.unlink(missing_ok=True)
    for left in jupyterlab.folder.iterdir():
        shutil.rmtree(left) if left.is_dir() else left.unlink()
    copy_notebooks(jupyterlab.folder)
    yield jupyterlab
    end_kernels(jupyterlab)


@pytest.fixture
def bench(page: Page, lab: Server) -> Page:
    """JupyterLab with the workbench notebook run, its views at the top of the window."""
    from tests.browser.onbench import wait_until_drawn

    open_notebook(page, lab, "workbench.ipynb")
    run_all(page)
    assert errors_in(page) == []
    wait_until_drawn(page)
    return page


@pytest.fixture
def made(page: Page) -> Iterator[Bench]:
    """The canvas module in a page, without a view; at the end nothing has gone wrong there."""
    from tests.browser.staticpage import open_bench

    bench = open_bench(page)
    yield bench
    assert bench.wrong == []


@pytest.fixture
def drawn(made: Bench) -> Bench:
    """The design view of the canvas alone with its first frame."""
    made.draw()
    return made

"""A workbench of a cue file with its bar."""

import re
from pathlib import Path

from tests.builders import messages
from thermicon.notebooks import Workbench
from thermicon.notebooks.workbench.document_bar import DocumentBar
from thermicon.notebooks.workbench.live_view import BackgroundWorker

SAID = messages(__file__)
TEXT = "cue 1\n\nicon a { cool by 3 K at 2 K/s; return at 2 K/s }\n\nicon b { hold for 1 s }\n"
TYPED = TEXT.replace("3 K", "4 K")


def opened(path: Path | str | None) -> tuple[Workbench, DocumentBar]:
    bench = Workbench(path)
    assert bench.page is not None
    assert bench.bar is not None
    return bench, bench.bar


def said(bar: DocumentBar) -> str:
    return re.sub(r"<[^>]*>", "", bar.said.value)


def title(bar: DocumentBar) -> str:
    return re.sub(r"<[^>]*>", "", bar.title.value)


def wait(worker: BackgroundWorker) -> None:
    """Wait until all jobs have ended."""
    for thread in worker.threads:
        thread.join(60.0)
        assert not thread.is_alive()

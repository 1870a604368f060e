"""The pictures of pages, drawn while the site is built by the commands that `<!-- picture: … -->` marks name."""

from __future__ import annotations

import hashlib
import re
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

MARK = re.compile(r"^<!-- picture: (?P<commands>[^|\n]+) \| (?P<alt>[^|\n]+) -->\n", re.MULTILINE)
"""Commands without `thermicon`, with `&&` between them; the last one draws. A code host shows nothing of it."""
SAVED = re.compile(r"Save as `(?P<name>[\w.-]+)`[^\n]*\n\n```\w*\n(?P<text>.*?)```", re.DOTALL)


class PictureError(RuntimeError):
    """A command of a mark that draws nothing: which one, and what it said."""


def command_lines(mark: re.Match[str]) -> list[str]:
    """Return the commands of a mark; the last one draws.

    >>> command_lines(MARK.search("<!-- picture: rank six-icons | Confusions -->\\n"))
    ['rank six-icons --figure picture.png']
    """
    return f"{mark['commands']} --figure picture.png".split(" && ")


class PagePictures:
    """Draws pictures into a folder and keeps them there; without a folder, pages have none."""

    def __init__(self, kept: Path | None) -> None:
        self.kept = kept

    def picture(self, mark: re.Match[str], page: str) -> Path | None:
        """Return the picture of a mark, drawn beside the files that its page says to save."""
        if self.kept is None:
            return None
        saved = {file["name"]: file["text"] for file in SAVED.finditer(page)}
        asked = repr((command_lines(mark), sorted(saved.items())))
        path = self.kept / f"{hashlib.sha256(asked.encode()).hexdigest()[:12]}.png"
        if not path.is_file():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(_drawn(command_lines(mark), saved))
        return path


def _drawn(lines: list[str], saved: dict[str, str]) -> bytes:
    import shlex

    from typer.testing import CliRunner

    from thermicon.notebooks.cli.main import app

    with TemporaryDirectory() as name, chdir(name):
        for file, text in saved.items():
            Path(file).write_text(text, encoding="utf-8")
        for line in lines:
            result = CliRunner().invoke(app, shlex.split(line))
            if result.exit_code:
                raise PictureError(f"thermicon {line}: exit code {result.exit_code}: {result.output}{result.exception}")
        if not Path("picture.png").is_file():  # of many icons, one picture each
            raise PictureError(f"thermicon {line}: writes {', '.join(sorted(map(str, Path().glob('*.png'))))}")
        return Path("picture.png").read_bytes()

"""Pictures of pages that the site's build draws by the commands in `<!-- picture: … -->` marks."""

import hashlib
import re
import shlex
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from typer.testing import CliRunner

from thermicon.notebooks.cli.main import app

MARK = re.compile(r"^<!-- picture: (?P<commands>[^|\n]+) \| (?P<alt>[^|\n]+) -->\n", re.MULTILINE)
"""Commands without `thermicon`, with `&&` between them; the last one draws. A code host shows nothing of it."""
COLUMN = " --paper 85mm"
SAVED = re.compile(r"Save as `(?P<name>[\w.-]+)`[^\n]*\n\n```\w*\n(?P<text>.*?)```", re.DOTALL)


def command_lines(mark: re.Match[str]) -> list[str]:
    """Return the commands of a mark; the last one draws, for a column unless the mark says how wide."""
    return f"{mark['commands']} --figure picture.png{COLUMN * ('--paper' not in mark['commands'])}".split(" && ")


def page_picture(mark: re.Match[str], page: str, kept: Path) -> Path:
    """Return the picture of a mark, drawn beside the files that its page says to save, and kept in a folder."""
    saved = {file["name"]: file["text"] for file in SAVED.finditer(page)}
    asked = repr((command_lines(mark), sorted(saved.items())))
    path = kept / f"{hashlib.sha256(asked.encode()).hexdigest()[:12]}.png"
    if not path.is_file():
        kept.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory() as name, chdir(name):
            for file, text in saved.items():
                Path(file).write_text(text, encoding="utf-8")
            for line in command_lines(mark):
                if (result := CliRunner().invoke(app, shlex.split(line))).exit_code:
                    raise RuntimeError(f"thermicon {line}: {result.output}{result.exception}")
            drawn = Path("picture.png").read_bytes()
        path.write_bytes(drawn)
    return path

"""``thermicon check`` at the command line."""

import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli
from thermicon.notebooks.editing.cue_check import read_text

HEAVY = {"numba", "numpy", "pandas", "matplotlib", "scipy", "IPython", "ipywidgets", "rich", "tqdm"}
LOOSE = "# über alles\ncue 1\nicon dip{cool by 6K at 3 K/s; hold for 500 ms; return at 3 K/s # back\n}\n"
TIDY = "# über alles\ncue 1\n\nicon dip {\n  cool by 6 K at 3 K/s\n  hold for 500 ms\n  return at 3 K/s  # back\n}\n"


def written(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_nothing_heavy_is_imported(two: Path) -> None:
    program = (
        "import sys\nfrom thermicon.notebooks.cli.main import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, "check", str(two)], capture_output=True, encoding="utf-8", check=True
    )
    assert HEAVY & set(run.stdout.split()) == set()


def test_files_are_brought_into_canonical_layout(cli: Cli, tmp_path: Path) -> None:
    loose, tidy = written(tmp_path / "a.cue", LOOSE), written(tmp_path / "b.cue", TIDY)
    before = tidy.stat().st_mtime_ns, tidy.stat().st_ino
    said = cli("check", "--fix", loose, tidy)
    assert (said.exit_code, said.stderr) == (0, f"{loose}: formatted\n")
    assert [line.split(":")[0] for line in said.stdout.splitlines()] == ["a.cue", "b.cue"]
    assert loose.read_bytes() == tidy.read_bytes() == TIDY.encode()
    assert (tidy.stat().st_mtime_ns, tidy.stat().st_ino) == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.cue", "b.cue"]


@pytest.mark.parametrize("before", [b"", b"\xef\xbb\xbf"], ids=["plain", "with a byte order mark"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_line_ends_stay(cli: Cli, tmp_path: Path, before: bytes, end: str) -> None:
    path = written(tmp_path / "a.cue", before + LOOSE.replace("\n", end).encode())
    cli.good("check", "--fix", path)
    assert path.read_bytes() == TIDY.replace("\n", end).encode()


def test_bad_files_are_told_together_and_stay_as_they_are(cli: Cli, tmp_path: Path) -> None:
    good = written(tmp_path / "good.cue", LOOSE)
    slip = written(tmp_path / "slip.cue", "cue 1\nicon x{ hold for 4 }")
    mute = written(tmp_path / "mute.cue", b"cue 1\n\xff")
    said = cli("check", "--fix", slip, good, mute, tmp_path / "none.cue", tmp_path)
    assert said.exit_code == 1
    for words in ("slip.cue:2:18  E102", "mute.cue  E007", "none.cue  E001", "E002"):
        assert words in said.stderr
    assert slip.read_bytes() == b"cue 1\nicon x{ hold for 4 }"
    assert mute.read_bytes() == b"cue 1\n\xff"
    assert good.read_text(encoding="utf-8") == TIDY


@pytest.mark.skipif(sys.platform == "win32", reason="modes and links of POSIX")
def test_the_mode_of_a_file_stays_and_a_link_is_followed(cli: Cli, tmp_path: Path) -> None:
    path = written(tmp_path / "a.cue", LOOSE)
    path.chmod(0o640)
    link = tmp_path / "link.cue"
    link.symlink_to(path)
    cli.good("check", "--fix", link)
    assert link.is_symlink()
    assert path.read_text(encoding="utf-8") == TIDY
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


TURNS = """cue 1
set turns { elements left, right; baseline 32 °C }
icon turn-left { together {
  on left { warm by 3 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
  on right { cool by 3 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
} }
icon leave { on left { cool by 4 °C at 2 °C/s; hold for 1 s; return at 2 °C/s } }
"""


def test_a_set_on_several_elements_is_checked_and_refused_by_what_plays_one(cli: Cli, tmp_path: Path) -> None:
    path = written(tmp_path / "turns.cue", TURNS)
    said = cli.good("check", path)
    assert said.stdout == "turns.cue: 2 icons on left, right (3 different tracks), 5 s, 28–35 °C, steepest 2 °C/s\n"
    assert "Next" not in said.stderr
    converted = tmp_path / "again.cue"
    cli.good("convert", path, "-o", converted)
    assert cli.good("check", converted).stdout.partition(":")[2] == said.stdout.partition(":")[2]
    for command in (
        *(
            ["rank", "--doubt"],
            ["improve"],
            ["sweep", "--vary", "contact.area_cm2=1,4"],
            ["list", "--cite"],
        ),
        *(["pilot"], ["play", "-o", tmp_path / "log"]),
    ):
        refused = cli(*command, path)
        assert refused.exit_code == 1, command
        last = refused.stderr.splitlines()[-1]
        assert last.startswith("turns is for several elements (left, right)"), command
        assert last.endswith('; for one element, leave out "elements" and "on"')


def test_an_editor_shows_why_a_set_on_several_elements_cannot_be_opened() -> None:
    (trouble,) = read_text(TURNS).troubles
    assert trouble.headline.startswith("turns is for several elements")

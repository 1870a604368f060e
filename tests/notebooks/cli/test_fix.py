"""``thermicon check --fix``: files in canonical layout, whole or untouched."""

from __future__ import annotations

import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.icons import format_text

Cli = Callable[..., Any]
LOOSE = "cue 1\nicon dip{cool by 6K at 3 K/s; return at 3 K/s # back\n}\n"
TIDY = "cue 1\n\nicon dip {\n  cool by 6 K at 3 K/s\n  return at 3 K/s  # back\n}\n"


def written(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_files_are_brought_into_canonical_layout(cli: Cli, tmp_path: Path) -> None:
    loose, tidy = written(tmp_path / "a.cue", LOOSE), written(tmp_path / "b.cue", TIDY)
    before = tidy.stat().st_mtime_ns, tidy.stat().st_ino
    said = cli("check", "--fix", loose, tidy)
    assert (said.exit_code, said.stderr) == (0, f"{loose}: formatted\n")
    assert [line.split(":")[0] for line in said.stdout.splitlines()] == ["a.cue", "b.cue"]
    assert loose.read_bytes() == tidy.read_bytes() == TIDY.encode()
    assert (tidy.stat().st_mtime_ns, tidy.stat().st_ino) == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.cue", "b.cue"]


def test_bad_files_are_told_together_and_stay_as_they_are(cli: Cli, tmp_path: Path) -> None:
    good = written(tmp_path / "good.cue", LOOSE)
    slip = written(tmp_path / "slip.cue", "cue 1\nicon x{ hold for 4 }")
    mute = written(tmp_path / "mute.cue", b"cue 1\n\xff")
    said = cli("check", "--fix", slip, good, mute, tmp_path / "none.cue", tmp_path)
    assert said.exit_code == 1
    for words in ("slip.cue:2:18  E102", "mute.cue  E007", "none.cue  E001 no such file", "E002 a folder, not a file"):
        assert words in said.stderr
    assert slip.read_bytes() == b"cue 1\nicon x{ hold for 4 }"
    assert mute.read_bytes() == b"cue 1\n\xff"
    assert good.read_text(encoding="utf-8") == TIDY


def test_a_shipped_set_is_refused(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said = cli("check", "--fix", "six-icons")
    assert (said.exit_code, said.stdout) == (1, "")
    assert said.stderr == "six-icons: a shipped set cannot be changed; give the name of your own file\n"
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "six-icons", LOOSE)
    assert cli("check", "--fix", "six-icons").stderr == "six-icons: formatted\n"


def test_line_ends_stay_and_a_byte_order_mark_goes(cli: Cli, tmp_path: Path) -> None:
    path = written(tmp_path / "a.cue", b"\xef\xbb\xbf" + LOOSE.replace("\n", "\r\n").encode())
    assert cli("check", "--fix", path).exit_code == 0
    assert path.read_bytes() == TIDY.replace("\n", "\r\n").encode()
    assert cli("check", "--fix", path).stderr == ""
    old = written(path, TIDY.replace("\n", "\r").encode())
    assert cli("check", "--fix", old).exit_code == 0
    assert old.read_bytes() == TIDY.encode()


def test_comments_and_units_stay(cli: Cli, tmp_path: Path) -> None:
    text = "# über alles\ncue 1\nicon x { hold for 500 ms; warm by 1 K at 1 degC/s } # end\n"
    path = written(tmp_path / "a.cue", text)
    assert cli("check", "--fix", path).exit_code == 0
    assert path.read_text(encoding="utf-8") == format_text(text)
    assert "# über alles\n" in format_text(text)
    assert "500 ms" in format_text(text)


@pytest.mark.skipif(sys.platform == "win32", reason="modes and links of POSIX")
def test_the_mode_of_a_file_stays_and_a_link_is_followed(cli: Cli, tmp_path: Path) -> None:
    path = written(tmp_path / "a.cue", LOOSE)
    path.chmod(0o640)
    link = tmp_path / "link.cue"
    link.symlink_to(path)
    assert cli("check", "--fix", link).exit_code == 0
    assert link.is_symlink()
    assert path.read_text(encoding="utf-8") == TIDY
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_file_that_cannot_be_written_is_told(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "a.cue", LOOSE)
    monkeypatch.setattr("os.access", lambda *_: False)
    said = cli("check", "--fix", path)
    assert said.exit_code == 1
    assert f"cannot write {path}" in said.stderr
    assert path.read_text(encoding="utf-8") == LOOSE


def test_json_is_no_cue_file(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"a": 1}', encoding="utf-8")
    said = cli("check", "--fix", str(path))
    assert said.exit_code == 1
    assert "this is JSON" in said.stderr
    assert path.read_text(encoding="utf-8") == '{"a": 1}'


def test_a_code_is_explained_by_an_example(cli: Cli) -> None:
    said = cli("check", "--explain", "e102")
    assert said.exit_code == 0
    assert said.stdout.startswith("E102 missing unit\n")
    assert "did you mean:" in said.stdout
    unknown = cli("check", "--explain", "E99")
    assert (unknown.exit_code, "there is no error E99; the nearest are" in unknown.stderr) == (2, True)
    assert "stands alone" in cli("check", "--explain", "E102", "six-icons").stderr
    assert "canonical layout" in cli("check", "--help").stdout

"""Shipped sets are what they say; files are found, or it is said why not."""

import subprocess
import sys
from pathlib import Path

import pytest

from thermicon.icons import CueErrors, format_text, load_library, parse, read_cue
from thermicon.icons.files.shipped import library_names

SIX = load_library("six-icons")
NAMES = (
    "calibration-drive",
    "cooling-step-skin",
    "pulse-sequences",
    "search-space",
    "six-icons",
    "wave-confusions",
    "wave-shapes",
    "wilson-ramps",
)


def test_the_shipped_sets() -> None:
    assert library_names() == NAMES
    for name in NAMES:
        icons = load_library(name)
        assert icons.name == name
        assert icons.title
        assert icons.context.baseline_C == 32.0
        assert all(entry.metadata.means and entry.metadata.by for entry in icons.entries)
        assert parse(str(icons)) == icons
        assert format_text(str(icons)) == str(icons)


def test_what_is_not_published_is_marked_as_reconstruction() -> None:
    assert "reconstruction" not in SIX["cooling-step"].metadata.tags
    assert sum("reconstruction" in icon.metadata.tags for icon in SIX) == 5


@pytest.mark.parametrize("icon", SIX, ids=lambda icon: icon.name)
def test_the_six_icons_are_comparable(icon: object) -> None:
    corners = icon.corners()  # type: ignore[attr-defined]
    assert 8 <= corners.duration_s <= 10
    assert corners.value[0] == corners.value[-1] == 32.0
    assert corners.lowest >= 20
    assert corners.highest < 38


def test_the_published_steps() -> None:
    for icons in (SIX, load_library("cooling-step-skin")):
        corners = icons["cooling-step"].corners()
        assert (corners.time_s, corners.value) == ((0.0, 2.0, 6.0, 8.0), (32.0, 26.0, 26.0, 32.0))
    assert (SIX.context.control, load_library("cooling-step-skin").context.control) == ("display", "skin")


def test_files_are_read_and_an_existing_path_wins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "cue 1\nicon mine { hold for 1 s }\n"
    (tmp_path / "my.cue").write_text(text, encoding="utf-8")
    (tmp_path / "six-icons").write_text(text, encoding="utf-8")
    assert read_cue(tmp_path / "my.cue").icons[0].name == "mine"
    assert len(read_cue("six-icons")) == 6
    monkeypatch.chdir(tmp_path)
    assert read_cue("my.cue").icons[0].name == "mine"
    assert len(read_cue("six-icons")) == 1


def test_what_cannot_be_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(CueErrors, match=r"E002 a folder(?s:.)*my-set\.cue"):
        read_cue(tmp_path)
    with pytest.raises(CueErrors, match=r"six-icon  E001 no such file(?s:.)*did you mean six-icons\?"):
        read_cue("six-icon")
    with pytest.raises(CueErrors, match=f"shipped sets are: {', '.join(NAMES)}"):
        load_library("nothing")
    with pytest.raises(CueErrors, match=r"'a\\x00b'  E001 no such file"):
        read_cue("a\0b")
    with pytest.raises(CueErrors, match=r"E00[13]"):
        read_cue("x" * 5000)
    (tmp_path / "my.cue").write_bytes(b"cue 1\nicon mine { hold for 1 }\n")
    with pytest.raises(CueErrors, match=r"my\.cue:2:22  E102 missing unit"):
        read_cue(tmp_path / "my.cue")
    big = tmp_path / "big.cue"
    big.write_bytes(b"#" * 300_000)
    with pytest.raises(CueErrors, match="E004 file too large\n  300,000 bytes"):
        read_cue(big)


def test_an_unreadable_file_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "locked.cue"
    path.write_text("cue 1", encoding="utf-8")

    def refuse(self: Path, mode: str) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(CueErrors, match="E003 unreadable file\n  the system says: Permission denied"):
        read_cue(path)


def test_parsing_imports_nothing_heavy() -> None:
    code = (
        "import sys; from thermicon.icons import read_cue; repr(read_cue('six-icons').icons[0].corners()); "
        "print([name for name in ('numpy', 'pandas', 'numba', 'matplotlib', 'pydantic') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"

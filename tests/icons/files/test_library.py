"""Shipped sets as listed and reasons for missing files."""

from pathlib import Path

import pytest

from thermicon.icons import CueErrors, load_library, read_cue
from thermicon.icons.files.cite import cited
from thermicon.icons.files.shipped import library_names

SIX = load_library("six-icons")
NAMES = (
    *("bars", "calibration-drive", "calls", "cooling-step-skin", "pulse-sequences", "search-space"),
    *("six-icons", "turns", "wave-confusions", "wave-shapes", "wilson-ramps"),
)


def test_the_shipped_sets() -> None:
    assert library_names() == NAMES
    for name in NAMES:
        icons = load_library(name)
        assert icons.name == name and icons.title
        assert icons.context.baseline_C == 32.0
        assert all(entry.metadata.means and entry.metadata.by for entry in (*icons.entries, *icons.spatial))
        assert bool(cited(icons)) == (icons.metadata.by != "thermicon"), "known sources"
    assert "reconstruction" not in SIX["cooling-step"].metadata.tags
    assert sum("reconstruction" in icon.metadata.tags for icon in SIX) == 5, "what is not published is marked"


def test_the_six_icons_are_comparable() -> None:
    for corners in (icon.corners() for icon in SIX):
        assert 8 <= corners.duration_s <= 10
        assert corners.value[0] == corners.value[-1] == 32.0
        assert corners.lowest >= 20 and corners.highest < 38


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


def test_what_cannot_be_read_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "my.cue"
    path.write_bytes(b"cue 1\nicon mine { hold for 1 }\n")
    (tmp_path / "big.cue").write_bytes(b"#" * 300_000)
    for given, said in (
        (tmp_path, r"E002 a folder(?s:.)*my-set\.cue"),
        ("six-icon", r"six-icon  E001 no such file(?s:.)*did you mean six-icons\?"),
        ("nothing", f"shipped sets are: {', '.join(NAMES)}"),
        ("a\0b", r"'a\\x00b'  E001 no such file"),
        ("x" * 5000, "E00[13]"),
        (path, r"my\.cue:2:22  E102 missing unit"),
        (tmp_path / "big.cue", "E004 file too large\n  300,000 bytes"),
    ):
        with pytest.raises(CueErrors, match=said):
            read_cue(given)
    with pytest.raises(CueErrors, match="shipped sets are"):
        load_library("nothing")

    def refuse(self: Path, mode: str) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(CueErrors, match="E003 unreadable file\n  the system says: Permission denied"):
        read_cue(path)

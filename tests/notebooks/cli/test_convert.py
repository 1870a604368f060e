"""``thermicon convert``: icons and recordings as cue text and as JSON, complete or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from thermicon.icons import load_library, read_cue, to_json

Cli = Callable[..., Any]


def test_a_set_is_written_as_json_and_as_cue_text_over_what_was_there(cli: Cli, tmp_path: Path) -> None:
    as_json, as_cue = tmp_path / "six.json", tmp_path / "six.cue"
    as_json.write_text("old")
    said = cli("convert", "six-icons", "-o", as_json)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"wrote {as_json}: 6 icons\n"
    assert as_json.read_text(encoding="utf-8") == to_json(load_library("six-icons"))
    cli.good("convert", "six-icons", "-o", as_cue)
    assert as_cue.read_text(encoding="utf-8") == str(load_library("six-icons"))


def test_a_recording_becomes_an_icon(cli: Cli, tmp_path: Path) -> None:
    path, out = tmp_path / "dip.csv", tmp_path / "dip.cue"
    path.write_text("time_s,a,b\n0,32.1,9\n2,26,9\n4,26.04,9\n6,25.97,9\n8,32.1,9\n", encoding="utf-8")
    options = ("--tolerance", "0.2", "--name", "cold", "--column", "a", "--control", "skin")
    said = cli("convert", path, "-o", out, *options)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"cold: 4 corners, 8 s\nwrote {out}: 1 icon\n"
    (icon,) = read_cue(out)
    assert (icon.name, icon.context.control) == ("cold", "skin")
    assert abs(icon.corners().at(4) - 26) < 0.2
    cli.good("convert", path, "-o", tmp_path / "dip.json", *options)
    assert (tmp_path / "dip.json").read_text(encoding="utf-8") == to_json(read_cue(out))

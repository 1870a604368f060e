"""Recordings in CSV files as icons."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.builders import messages
from thermicon.icons import Icon, parse
from thermicon.icons.model.statements import Hold, Ramp, Rest, Return, Step
from thermicon.icons.recordings.recorded import from_csv

Array = NDArray[np.float64]
STEP = ((0.0, 2.0, 4.0, 8.0, 10.0, 12.0), (32.0, 32.0, 26.0, 26.0, 32.0, 32.0))


def written(folder: Path, text: str | bytes, name: str = "rec.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def table(time: Array, value: Array, column: str = "display_C") -> str:
    rows = "".join(f"{t:.3f},{v:.4f}\n" for t, v in zip(time, value, strict=True))
    return f"time_s,{column}\n{rows}"


MESSAGES = messages(__file__)
DIP = MESSAGES["tables"]["plain"]
DIP_ICON = (Rest(1), Ramp("cool", to_C=26, duration_s=2), Hold(4), Return(duration_s=2))


def test_a_recording_becomes_an_icon_that_reads_well(tmp_path: Path) -> None:
    time = np.arange(1201) / 100
    value = np.interp(time, *STEP) + np.random.default_rng(3).uniform(-0.04, 0.04, len(time))
    icon = from_csv(written(tmp_path, table(time, value), "my dip_2.csv"))
    assert str(icon) == (
        "cue 1\n\nset {\n  control display\n  baseline 32 °C\n}\n\nicon my-dip-2 {\n  rest for 2 s\n"
        "  cool to 26 °C over 2 s\n  hold for 4 s\n  return over 2 s\n  rest for 2 s\n}\n"
    )
    assert parse(str(icon))["my-dip-2"] == icon
    assert np.abs(np.interp(time, icon.corners().time_s, icon.corners().value) - value).max() <= 0.05


@pytest.mark.parametrize("written_by", MESSAGES["tables"])
def test_tables_as_programs_write_them(tmp_path: Path, written_by: str) -> None:
    icon = from_csv(written(tmp_path, MESSAGES["tables"][written_by]))
    assert icon.statements == DIP_ICON
    assert (icon.name, icon.context.control, icon.context.baseline_C) == ("rec", "display", 32.0)


def test_the_control_follows_the_column_that_tells(tmp_path: Path) -> None:
    def control(header: str, **more: str) -> str:
        path = written(tmp_path, DIP.replace("display_C", header))
        return from_csv(path, **more).context.control  # type: ignore[arg-type]

    assert control("skin_C") == "skin"
    assert control("display_C", control="skin") == "display"
    assert [control(each) for each in ("temperature_C", "target_C", "setpoint_C")] == ["display"] * 3
    assert control("target_C", control="skin") == "skin"
    assert control("probe_3", column="probe_3", control="skin") == "skin"


def test_one_of_several_temperatures_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "time_s,display_C,skin_C\n0,30,32\n1,30,31\n")
    icon = from_csv(path, column="skin_C", name="fall")
    assert (icon.name, icon.context.control) == ("fall", "skin")
    assert icon.statements == (Ramp("cool", to_C=31, duration_s=1),)


def test_a_step_of_the_recording_is_a_step_of_the_icon(tmp_path: Path) -> None:
    path = written(tmp_path, "time_s,setpoint_C\n0,32\n2,32\n2,26\n6,26\n6,32\n8,32\n", "2nd.csv")
    icon = from_csv(path)
    assert icon.name == "recorded-2nd"
    assert icon.statements == (Rest(2), Step("cool", to_C=26), Hold(4), Step("warm", to_C=32), Rest(2))


def test_baseline_can_be_prescribed(tmp_path: Path) -> None:
    path = written(tmp_path, DIP.replace("32", "32.03"))
    assert from_csv(path).context.baseline_C == 32.03
    icon = from_csv(path, baseline_C=32)
    assert icon.context.baseline_C == 32
    assert isinstance(icon.statements[0], Rest) and isinstance(icon.statements[-1], Return)


@pytest.mark.slow
def test_a_minute_at_a_kilohertz(tmp_path: Path) -> None:
    time = np.arange(60_001) / 1000
    value = 32 - 3 * np.interp(time % 6, [0, 1, 2, 3, 6], [0, 1, 1, 0, 0])
    value += np.random.default_rng(0).uniform(-0.04, 0.04, len(time))
    icon = from_csv(written(tmp_path, table(time, value)))
    assert icon.statements[:4] == (Ramp("cool", to_C=29, duration_s=1), Hold(1), Return(duration_s=1), Rest(3))
    assert len(icon.statements) == 40


@pytest.mark.parametrize("text", MESSAGES["recording"])
def test_every_message_about_a_file_is_read(tmp_path: Path, text: str) -> None:
    place, message = MESSAGES["recording"][text]
    with pytest.raises(ValueError, match=message) as found:
        from_csv(written(tmp_path, text))
    lines = str(found.value).split("\n")
    assert lines[0].startswith(f"{tmp_path}/{place}  E")
    assert len(lines) == 3 and all(lines)


def test_files_that_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for place, said in (
        (tmp_path / "gone.csv", "gone.csv  E001 no such file\n  no file has this name\n  check its folder"),
        (tmp_path, "E002 a folder, not a file\n  a recording is one file\n  name a .csv file"),
        ("a\0b.csv", "E003 unreadable file\n  the system says: embedded null byte\n  check that"),
    ):
        with pytest.raises(ValueError, match=said):
            from_csv(place)
    path = written(tmp_path, DIP)
    monkeypatch.setattr("thermicon.icons.recordings.recorded.MOST_ROWS", 4)
    with pytest.raises(ValueError, match="E004 file too large\n  more than 4 rows\n  split the file, or keep every"):
        from_csv(path)

    def refuse(*_: object, **__: object) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(ValueError, match="E003 unreadable file\n  the system says: Permission denied"):
        from_csv(path)
    monkeypatch.setattr("thermicon.icons.recordings.recorded.MOST_MB", 1e-5)
    with pytest.raises(ValueError, match="E004 file too large"):
        from_csv(path)


def test_a_recording_that_is_noisier_than_the_tolerance(tmp_path: Path) -> None:
    time = np.arange(20_000) / 1000
    path = written(tmp_path, table(time, 32 + np.random.default_rng(0).normal(0, 0.05, len(time))))
    with pytest.raises(ValueError, match=r"E220(?s:.)* 500 corners.* scatter by about 0.05 .*a tolerance of 0.3\n"):
        from_csv(path)
    assert isinstance(from_csv(path, tolerance_K=0.3), Icon)


@pytest.mark.parametrize(("message", "given"), MESSAGES["argument"].items())
def test_arguments_that_cannot_be(tmp_path: Path, message: str, given: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=message):
        from_csv(written(tmp_path, DIP), **given)

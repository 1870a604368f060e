"""Recordings in CSV files as icons: how they read, in which shapes tables come, and every message about them."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from thermicon.icons import Icon, parse
from thermicon.icons.model.shapes import Step
from thermicon.icons.model.statements import Hold, Ramp, Rest, Return
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


DIP = "time_s,display_C\n0,32\n1,32\n3,26\n7,26\n9,32\n"
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
    assert np.abs(icon.corners().at(time) - value).max() <= 0.05


@pytest.mark.parametrize(
    "text",
    [
        DIP,
        DIP.replace("\n", "\r\n"),
        "\ufeff" + DIP,
        DIP.replace(",", ";"),
        DIP.replace(",", "\t"),
        DIP.replace(",", ";").replace("26", "26,00").replace("32", "+3,2e1"),
        "sep=;\n" + DIP.replace(",", ";"),
        "# bench 2\n\n" + DIP.replace("1,32\n", "\n# still\n 1 , 32.0 \n"),
        "Time_s,time_s,display_C,note\n9,0,32,a\n9,1,32,\n9,3,26\n9,7,26,,\n9,9,32,b\n",
        '"time_s","display_C"\n"0","32"\n"1","32"\n"3","26"\n"7","26"\n"9","32"\n',
        DIP.replace("\n0,", "\n1700000000.1,")
        .replace("\n1,", "\n1700000001.1,")
        .replace("\n3,", "\n1700000003.1,")
        .replace("\n7,", "\n1700000007.1,")
        .replace("\n9,", "\n1700000009.1,"),
    ],
)
def test_tables_as_programs_write_them(tmp_path: Path, text: str) -> None:
    icon = from_csv(written(tmp_path, text))
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
    assert (icon.name, icon.context.control, icon.statements) == (
        "fall",
        "skin",
        (Ramp("cool", to_C=31, duration_s=1),),
    )


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


ROWS = "0,32\n1,31\n"


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        (
            "",
            "rec.csv",
            "E005 empty file\n  nothing but white space\n  the first line is such as: time_s,temperature_C",
        ),
        (" \n\n", "rec.csv", "E005"),
        ("# only\n# remarks\n", "rec.csv", "E013 not a recording\n  no line names the columns"),
        (
            b"PK\x03\x04\x00",
            "rec.csv",
            "E006 binary file\n  this is .*\n  a recording is a table, saved as CSV in UTF-8",
        ),
        (
            b"time_s\0",
            "rec.csv",
            "E006 binary file\n  a zero byte at byte offset 6\n  a recording is a table,",
        ),
        (DIP.encode("utf-16"), "rec.csv", "E006"),
        (
            b"time_s,display_C\n0,32 \xb0C\n",
            "rec.csv",
            "E007 not UTF-8\n  byte 0xB0 at byte offset 22, on line 2, is not UTF-8\n  save",
        ),
        ("time_s,display_C\n", "rec.csv", "E013 not a recording\n  no rows below the names of the columns\n  at least"),
        ("time_s,display_C\n0,32\n", "rec.csv", "  1 row below the names of the columns\n"),
        (
            f"time_ms,display_C\n{ROWS}",
            "rec.csv:1",
            "E013 not a recording\n  the column time_s is missing; the columns are time_ms, display_C\n"
            "  is it 'time_ms'\\? Its name must say that it is in seconds: time_s",
        ),
        (f"t,display_C\n{ROWS}", "rec.csv:1", "is it 't'\\?"),
        (f"clock,display_C\n{ROWS}", "rec.csv:1", "the time in s has the name time_s"),
        (ROWS, "rec.csv:1", "this line holds numbers, not the names of columns\n  put time_s,temperature_C above it"),
        (
            f"time_s,temp_C\n{ROWS}",
            "rec.csv:1",
            "no column is called temperature_C, target_C, setpoint_C, display_C or skin_C; the columns are time_s, "
            "temp_C\n  rename 'temp_C' to temperature_C if it is in °C, or say which is meant: --column temp_C",
        ),
        ("time_s,x1,x2,x3,x4,x5,x6,x7,x8\n", "rec.csv:1", "x7, …\n  say which is meant: --column x1"),
        ("time_s\n0\n", "rec.csv:1", "the columns are time_s\n  say which is meant: --column name"),
        (
            "time_s,target_C,display_C,skin_C\n",
            "rec.csv:1",
            "target_C, display_C and skin_C are all temperatures\n  say which: --column target_C",
        ),
        ("time_s,skin_C,time_s\n", "rec.csv:1", "the column time_s appears twice\n  rename or remove one of them"),
        ("time_s,skin_C\n0,00,32,5\n", "rec.csv:2", "4 cells, where the first line names 2\n  write decimal points"),
        (
            "time_s,skin_C\n0,32\n1\n",
            "rec.csv:3",
            "E014 not a reading\n  skin_C is empty\n  fill it in, or remove the row",
        ),
        ("time_s,skin_C\n0,32\n,31\n", "rec.csv:3", "time_s is empty"),
        ("time_s,skin_C\n0,32\n1,NaN\n", "rec.csv:3", "skin_C is 'NaN', not a finite number\n  fill it in"),
        ("time_s,skin_C\n0,32\n1,1_0\n", "rec.csv:3", "skin_C is '1_0', not a finite number"),
        ("time_s;skin_C\n0;32\n1;1.031,5\n", "rec.csv:3", "skin_C is '1.031,5', not"),
        ("time_s,skin_C\ns,°C\n0,32\n", "rec.csv:2", "time_s is 's', not a finite number\n  units belong in the names"),
        ('time_s,skin_C\n0,"' + "3" * 140_000, "rec.csv:2", "this row cannot be read \\(field larger than field limit"),
        ("time_s,skin_C\n0,32\n2,31\n\n1,30\n", "rec.csv:5", "E015 times out of order\n  time_s is 1 s, after 2 s in"),
        ("time_s,skin_C\n0,32\n1,31\n1,30\n1,29\n", "rec.csv:5", "time_s is 1 s for the third time\n  two readings at"),
        ("time_s,skin_C\n5,32\n5,31\n", "rec.csv", "all readings are at 5 s\n  a recording lasts some time"),
        (
            "time_s,skin_C\n0,32\n8000,31\n",
            "rec.csv",
            "E221 too long\n  time_s runs over 8,000 s\n  an icon lasts at most 3600 s; divide by 1000",
        ),
        (
            "time_s,skin_C\n0,305.2\n1,304\n",
            "rec.csv:2",
            "E219 level out of range\n  skin_C is 305.2; an icon keeps to −10 to 60 °C\n  these look like kelvin",
        ),
        ("time_s,skin_C\n0,89.6\n1,88\n", "rec.csv:2", "these look like °F: convert the column to °C"),
        ("time_s,skin_C\n0,32\n1,85\n2,31\n", "rec.csv:3", "skin_C is 85; an .*\n  correct or remove the reading"),
        (
            "time_s,skin_C\n0,-127\n1,-127\n",
            "rec.csv:2",
            "skin_C is −127; .*\n  check the unit: the column must be in °C",
        ),
    ],
)
def test_every_message_about_a_file_is_read(tmp_path: Path, text: str | bytes, place: str, message: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ValueError, match=message) as found:
        from_csv(path)
    lines = str(found.value).split("\n")
    assert lines[0].startswith(f"{tmp_path}/{place}  E")
    assert len(lines) == 3 and all(lines)


def test_files_that_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"gone.csv  E001 no such file\n  no file has this name\n  check its folder"):
        from_csv(tmp_path / "gone.csv")
    with pytest.raises(ValueError, match=r"E002 a folder, not a file\n  a recording is one file\n  name a .csv file"):
        from_csv(tmp_path)
    with pytest.raises(ValueError, match=r"E003 unreadable file\n  the system says: embedded null byte\n  check that"):
        from_csv("a\0b.csv")
    path = written(tmp_path, DIP)

    def refuse(*_: object, **__: object) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(ValueError, match="E003 unreadable file\n  the system says: Permission denied"):
        from_csv(path)
    monkeypatch.setattr("thermicon.icons.recordings.readings.MOST_MB", 1e-5)
    with pytest.raises(ValueError, match="E004 file too large"):
        from_csv(path)


def test_a_file_of_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermicon.icons.recordings.readings.MOST_ROWS", 4)
    with pytest.raises(ValueError, match="E004 file too large\n  more than 4 rows\n  keep every tenth row"):
        from_csv(written(tmp_path, DIP))


def test_a_column_that_is_not_there(tmp_path: Path) -> None:
    path = written(tmp_path, DIP)
    with pytest.raises(
        ValueError, match=r"rec.csv:1  E013 .*\n.*no temperature is called 'displai_C'.*\n.*display_C\?"
    ):
        from_csv(path, column="displai_C")
    with pytest.raises(
        ValueError, match=r"no temperature is called 'time_s'.*\n  the name must be spelled as in the file"
    ):
        from_csv(path, column="time_s")


def test_a_baseline_away_from_the_beginning(tmp_path: Path) -> None:
    message = (
        r"rec.csv:2  E016 begins away from baseline\n  the recording begins at 32 °C, baseline_C is 31 °C\n"
        r"  an icon begins at baseline, here within 0.05 K; leave baseline_C out, or cut the file"
    )
    with pytest.raises(ValueError, match=message):
        from_csv(written(tmp_path, DIP), baseline_C=31)


def test_a_recording_that_is_noisier_than_the_tolerance(tmp_path: Path) -> None:
    time = np.arange(20_000) / 1000
    path = written(tmp_path, table(time, 32 + np.random.default_rng(0).normal(0, 0.05, len(time))))
    message = (
        r"E220 too many corners\n  500 corners are not enough to stay within 0.05 of every reading; the readings "
        r"scatter by about 0.05 \(standard deviation\), so try a tolerance of 0.3\n  "
        r"give a larger tolerance \(--tolerance, in Python tolerance_K\)"
    )
    with pytest.raises(ValueError, match=message):
        from_csv(path)
    assert isinstance(from_csv(path, tolerance_K=0.3), Icon)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"tolerance_K": 0},
            r"tolerance_K \(--tolerance\) must be a positive temperature difference in K, such as 0.05, not 0",
        ),
        ({"tolerance_K": -0.1}, "not -0.1"),
        ({"tolerance_K": math.nan}, "not nan"),
        ({"tolerance_K": True}, "not True"),
        ({"tolerance_K": "0.1"}, "not '0.1'"),
        ({"control": "current"}, 'control must be "display" or "skin" for a recorded temperature, not \'current\''),
        ({"name": "3 dips"}, "name: '3 dips' is not a name"),
        ({"baseline_C": 305.0}, "baseline_C: 305 °C is outside the −10 to 60 °C"),
    ],
)
def test_arguments_that_cannot_be(tmp_path: Path, more: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        from_csv(written(tmp_path, DIP), **more)  # type: ignore[arg-type]

"""Tables of all instruments: equal numbers in every command, or a cure that works."""

import random
import re
import warnings
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import read_drive
from thermicon.circuit.fitting.log import read_log
from thermicon.icons.recordings.recorded import read_readings
from thermicon.notebooks.files.trace_files import read_curves
from thermicon.notebooks.messages import is_ours

TIME = np.arange(60) / 10
CURRENT = np.round(0.1 + 0.4 * np.clip(TIME - 1, 0, 2) / 2, 4)
DISPLAY = np.round(32 - 4 * np.clip(TIME - 1, 0, 3) / 3, 2)
OURS = ("time_s", "current_A", "display_C")
BEGIN = datetime(2026, 3, 2, 23, 59, 58)
PAGE = "-" * 80


def clock(form: str, cut: int = 0) -> Callable[[float], str]:
    """Times of a clock from two seconds before midnight on, the last digits cut off."""
    return lambda t: (f"{BEGIN + timedelta(seconds=t):{form}}")[: -cut or None]


def number(factor: float = 1.0, plus: float = 0.0, form: str = ".6g") -> Callable[[float], str]:
    return lambda value: f"{value * factor + plus:{form}}"


PLAIN = number()


def written(
    names: tuple[str, ...] = OURS, time: Callable[[float], str] = PLAIN, current: Callable[[float], str] = PLAIN,
    display: Callable[[float], str] = PLAIN, *, mark: str = ",", above: str = "", below: str = "", units: str = "",
    comma: bool = False, code: str = "utf-8", end: str = "\n", more: Callable[[int, list[str]],
        list[str]] | None = None,
    change: tuple[str, str] = ("", ""),
) -> bytes:  # fmt: skip
    """A table of the three columns in a form; ``more`` changes the cells of a row, ``change`` the text (a pattern)."""
    rows = [[time(t), current(a), display(c)] for t, a, c in zip(TIME, CURRENT, DISPLAY, strict=True)]
    rows = [more(at, row) if more else row for at, row in enumerate(rows)]
    lines = [mark.join(cell.replace(".", ",") if comma else cell for cell in row) for row in rows]
    text = above + "\n".join([mark.join(names), *([units] if units else []), *lines]) + "\n" + below
    return re.sub(*change, text).replace("\n", end).encode(code) if change[0] else text.replace("\n", end).encode(code)


def numbered(at: int, row: list[str]) -> list[str]:
    return [str(at), *row]


def printed() -> bytes:
    head = f"* dip\nTransient Analysis\n{PAGE}\nIndex   time            i(vsense)       v(display_c)\n{PAGE}\n"
    rows = [
        f"{at}\t{t:.6e}\t{a:.6e}\t{c:.6e}\t\n" for at, (t, a, c) in enumerate(zip(TIME, CURRENT, DISPLAY, strict=True))
    ]
    return (head + "".join(rows[:40]) + "\x0c\n" + head + "".join(rows[40:])).encode()


def tdms(waveform: bool = True) -> bytes:
    import io

    from nptdms import ChannelObject, RootObject, TdmsWriter

    stream, clocked = io.BytesIO(), {"wf_increment": 0.1, "wf_start_offset": 0.0} if waveform else {}
    columns = {**({} if waveform else {"time_s": TIME}), "current_A": CURRENT, "display_C": DISPLAY}
    with TdmsWriter(stream) as writer:
        writer.write_segment([RootObject(), *(ChannelObject("log", *each, clocked) for each in columns.items())])
    return stream.getvalue()


ISO, GERMAN, AMERICAN = "%Y-%m-%d %H:%M:%S.%f", "%d.%m.%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p"
LVM = (
    "LabVIEW Measurement\t\nSeparator\tTab\nDate\t2026/03/02\nTime\t23:59:58\n***End_of_Header***\t\n\t\n"
    "Channels\t2\t\nTime\t23:59:58.0\t23:59:58.0\nX_Dimension\tTime\tTime\nX0\t0\t0\n***End_of_Header***\t\n"
)
FORMS: dict[str, bytes] = {
    "thermicon": written(),
    "pandas with an index": written(("", *OURS), more=numbered),
    "numpy.savetxt": written(("# time_s", *OURS[1:]), mark=" "),
    "R write.table": written(tuple(f'"{name}"' for name in OURS), mark=" "),
    "R write.table, row names": written(tuple(f'"{name}"' for name in OURS), mark=" ",
        more=lambda at, row: [f'"{at + 1}"', *row]),
    "R write.csv2": written(tuple(f'"{name}"' for name in OURS), mark=";", comma=True),
    "MATLAB writetable": written(("Time_s", "Current_A", "Display_C")),
    "Excel, English": written(("Time (s)", "Current (A)", "Display (°C)"), code="utf-8-sig", end="\r\n"),
    "Excel, German": written(("Zeit (s)", "Strom (A)", "Display (°C)"), mark=";", comma=True, code="cp1252",
        end="\r\n"),
    "Excel, French": written(("Temps (s)", "Courant (A)", "Display (°C)"), mark=";", comma=True, code="cp1252"),
    "Excel, Unicode text": written(("time [s]", "current [A]", "display [°C]"), mark="\t", code="utf-16", end="\r\n"),
    "Excel, mm:ss.0": written(time=clock("%M:%S.%f", 5), above="\n\n"),
    "Excel, sep=": written(above="sep=;\n", mark=";"),
    "Excel on a Mac": written(end="\r"),
    "LibreOffice": written(("Time/s", "Current/A", "Display/°C"), mark="\t", comma=True),
    "Excel, names on two lines": written(('"Time\n(s)"', '"Current\n(A)"', '"Display\n(°C)"')),
    "Excel for DOS": written(("Zeit in s", "Strom in A", "Display in °C"), mark=";", comma=True, code="cp850"),
    "Google Sheets, German": written(comma=True, mark='","', change=(r"(?m)^|$", '"'), end="\r\n"),
    "Markdown": written(("| time_s", *OURS[1:], "|"), mark="|", more=lambda at, row: [f"| {row[0]}", *row[1:], "|"]),
    "JavaScript": written(("timeMs", "currentMa", "displayTempC"), number(1000), number(1000)),
    "Google Sheets": written(('"Time, s"', '"Current, A"', '"Display, °C"')),
    "PowerShell": written(tuple(f'"{name}"' for name in OURS), code="utf-16", end="\r\n"),
    "Arduino serial plotter": written(("t_ms", "I_mA", "T_display_C"), number(1000, form=".0f"), number(1000),
        above="TEC loop ready\n"),
    "PuTTY log": written(above="=~=~=~= PuTTY log 2026.03.02 23:59:58 =~=~=~=\nTEC loop v2 ready\nkp=1.5, ki=0.4\n"),
    "CoolTerm with stamps": written(("Timestamp", *OURS[1:]), clock(ISO, 3)),
    "HOBOware": written(('"#"', '"Date Time, GMT+00:00"', '"Current, A"', '"Display, °C"'), clock(AMERICAN),
        more=numbered,
                        above='"Plot Title: dip"\n', code="utf-8-sig"),
    "Lascar EasyLog": written(("Display", "Time", "current_A", "display(°C)"), clock("%d/%m/%Y %H:%M:%S.%f"),
        more=numbered),
    "PicoLog": written(("Time (ms)", "Current (mA)", "Display (C)"), number(1000), number(1000)),
    "PicoScope": written(("Time", "Current", "Display"), number(1000), number(1000), units="(ms),(mA),(°C)\n"),
    "PicoLog 6": written(("", "Current Ave. (A)", "Display Last (C)"), clock("%Y-%m-%dT%H:%M:%S.%f+00:00")),
    "TC-08": written(("Time", "Current", "Display"), units="s,A,°C"),
    "LabVIEW LVM": written(("X_Value", *OURS[1:], "Comment"), mark="\t", above=LVM),
    "LabVIEW LVM, times of each": written(("X_Value", "current_A", "X_Value", "display_C"), mark="\t", above=LVM,
        more=lambda at, row: [*row[:2], row[0], row[2]]),
    "TDMS waveform": tdms(),
    "TDMS with times": tdms(waveform=False),
    "Keysight BenchVue": written(("Scan", "Time", "Current (A)", "Display (C)"), clock("%m/%d/%Y %H:%M:%S:%f", 3),
        more=numbered,
                                 above="Instrument,34970A\nStart Time,3/2/2026\n", code="utf-16"),
    "Keysight overload": written(more=lambda at, row: [*row[:2], "9.90000000E+37"] if at == 30 else row),
    "Keithley KickStart": written(("Reading", "Relative Time", "current_A", "display_C"), more=numbered,
        above="Model,2450\n\n"),
    "Fluke": written(("Sample", "Time", *OURS[1:]), clock("%I:%M:%S.%f %p"), more=numbered),
    "Yokogawa": written(("Date Time", *OURS[1:]), clock("%Y/%m/%d %H:%M:%S.%f"), above="#Model,GP10\n"),
    "Campbell TOA5": written(("TIMESTAMP", *OURS[1:]), clock(ISO, 4), units="TS,Amp,Deg C",
                             above='"TOA5","CR1000","dip"\n'),
    "Meerstetter": written(("Time (s)", "Actual Output Current (A)", "Display Temperature (°C)"), mark=";"),
    "whole seconds, from the midst of one": written(("Time", *OURS[1:]), lambda t: clock("%H:%M:%S")(t + 0.7)),
    "TCS in tenths, named": written(("time_ms", "current_A", "display_m°C"), number(1000), display=number(1000)),
    "1-wire": written(more=lambda at, row: [*row[:2], {10: "85", 30: "-127"}.get(at, row[2])]),
    "MAX31865": written(more=lambda at, row: [*row[:2], "-242.02" if at in (20, 21) else row[2]]),
    "kelvin": written(("time_s", "current_A", "display_K"), display=number(1, 273.15)),
    "Fahrenheit": written(("Time (sec)", "current_A", "Display (°F)"), display=number(1.8, 32, ".8g")),
    "ROS bag": written(("Time", *OURS[1:]), number(1, 1772495998, ".11g")),
    "InfluxDB": written(("time", *OURS[1:]), clock("%Y-%m-%dT%H:%M:%S.%fZ")),
    "nanoseconds": written(("time_ns", *OURS[1:]), number(1e9, 0, ".0f")),
    "syslog month": written(("Time", *OURS[1:]), clock("%d-%b-%Y %H:%M:%S.%f")),
    "German clock": written(("Zeit", *OURS[1:]), clock(GERMAN), mark=";", comma=False),
    "minutes": written(("time_min", *OURS[1:]), number(1 / 60, form=".8f")),
    "true minus": written(more=lambda at, row: [*row, "−1"], names=(*OURS, "note")),
    "a row twice": written(change=(r"(\n2,[^\n]*)", r"\1\1")),
    "names again": written(change=(r"\n3,", "\ntime_s,current_A,display_C\n3,")),
    "ngspice print": printed(),
    "ngspice wrdata": written((" time", "i(vsense)", "v(display_C)"), mark="  ", below="\n"),
    "days of a spreadsheet": written(time=number(1 / 86400, 46083, ".14g")),
    "units in cells": written(display=lambda value: f"{value:g} °C"),
    "footer of a logger": written(("Time", *OURS[1:]), clock("%H:%M:%S.%f"), below="Minimum,,28\n"),
    "end of a log": written(below="End of data\n"),
    "LTspice": written(("time", "I(Vsense)", "V(display_c)"), number(1, 0, ".15e"), mark="\t", end="\r\n"),
}  # fmt: skip
Read = Callable[[Path, dict[str, str]], dict[str, Any]]


def curves(path: Path, theirs: dict[str, str]) -> dict[str, Any]:
    found = read_curves(str(path), theirs=theirs)
    [warnings.warn(note, stacklevel=1) for note in found.notes]
    return {"time_s": found.time_s, **found.columns}


def drive(path: Path, theirs: dict[str, str]) -> dict[str, Any]:
    found = read_drive(path, columns=theirs)
    return {"time_s": found.time_s, "current_A": found.current_A}


def recording(path: Path, theirs: dict[str, str]) -> dict[str, Any]:
    found = read_readings(path, columns=theirs)
    [warnings.warn(note, stacklevel=1) for note in found.notes]
    return {"time_s": np.array(found.time_s), "display_C": np.array(found.level_C)}


def log(path: Path, theirs: dict[str, str]) -> dict[str, Any]:
    found = read_log(path, theirs)
    [warnings.warn(note, stacklevel=1) for note in found.notes]
    return {"time_s": found.time_s, **dict(found.columns)}


DOORS: dict[str, Read] = {"fit": log, "compare": curves, "simulate": drive, "convert": recording}


def right(found: dict[str, Any]) -> bool:
    """Whether a table has the numbers that were written, but for gaps."""
    time, ours = np.asarray(found["time_s"]) - found["time_s"][0], {"current_A": CURRENT, "display_C": DISPLAY}
    errors = [np.nanmax(np.abs(np.interp(time, TIME, ours[name]) - found[name])) for name in ours if name in found]
    return bool(errors) and max(errors) < 2e-3 and abs(time[-1] - 5.9) < 2e-3 and 57 <= len(time) <= 60


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_read_to_the_same_numbers_at_every_door(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.csv").write_bytes(FORMS[name])
    for door in DOORS.values():
        assert right(door(tmp_path / "a.csv", {}))


PAGE_ROWS = re.findall(
    r"(?m)^\| (?!written)(.+) \| `(.+)` \|$",
    (Path(__file__).parents[3] / "docs" / "reference" / "tables.md").read_text("utf-8"),
)


@pytest.mark.parametrize(("form", "example"), PAGE_ROWS, ids=[form for form, _ in PAGE_ROWS])
def test_an_example_of_the_page_is_read(tmp_path: Path, form: str, example: str) -> None:
    (tmp_path / "a.csv").write_text(example.replace(" ⏎ ", "\n").replace("→", "\t"), "utf-8")
    found = read_curves(str(tmp_path / "a.csv"))
    assert np.ptp(found.time_s) == pytest.approx(0.1, abs=1e-6), form
    assert found.columns["display_C"] == pytest.approx([32.0, 31.9])


WARMER = written(display=number(1, 0.01)).decode().split("\n")[1:]
HEAD, *ROWS = written().decode().strip().split("\n")
REFUSED: dict[str, tuple[str | bytes, str]] = {
    "no names": ("\n".join(ROWS), "no line names the 3 columns.*time_s.: .1."),
    "no names, spaces": ("\n".join(ROWS).replace(",", " "), "no line names the 3 columns"),
    "unknown names": ("\n".join(["clock,x1,x2", *ROWS]), "columns="),
    "no unit": ("\n".join(["time_s,Current,display_C", *ROWS]), "columns=..current_A.: .Current."),
    "milliseconds": (written(time=number(1000)), "milliseconds[;,] .*divide the column by 1000"),
    "epoch in ms": (written(time=number(1000, 1772495998000, ".13g")), "milliseconds[;,] .*by 1000"),
    "microseconds": (written(time=number(1e6, 0, ".0f")), "by 1,000,000"),
    "tenths": (written(display=number(10)), "tenths of °C .*divide by 10"),
    "thousandths": (written(display=number(1000)), "thousandths of °C .*by 1000"),
    "kelvin": (written(display=number(1, 273.15)), "kelvin .*subtract 273.15"),
    "°F": (written(display=number(1.8, 32, ".8g")), "°F .*subtract 32 and divide by 1.8"),
    "mA": (written(current=number(1000)), "milliamperes; divide it by 1000"),
    "one wild current": (written(change=(r"\n2,0.3", "\n2,3e9")), "is 3e.09 A in 1 of 60 rows; .*leave them empty"),
    "three wild currents": (written(change=(r"\n(2|3|4),0.\d", r"\n\1,3e9")), "in 3 of 60 rows; .*leave them empty"),
    "open thermocouple": (written(change=(r"\n2,[^\n]*", "\n2,0.3,OL")), "or remove the row"),
    "two rows without a reading": (written(change=(r"\n([23]),([^,]*),[^\n]*", r"\n\1,\2,OL")), "likewise in line 32"),
    "other units in two cells": (written(time="{:g} s".format, change=(r"\n([23]) s", r"\n\1 min")), "remove the row"),
    "whole minutes": (written(("Time", *OURS[1:]), clock("%d/%m/%Y %H:%M")), "tell 60 rows apart;? .*more decimals"),
    "no times": (written(time=lambda _: ""), "empty in every row;? +add the times"),
    "web page": (b"<html><table><tr><td>time_s</td></tr></table>", "HTML.*as CSV"),
    "backward": ("\n".join([HEAD, *ROWS[::-1]]), "run backward: sort them"),
    "mixed": ("\n".join([HEAD, *random.Random(1).sample(ROWS, 60)]), "are mixed: sort them"),
    "out of place": (written(change=(r"\n2,", "\n0.2,")), "this row is out of place: remove it"),
    "restarted": ("\n".join([HEAD, *ROWS, *WARMER]), "each recording its own file"),
    "decimal commas": (written(comma=True), "put semicolons"),
    "thousands": (written(("time_ns", *OURS[1:]), number(1e9, 0, ".0f"), mark=";", change=(r"\n5(0{9});",
        "\n5.000.000.000;")), "marks between thousands"),
    "workbook": (b"PK\3\4....xl/workbook.xml", "Excel.*save the sheet as CSV"),
    "ODS": (b"PK\3\4mimetypeapplication/vnd.oasis.opendocument.spreadsheet", "LibreOffice.*as CSV"),
    "gzip": (b"\x1f\x8b....", "gzip.*unpack it"),
    "binary raw": (b"Title: * dip\nVariables:\nBinary:\n\0\0", "by wrdata in ngspice"),
}  # fmt: skip


def outcome(door: Read, path: Path, theirs: dict[str, str]) -> tuple[bool, str]:
    """Whether the numbers are right, and all that was said."""
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always")
        try:
            found = door(path, theirs)
        except Exception as error:
            assert is_ours(error), error
            return False, " ".join(str(error).split())
    return right(found), " ".join(str(warning.message) for warning in raised)


@pytest.mark.parametrize("door", DOORS)
def test_a_column_of_another_unit_is_not_taken_and_a_cure_names_none(tmp_path: Path, door: str) -> None:
    (tmp_path / "a.csv").write_bytes(written(("time_s", "Probe 1 (A)", "Probe 2 (°C)")))
    name, theirs, other = ("current_A", "Probe 1 (A)", "Probe 2 (°C)") if door == "simulate" else (
        "display_C", "Probe 2 (°C)", "Probe 1 (A)")  # fmt: skip
    good, told = outcome(DOORS[door], tmp_path / "a.csv", {name: other})
    assert not good and f"{other!r} is in another unit" in told
    good, told = outcome(DOORS[door], tmp_path / "a.csv", {})
    assert good and f"{theirs!r} is taken as " in told
    assert outcome(DOORS[door], tmp_path / "a.csv", {name: theirs})[0]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_units_in_a_line_of_their_own_do_not_hide_what_a_column_is_called(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(written(("Time", "Ch1", "Ch2"), number(1000), units="ms,A,°C"))
    assert right(log(tmp_path / "a.csv", {"current_A": "Ch1", "display_C": "Ch2"}))

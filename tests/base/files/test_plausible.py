"""Numbers that cannot be what their names say: what is just possible is taken, what is just not is asked for."""

import numpy as np
import pytest

from thermicon.base.files.layout import is_clock, layout_of
from thermicon.base.files.measured_table import measured
from thermicon.base.files.table import Table, read_table
from thermicon.base.files.units import is_days, too_fast, unit_fault

NAMES = ("time_s", "current_A", "display_C")


def table(text: str) -> Table:
    return read_table(text.encode(), lambda *about: ValueError(about), "time_s,display_C", 100, NAMES)  # type: ignore[arg-type, return-value]


def rows(*names: str, count: int = 30, row: str = "{t:g},{c:g}") -> str:
    return "\n".join([",".join(names), *(row.format(t=k / 10, c=32 - k / 10) for k in range(count))]) + "\n"


@pytest.mark.parametrize(("rate", "refused"), [(19.0, None), (21.0, False), (490.0, False), (510.0, True)])
def test_a_course_that_is_faster_than_displays_is_doubted_and_then_refused(rate: float, refused: bool | None) -> None:
    levels = np.array([30.0, 31.0, 32.0, 33.0, 34.0])
    time = np.linspace(0.0, 4.0 / rate, 5)
    found = too_fast("display_C", time, levels, 1e-3)
    assert (None if found is None else found[0]) is refused
    assert too_fast("display_C", time * np.array([1, 1, 1, 1, 2 * rate]), levels, 1.0) is None


@pytest.mark.parametrize(
    ("count", "said"), [(434.0, "counts"), (434.5, "sensor"), (1020.0, "sensor"), (320.0, "tenths")]
)
def test_counts_of_a_converter_are_whole_and_stand_for_skin(count: float, said: str) -> None:
    found = unit_fault("display_C", np.array([count, count, count + 2, count]))
    assert found is not None and said in found[0]
    assert ("divide by 10" in found[1]) == (said == "tenths")


def test_ohms_of_a_thermistor_are_named_as_ohms() -> None:
    found = unit_fault("display_C", np.array([7400.2, 7500.4, 8000.0]))
    assert found is not None and "ohms of a thermistor" in found[0]


@pytest.mark.parametrize("begin", [30_001.0, 46_083.9, 59_999.0, 740_044.9])
def test_days_of_spreadsheets_are_short_and_of_today(begin: float) -> None:
    assert is_days(begin + np.array([0.0, 1e-5, 0.49]))
    assert not is_days(begin + np.array([0.0, 1e-5, 0.51]))
    assert not is_days(29_999.0 + np.array([0.0, 1e-5]))


@pytest.mark.parametrize("name", ["Room (°C)", "Set T (°C)", "Sollwert [°C]", "target_2_C"])
def test_a_temperature_of_the_room_or_of_a_command_is_not_taken_for_a_reading(name: str) -> None:
    assert "display_C" not in table(rows("time_s", name)).header
    both = table(rows("time_s", name, "Pad (°C)", row="{t:g},24,{c:g}"))
    assert both.names.renamed["display_C"][0] == "Pad (°C)"


def test_channels_that_are_lettered_have_no_units_in_their_letters() -> None:
    found = table(rows("time_s", "Ch A", "Ch B", "Ch C", row="{t:g},1,2,{c:g}"))
    assert not found.names.renamed


def test_a_position_is_a_name_unless_a_column_is_called_so() -> None:
    fault = lambda *about: ValueError(about)  # noqa: E731
    theirs = {"time_s": "1", "display_C": "2"}
    plain = read_table(b"0,32\n1,31\n2,30\n", fault, "", 9, NAMES, theirs)  # type: ignore[arg-type]
    assert plain.numbers("display_C", "").tolist() == [32, 31, 30]
    called = read_table(b"time_s,1\n0,32\n1,31\n", fault, "", 9, NAMES, {"display_C": "1"})  # type: ignore[arg-type]
    assert called.numbers("display_C", "").tolist() == [32, 31]


def test_rows_that_are_left_out_are_counted_and_quoted() -> None:
    found = table(rows("time_s", "display_C") + "Mean,30\nEnd of log\n")
    assert len(found.rows) == 30
    assert any("left out: 2 ('Mean,30', 'End of log')" in note for note in found.notes)


@pytest.mark.parametrize("cell", ["9:41", "09:41:07.5", "27.11.2026 09:41", "2026-11-27T09:41:07Z", "9:41:07 PM"])
def test_a_clock_is_known_in_any_form_and_a_long_cell_is_none(cell: str) -> None:
    assert is_clock(cell) and not is_clock(f"{'x ' * 30}{cell}") and not is_clock(f"at:{cell}m")


def test_a_preamble_longer_than_the_table_does_not_hide_it() -> None:
    text = "".join(f"Channel {k},type K,range {k}\n" for k in range(40)) + rows("Time (s)", "Plate (°C)", count=5)
    found = layout_of(text, NAMES, {})
    assert (found.names, found.line, found.start) == (["Time (s)", "Plate (°C)"], 41, 41)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\x89HDF\r\n\x1a\n\0", "HDF5"),
        (b"XDF:\0", "Lab Streaming Layer"),
        (b"PK\3\4\0\0\0arr_0.npy\0", "an array of numpy"),
        (b"PK\3\4\0\0\0xl/workbook.xml\0", "a workbook of Excel"),
    ],
)
def test_other_containers_are_named_with_how_to_save_a_table(data: bytes, words: str) -> None:
    with pytest.raises(ValueError, match=f"{words}.*CSV"):
        read_table(data, lambda *about: ValueError(about), "", 9, NAMES)  # type: ignore[arg-type, return-value]


def test_the_hour_that_comes_twice_is_read_on_and_another_fall_is_not() -> None:
    stamps = ["2026-10-25 02:59:58", "2026-10-25 02:59:59", "2026-10-25 02:00:00", "2026-10-25 02:00:01"]
    text = "time,display_C\n" + "".join(f"{stamp},{32 - k}\n" for k, stamp in enumerate(stamps))
    found = measured(table(text), ["display_C"], "")
    assert found.time_s.tolist() == [0, 1, 2, 3] and any("back by an hour" in note for note in found.notes)
    with pytest.raises(ValueError, match="times must increase"):
        measured(table(text.replace("02:00:0", "02:20:0")), ["display_C"], "")

"""The text of a table in the bytes of a file, in whatever form loggers, spreadsheets and SPICE programs write it."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .table import Fault

TABLES = (
    ".csv",
    ".tsv",
    ".txt",
    ".dat",
    ".log",
    ".lvm",
    ".prn",
    ".raw",
    ".tdms",
    ".xlsx",
    ".xls",
    ".ods",
    ".zip",
    ".gz",
)
"""Endings of what may hold a table, or gets a sentence on how to make one of it."""

SHEET = "save the sheet as CSV, and give that file"
UNPACK = "unpack it, and give the table in it"
BINARY = {
    b"PK\3\4": ("a workbook, a document or a zip archive", f"{SHEET}; {UNPACK} if it is an archive"),
    b"\x1f\x8b": ("compressed by gzip", UNPACK),
    b"7z\xbc\xaf": ("a 7z archive", UNPACK),
    b"\xd0\xcf\x11\xe0": ("a workbook of an old Excel", SHEET),
    b"PAR1": ("a Parquet file", "save it as CSV, and give that file"),
    b"\x89HDF": ("an HDF5 file", "save its columns as CSV, and give that file"),
    b"MATLAB 5.0": ("a MAT-file of MATLAB", "save its columns with writetable as CSV, and give that file"),
    b"%PDF-": ("a PDF document", "copy its table into a text file, and give that"),
    b"\x89PNG": ("a picture (PNG)", "give the table of numbers that it was drawn from"),
    b"\xff\xd8\xff": ("a picture (JPEG)", "give the table of numbers that it was drawn from"),
}
"""How files that are no text begin, what they are, and what to do."""
ZIPPED = {
    b"xl/": ("a workbook of Excel", SHEET),
    b"opendocument.spreadsheet": ("a spreadsheet of LibreOffice", SHEET),
}
WIDE = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
AS_TEXT = "write it as text: set filetype=ascii in ngspice, or export it as text in LTspice"


def table_text(data: bytes, fault: Fault, example: str) -> str:
    """Return the text of a table, each line ended by a newline alone; raises a fault that says what else it is."""
    if not data.strip():
        raise fault("empty", None, "the file is empty", f"the first line is such as: {example}")
    for begin, (what, cure) in BINARY.items():
        if data.startswith(begin):
            what, cure = next(
                (said for mark, said in ZIPPED.items() if begin == b"PK\3\4" and mark in data), (what, cure)
            )
            raise fault("binary", None, f"this is {what}, not a table", cure)
    if data.startswith(b"TDSm"):
        return tdms_text(data, fault)
    text = _decoded(data, fault).replace("\r\n", "\n").replace("\r", "\n")
    if re.match(r"Title:.*\n", text) and "\nVariables:" in text[:100_000]:
        return _raw_text(text, fault)
    if re.search(r"(?m)^Index +time ", text[:10_000]):  # pages of ngspice's print
        return "\n".join(line if re.match(r"Index|\d", line) else "" for line in text.split("\n"))
    return text


def _decoded(data: bytes, fault: Fault) -> str:
    coding = next((name for mark, name in WIDE.items() if data.startswith(mark)), "")
    if not coding and data[1:400:2] and not any(data[1:400:2]):  # UTF-16 without its mark
        coding = "utf-16-le"
    if b"Binary:" in data[:200_000].replace(b"\0", b"") and b"Title:" in data[:20].replace(b"\0", b""):
        raise fault("binary", None, "this is a binary file of a SPICE program, not a table", AS_TEXT)
    if not coding and b"\0" in data:
        what = f"this is a binary file, not a table (a zero byte at byte offset {data.index(0)})"
        raise fault("binary", None, what, "save it as text (CSV in UTF-8)")
    for name in (coding,) if coding else ("utf-8", "cp1252"):
        try:
            return data.decode(name).removeprefix("\ufeff")
        except UnicodeDecodeError as problem:
            at = problem.start
    line = data.count(b"\n", 0, at) + 1
    what = f"byte 0x{data[at]:02X} at byte offset {at}, on line {line}, is not UTF-8 or Latin text"
    raise fault("coding", None, what, "save the file as UTF-8")


def _raw_text(text: str, fault: Fault) -> str:
    """The table in a raw file of SPICE in ASCII: names in its head, then the values of each point after its number."""
    head, _, values = text.partition("\nValues:")
    names = [line.split()[1] for line in head.partition("\nVariables:")[2].split("\n") if len(line.split()) > 2]
    cells = values.split()
    width = len(names) + 1
    if not names or not cells or len(cells) % width:
        raise fault("table", None, "this raw file of SPICE is cut off, or holds complex numbers", "run it to its end")
    rows = ["\t".join(cells[at + 1 : at + width]) for at in range(0, len(cells), width)]
    return "\n".join(["\t".join(names), *rows])


def tdms_text(data: bytes, fault: Fault) -> str:
    """The table in a TDMS file: its channels with numbers, and the time of their waveform where none is called so."""
    try:
        import numpy as np
        from nptdms import TdmsFile
    except ImportError:
        cure = 'pip install "thermicon[hardware]", or save it as CSV'
        raise fault("binary", None, "TDMS needs npTDMS, which is not installed", cure) from None
    columns: dict[str, Any]
    try:
        channels = [channel for group in TdmsFile.read(io.BytesIO(data)).groups() for channel in group.channels()]
        columns = {each.name: np.asarray(each[:]) for each in channels}
        clocks = {each.name: each.time_track() for each in channels if "wf_increment" in each.properties}
    except Exception as problem:  # npTDMS raises whatever a broken file leads it to
        why = str(problem) or type(problem).__name__
        raise fault("binary", None, f"cannot be read as TDMS ({why})", "save it anew, or as CSV") from None
    if not any(re.match(r"(?i)time", name) for name in columns):
        time = next(iter(clocks.values()), None)
        alike = time is not None and all(
            len(clock) == len(time) and np.allclose(clock, time, rtol=0, atol=1e-9) for clock in clocks.values()
        )
        if not alike or clocks.keys() != columns.keys():
            listed = ", ".join(f"{name} {len(column)} samples" for name, column in columns.items())
            what = f"channels have no clock or different ones ({listed or 'no channel'})"
            raise fault("table", None, what, "give them one wf_increment or a channel time_s; save others in own files")
        columns = {"time_s": time, **columns}
    if len({len(column) for column in columns.values()}) > 1:
        raise fault("table", None, "channels have different lengths", "save each length as a file of its own")
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return "\n".join(["\t".join(columns), *("\t".join(map(str, row)) for row in rows)])

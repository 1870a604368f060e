"""The text of a table in the bytes of a file, in whatever form loggers, spreadsheets and SPICE programs write it."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .table import Fault

TABLES = (".csv", ".tsv", ".txt", ".dat", ".log", ".lvm", ".prn", ".raw", ".tdms", ".xlsx", ".xls", ".ods", ".zip",
          ".gz")  # fmt: skip
"""Endings of what may hold a table, or gets a sentence on how to make one of it."""

SHEET, UNPACK = "save the sheet as CSV, and give that file", "unpack it, and give the table in it"
BINARY = (
    (b"PK\3\4", b"xl/", "a workbook of Excel", SHEET),
    (b"PK\3\4", b"opendocument.spreadsheet", "a spreadsheet of LibreOffice", SHEET),
    (b"PK\3\4", b"", "a zip archive", UNPACK),
    (b"\x1f\x8b", b"", "compressed by gzip", UNPACK),
    (b"\xd0\xcf\x11\xe0", b"", "a workbook of an old Excel", SHEET),
    (b"PAR1", b"", "a Parquet file", "save its columns as CSV"),
    (b"\x89HDF", b"", "an HDF5 file, such as a MAT-file", "save its columns as CSV"),
    (b"MATLAB 5.0", b"", "a MAT-file", "save its columns as CSV, by writetable"),
    (b"%PDF-", b"", "a PDF document", "save its table as CSV"),
)
"""How files that are no text begin and what is in them, what they are, and what to do."""
WIDE = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
AS_TEXT = "write it as text: set filetype=ascii in ngspice, or export it as text in LTspice"


def table_text(data: bytes, fault: Fault, example: str) -> str:
    """Return the text of a table, each line ended by a newline alone; raises a fault that says what else it is."""
    if not data.strip():
        raise fault("empty", None, "the file is empty", f"the first line is such as: {example}")
    for begin, inside, kind, cure in BINARY:
        if data.startswith(begin) and inside in data:
            raise fault("binary", None, f"this is {kind}, not a table", cure)
    if data.startswith(b"TDSm"):
        return _tdms_text(data, fault)
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
    head = data[:200_000].replace(b"\0", b"")
    if b"Title:" in head[:20] and b"\nBinary:" in head:
        raise fault("binary", None, "this is a binary file of a SPICE program, not a table", AS_TEXT)
    if not coding and b"\0" in data:
        what = f"this is a binary file, not a table (a zero byte at byte offset {data.index(0)})"
        raise fault("binary", None, what, "save it as text (CSV in UTF-8)")
    for name in (coding,) if coding else ("utf-8-sig", "cp1252"):
        try:
            return data.decode(name)
        except UnicodeDecodeError as problem:
            at = problem.start
    raise fault("coding", None, f"byte 0x{data[at]:02X} at byte offset {at} is not text", "save the file as UTF-8")


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


def _tdms_text(data: bytes, fault: Fault) -> str:
    """The table in a TDMS file: its channels, and the time of their waveform where none is called so."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        cure = 'pip install "thermicon[hardware]", or save it as CSV'
        raise fault("binary", None, "TDMS needs npTDMS, which is not installed", cure) from None
    try:
        channels = [channel for group in TdmsFile.read(io.BytesIO(data)).groups() for channel in group.channels()]
        columns = {channel.name: channel[:].tolist() for channel in channels}
        if not any(name.lower().startswith("time") for name in columns):
            clocks = {tuple(channel.time_track().round(9).tolist()) for channel in channels}
            if len(clocks) != 1:
                raise ValueError("its channels have different clocks; save each clock as a file of its own")
            columns = {"time_s": list(clocks.pop()), **columns}
        rows = [*zip(*columns.values(), strict=True)]
    except Exception as problem:  # npTDMS raises whatever a broken file leads it to
        why = "no wf_increment" if isinstance(problem, KeyError) else str(problem) or type(problem).__name__
        raise fault("binary", None, f"cannot be read as TDMS ({why})", "save it as CSV") from None
    return "\n".join(["\t".join(columns), *("\t".join(map(str, row)) for row in rows)])

"""The text of a table decoded from the bytes that other programs write."""

from __future__ import annotations

import io
import re
import unicodedata
from typing import TYPE_CHECKING

from ..words.installing import install
from .kinds_of_files import HEAD, other_kind

if TYPE_CHECKING:
    from .table import Fault

TABLES = (".csv", ".tsv", ".txt", ".dat", ".log", ".lvm", ".prn", ".raw", ".tdms", ".xlsx", ".xls", ".ods", ".gz",
          ".zip", ".parquet", ".mat", ".h5", ".hdf5", ".nwb", ".xdf", ".npy", ".npz", ".edf", ".jsonl")  # fmt: skip
"""Endings of what may hold a table, or gets a sentence on how to make one of it."""

OTHERS = {
    b"PK\3\4": ("a workbook of Excel or LibreOffice, or a zip archive", "save the sheet as CSV, or unpack the archive"),
    b"\x1f\x8b": ("compressed by gzip", "unpack it, and give the table in it"),
    b"<": ("a page of HTML or XML", "open it in a spreadsheet, and save the sheet as CSV"),
}
"""How files begin that hold no table, what they are, and what to do; others are found by their zero bytes."""

ASIAN = {"cp932": "Shift-JIS", "gb18030": "GB 18030", "big5": "Big5"}
WORDS = re.compile("時間|时间|時刻|温度|溫度|電流|电流")
"""Encodings of East Asia, and words that show that a text is in one of them."""
FULL_WIDTH = re.compile("[\uff01-\uff5e\u2100-\u214f\u0660-\u0669\u06f0-\u06f9]")
"""Digits, letters and signs of other widths and scripts, and units in one sign."""
MAGIC = {
    b"\x89HDF": "HDF5, as NWB and MATLAB 7.3 write it", b"XDF:": "XDF of the Lab Streaming Layer",
    b"\x93NUMPY": "an array of numpy", b"PAR1": "Parquet", b"MATLAB 5.0": "a MAT file", b"0       ": "EDF",
    b"SQLite format 3": "a database of SQLite",
}  # fmt: skip
"""How containers of data begin."""


def table_text(data: bytes, fault: Fault, example: str) -> tuple[str, str]:
    """Return the text of a table, each line ended by a newline alone, and its encoding where that is a rare one.

    Raises a fault that says what else a file is.
    """
    if not data.strip():
        raise fault("empty", None, "the file is empty", f"the first line is such as: {example}")
    for begin, kind in MAGIC.items():
        if (data.startswith(begin) and b"\0" in data[:4000]) or (begin == b"\x93NUMPY" and b".npy" in data[:100]):
            cure = "open it in Python or MATLAB, and write times and temperatures as CSV, such as by DataFrame.to_csv"
            raise fault("binary", None, f"this is {kind}, not a table", cure)
    for begin, (kind, cure) in OTHERS.items():
        if data.lstrip().startswith(begin):
            raise fault("binary", None, f"this is {kind}, not a table", cure)
    if wrong := other_kind(data[:HEAD].replace(b"\0", b"").decode("utf-8", "replace"), "table"):
        raise fault("binary", None, *wrong)
    if data.startswith(b"TDSm"):
        return _tdms_text(data, fault), ""
    head = data[:200_000].replace(b"\0", b"")
    if b"Title:" in head[:20] and b"\nVariables:" in head:
        cure = "write it by wrdata in ngspice, or export it as text in LTspice"
        raise fault("binary", None, "this is a raw file of a SPICE program, not a table", cure)
    coding = "utf-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    if b"\0" in data and coding != "utf-16":
        what = f"this is a binary file, not a table (a zero byte at byte offset {data.index(0)})"
        raise fault("binary", None, what, "save it as text (CSV in UTF-8)")
    rare = ""
    try:
        text = data.decode(coding)
    except UnicodeDecodeError:
        asian = ((data.decode(each, "replace"), name) for each, name in ASIAN.items())
        sound = (read for read in asian if WORDS.search(read[0]) and "\ufffd" not in read[0])
        text, rare = next(sound, (data.decode("cp1252", "replace"), ""))
    text = text.replace("\r\n", "\n").replace("\r", "\n").replace("Â°", "°").replace("Âµ", "µ")
    if FULL_WIDTH.search(text[:HEAD]):
        text = unicodedata.normalize("NFKC", text)
    return text, rare


def _tdms_text(data: bytes, fault: Fault) -> str:
    """The table in a TDMS file: its channels, and the time of their waveform where none is called so."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        cure = f"{install('npTDMS')}, or save it as CSV"
        raise fault("binary", None, "TDMS needs npTDMS, which is not installed", cure) from None
    try:
        file = TdmsFile.read(io.BytesIO(data))
        clocked = not any(c.name.lower().startswith("time") for group in file.groups() for c in group.channels())
        frame = file.as_dataframe(time_index=clocked)
        frame.columns = [re.findall("'(.*?)'", name)[-1] for name in frame.columns]
        return str(frame.to_csv(sep="\t", index=clocked, index_label="time_s", lineterminator="\n"))
    except Exception as problem:  # npTDMS raises whatever a broken file leads it to
        why = "no wf_increment" if isinstance(problem, KeyError) else str(problem) or type(problem).__name__
        raise fault("binary", None, f"cannot be read as TDMS ({why})", "save it as CSV") from None

"""Readers of text or TOML files with one clear error for each fault."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..checks.arguments import InputError as InputError
from ..words.clean_text import clean_line, first_control
from ..words.installing import install
from ..words.near_words import did_you_mean
from .beside import beside
from .read_limited import NotRegular, TooLarge, read_limited
from .table import Fault

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

TOO_DEEP = "nested too deeply; two or three levels are all that is needed"
DEEPEST, MOST_DIGITS = 10, 19
"""Levels of tables and digits of a whole number: far more than any file of ours has."""

LONGEST_NAME, LONGEST_LINE = 200, 2000
"""Characters of a name, and of any other text of one line: room for a sentence, not for a file within a file."""


LONGEST_QUOTE = 62
"""Characters of a value that a message quotes."""

TEXT_FAULT = "text"
"""Type of pydantic's error for a text that may not stand where it does."""


def line_fault(text: str, longest: int = LONGEST_LINE, allowed: str = "") -> str | None:
    """Why a text cannot be a name or title; None where it is one line without control characters."""
    if bad := first_control(text, allowed):
        return f"holds the control character {bad}; remove it"
    if len(text) > longest:
        return f"has {len(text):,} characters; at most {longest:,} are taken"
    return None


def one_line(text: str) -> str:
    """Validate a text as one line without control characters, for a field of a pydantic table."""
    return _checked(text, line_fault(text))


def paragraph(text: str) -> str:
    """Validate a text that may have several lines and tabs, but no other control characters."""
    return _checked(text, line_fault(text, 10 * LONGEST_LINE, "\n\t"))


def _checked(text: str, fault: str | None) -> str:
    if fault:
        from pydantic_core import PydanticCustomError

        raise PydanticCustomError(TEXT_FAULT, "{fault}", {"fault": fault})
    return text


def quoted(value: object) -> str:
    """A value as messages quote it: as Python writes it, shortened where it is long."""
    text = repr(value)
    return text if len(text) <= LONGEST_QUOTE else f"{text[: LONGEST_QUOTE - 2]}…{text[-1]}"


def read_text(path: Path, what: str, limit_MB: float, error: type[Exception] = InputError) -> str:
    """The text of a file of a kind `what` ("rig file"), of at most `limit_MB`; raises `error` with what is wrong."""
    data = read_bytes(path, what, limit_MB, error)
    if not data.strip():
        raise error(f"{path}: the file is empty; a {what} was expected")
    if b"\0" in data:
        zero = data.index(0)
        raise error(
            f"{path}: this is a binary file, not a {what} (a zero byte at offset {zero}); save it as UTF-8 text"
        )
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as problem:
        raise error(f"{path}: not UTF-8 text (byte {problem.start}); save the {what} as UTF-8") from None


def named_text(source: str | Path, names: Sequence[str], what: str, error: type[Exception]) -> tuple[str, str]:
    """The text of a file of a kind `what` ("rig"), by its path or a shipped name of `names`, and what to call the file.

    A file with the name of a shipped one is read in its place; a folder of that name is not.
    """
    path = Path(source)
    named = path.suffix == ".toml" and path.stem not in names
    if named or (path.exists() and not (path.is_dir() and str(source) in names)):
        return read_text(path, f"{what} file", 1, error), str(path)
    if str(source) not in names:
        shipped = {name: tomllib.loads(shipped_text(f"{what}s/{name}.toml")) for name in names}
        also = {name: f"{table['title']} {table.get('note', '')}" for name, table in shipped.items()}
        hint = did_you_mean(path.stem, names, 3, "" if path.stem in names else beside(path, ".toml"), also)
        raise error(f"{source}: no such {what}; {hint}")
    return shipped_text(f"{what}s/{source}.toml"), f"{what} {source}"


def shipped_names(folder: str) -> list[str]:
    """Names of the files in a folder of `circuit`, in alphabetical order."""
    files = (resources.files("thermicon.circuit") / folder).iterdir()
    return sorted(path.name.removesuffix(".toml") for path in files if path.name.endswith(".toml"))


def shipped_text(path: str) -> str:
    """The text of a file of `circuit`, by its path there."""
    return resources.files("thermicon.circuit").joinpath(path).read_text("utf-8")


@cache
def shipped_table(name: str) -> dict[str, Any]:
    """A table of `circuit/data` that holds other things than records."""
    return tomllib.loads(shipped_text(f"data/{name}"))


def read_bytes(path: Path, what: str, limit_MB: float, error: type[Exception] = InputError) -> bytes:
    """Return the content of a regular file of at most `limit_MB`, or raise `error` with a sentence on what it is."""
    try:
        return read_limited(path, int(limit_MB * 1e6))
    except NotRegular as found:
        if found.kind == "folder":
            raise error(f"{path}: this is a folder, not a {what}") from None
        raise error(f"{path}: {found}; save its output as a {what}, and give that file") from None
    except TooLarge as found:
        raise error(
            f"{path}: {found.size / 1e6:.0f} MB is too large for a {what}; the limit is {limit_MB:g} MB"
        ) from None
    except FileNotFoundError:
        meant = beside(path)
        raise error(f"{path}: no such {what}{f'; did you mean {meant}?' if meant else ''}") from None
    except (OSError, ValueError) as problem:
        raise error(f"{path}: cannot be read ({getattr(problem, 'strerror', None) or problem})") from None


def table_fault(path: str | Path, error: type[InputError] = InputError) -> Fault:
    """Return what makes `error` out of a fault of the table in a file, for `base.files.table`."""

    def fault(kind: str, line: int | None, what: str, cure: str) -> InputError:
        return error(f"{path}{f':{line}' if line else ''}: {what}; {cure}")

    return fault


def require_pyarrow(path: str | Path, error: type[Exception] = InputError) -> None:
    """Raise `error` with the cure where pyarrow, which reads and writes Parquet files, is not installed."""
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise error(
            f"{path}: Parquet files need pyarrow, which is not installed: {install('pyarrow')}, or use a .csv file"
        ) from None


def read_toml(
    text: str, where: str, what: str, own: Sequence[str], error: type[Exception] = InputError
) -> dict[str, Any]:
    """The TOML text of a kind `what` ("rig file") as a dictionary; raises `error` with the line that is wrong.

    That is also for another kind of file, without a key of its `own`, deep nesting, and numbers beyond 64 bits.
    """
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        _check_kind(text, where, what, error)
        raise error(f"{where}: not a valid TOML file: {problem}") from None
    except RecursionError:
        raise error(f"{where}: tables and lists are {TOO_DEEP}") from None
    except ValueError:  # whole numbers of more than 4,300 digits
        raise error(f"{where}: a whole number has thousands of digits; numbers have at most {MOST_DIGITS}") from None
    if not any(key in document for key in own):
        _check_kind(text, where, what, error)
    if fault := _unreadable(document):
        raise error(f"{where}: {fault}")
    return document


def _check_kind(text: str, where: str, what: str, error: type[Exception]) -> None:
    from .kinds_of_files import other_kind

    if wrong := other_kind(text, what):
        raise error(f"{where}: {'; '.join(wrong)}")


def _unreadable(document: dict[str, Any]) -> str | None:
    """Content that no table of ours can hold: deeper nesting, or whole numbers beyond 64 bits."""
    open_: list[tuple[str, Any, int]] = [(key, value, 1) for key, value in document.items()]
    while open_:
        key, value, depth = open_.pop()
        if depth > DEEPEST:
            return f"{clean_line(key[:60])}: {TOO_DEEP}"
        if isinstance(value, dict):
            open_ += [(f"{key}.{name}", inner, depth + 1) for name, inner in value.items()]
        elif isinstance(value, list):
            open_ += [(f"{key}.{place}", inner, depth + 1) for place, inner in enumerate(value)]
        elif isinstance(value, int) and not -(2**63) <= value < 2**63:
            return (
                f"{clean_line(key[:60])}: a whole number of more than 64 bits; write it as a decimal number, as in 1e20"
            )
    return None


Place = Sequence[int | str]

BOUNDS = {"greater_than": ("gt", "greater than"), "greater_than_equal": ("ge", "at least"),
          "less_than_equal": ("le", "at most")}  # fmt: skip
NUMBERS = {"float_type": "number", "int_type": "whole number", "int_from_float": "whole number",
           "finite_number": "finite number"}  # fmt: skip
SMALLEST = 0.01
"""A least value below this is there to keep 0 out, and is not told."""


def key_faults(
    problem: ValidationError,
    unknown: Callable[[Place], str],
    unit_of: Callable[[str], str] = lambda key: "",
    shape_of: Callable[[str], str] = lambda key: "must be spelled otherwise",
    likely_unit: Callable[[str, float], str] = lambda key, value: "",
) -> list[str]:
    """Every fault of a table's keys, by what an `unknown` key may be, the unit of each, and the shape of a text.

    `likely_unit` says in which other unit a number beyond a bound would be usual, or nothing.
    """
    faults = [_in_words(error, unknown, unit_of, shape_of, likely_unit) for error in problem.errors(include_url=False)]
    return [line for fault in faults for line in fault.splitlines()]


def _in_words(
    error: ErrorDetails,
    unknown: Callable[[Place], str],
    unit_of: Callable[[str], str],
    shape_of: Callable[[str], str],
    likely_unit: Callable[[str, float], str],
) -> str:
    key = ".".join(str(part) for part in error["loc"])
    unit, value, kind, context = unit_of(key), error.get("input"), error["type"], error.get("ctx", {})
    subject = f"{key} = {quoted(value)}" if isinstance(value, (int, float, str, bool)) else key
    behind = f" {unit}" if unit else ""
    if kind == "extra_forbidden":
        return f"{key}: unknown key; {unknown(error['loc'])}"
    if kind == TEXT_FAULT:
        return f"{subject}: {context['fault']}"
    if kind == "value_error":  # a sentence from a table's own validator
        return str(context["error"])
    if kind == "missing":
        return f"{key} is missing; add it{behind and f', in{behind}'}"
    if kind in BOUNDS:
        name, words = BOUNDS[kind]
        limit = context[name]
        if kind == "greater_than_equal" and 0 < limit < SMALLEST and value is not None and value <= 0:
            limit, words = 0, "greater than"
        likely = likely_unit(key, value) if isinstance(value, int | float) else ""
        return f"{subject}{behind}: must be {words} {limit:g}{behind}{likely and f'; {likely}'}"
    if kind in NUMBERS:
        quotes = ", without quotes or unit" if isinstance(value, str) else ""
        return f"{subject}: must be a {NUMBERS[kind]}{behind and f' in{behind}'}{quotes}"
    if kind == "string_type":
        return f"{subject}: must be a text, in quotes"
    if kind == "bool_type":
        return f"{subject}: must be true or false"
    if kind == "literal_error":
        return f"{subject}: must be {context.get('expected')}"
    if kind == "string_pattern_mismatch":
        return f"{subject}: {shape_of(key)}"
    return f"{subject}: {error['msg'][:1].lower()}{error['msg'][1:]}"

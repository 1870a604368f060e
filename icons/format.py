"""Canonical text: a model object written as cue text that reads back to an equal object."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from thermicon.icons.statements import Broken, Change, Control, Drive, Hold, Repeat, Rest, Statement
from thermicon.icons.units import Kind, quantity

if TYPE_CHECKING:
    from thermicon.icons.frame import Frame, Metadata
    from thermicon.icons.icon import Icon, IconSet


def statement_text(statement: Statement | Broken, control: Control, indent: str = "") -> str:
    """Return one statement as cue text, without a newline at its end; repeats take several lines.

    >>> from thermicon.icons.statements import Return
    >>> statement_text(Repeat(2, (Change("warm", by_K=1, duration_s=0.5), Return(1))), "skin")
    'repeat 2 {\\n  warm by 1 °C over 0.5 s\\n  return at 1 °C/s\\n}'
    """
    match statement:
        case Change(direction=direction):
            size = f"by {quantity(statement.by_K, 'difference')}" if statement.by_K is not None else ""
            if statement.to_C is not None:
                size = f"to {quantity(statement.to_C, 'absolute')}"
            return f"{indent}{direction} {size} {_pace(statement.rate_K_per_s, 'rate', statement.duration_s)}"
        case Drive():
            pace = _pace(statement.rate_A_per_s, "current_rate", statement.duration_s)
            return f"{indent}to {quantity(statement.to_A, 'current')} {pace}"
        case Hold():
            return f"{indent}hold for {quantity(statement.duration_s, 'time')}"
        case Rest():
            return f"{indent}rest for {quantity(statement.duration_s, 'time')}"
        case Repeat():
            body = "\n".join(statement_text(part, control, indent + "  ") for part in statement.body)
            return f"{indent}repeat {statement.count} {{\n{body}\n{indent}}}"
        case Broken():
            raise ValueError("a statement that could not be read has no text")
    kind: Kind = "current_rate" if control == "current" else "rate"
    return f"{indent}return {_pace(statement.rate_per_s, kind, statement.duration_s)}"


def icon_text(icon: "Icon") -> str:
    """Return the complete text of a file that holds this one icon."""
    return _file(_set_lines("", "", icon.frame, None), [icon])


def set_text(icons: "IconSet") -> str:
    """Return the complete text of the file of a set."""
    return _file(_set_lines(icons.name, icons.title, icons.frame, icons.metadata), icons.icons)


def quoted(text: str) -> str:
    """Return a text in quotation marks, with what stands in its way escaped.

    >>> print(quoted('say "hot"'))
    "say \\"hot\\""
    """
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _file(set_lines: list[str], icons: "Iterable[Icon]") -> str:
    blocks = ["cue 1"]
    if set_lines:
        blocks.append("\n".join(set_lines))
    for icon in icons:
        header = " ".join(["icon", icon.name, *_metadata(icon.metadata), "{"])
        body = [statement_text(part, icon.frame.control, "  ") for part in icon.statements]
        blocks.append("\n".join([header, *body, "}"]))
    return "\n\n".join(blocks) + "\n"


def _set_lines(name: str, title: str, frame: "Frame", metadata: "Metadata | None") -> list[str]:
    lines = [f"  site {frame.site}"] if frame.site is not None else []
    if frame.control != "skin":
        lines.append(f"  control {frame.control}")
    if frame.baseline_C is not None:
        lines.append(f"  baseline {quantity(frame.baseline_C, 'absolute')}")
    lines += [f"  {line}" for line in _metadata(metadata)] if metadata else []
    if not (lines or name or title):
        return []
    header = " ".join(part for part in ("set", name, quoted(title) if title else "", "{") if part)
    return [header, *lines, "}"]


def _metadata(metadata: "Metadata") -> list[str]:
    keys = ("means", "by", "doi", "licence")
    found = [f"{key} {quoted(value)}" for key in keys if (value := getattr(metadata, key)) is not None]
    return [*found, f"tags {quoted(', '.join(metadata.tags))}"] if metadata.tags else found


def _pace(rate: float | None, kind: Kind, duration_s: float | None) -> str:
    if rate is not None:
        return f"at {quantity(rate, kind)}"
    assert duration_s is not None
    return f"over {quantity(duration_s, 'time')}"

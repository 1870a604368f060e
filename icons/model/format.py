"""Canonical text: a model object written as cue text that reads back to an equal object."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, assert_never

from .parameter import Path
from .statements import (
    Broken,
    Current,
    Hold,
    Leaf,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Statement,
    Step,
    Total,
    Wave,
    played_icons,
)
from .units import Control, Kind, quantity

if TYPE_CHECKING:
    from .context import Context, Metadata
    from .family import Family
    from .icon import Icon
    from .iconset import IconSet
    from .spatial import Part, SpatialIcon

Holes = Mapping[tuple[Path, str], str]
_GOALS: tuple[tuple[str, Kind], ...] = (
    ("by_K", "change"),
    ("to_C", "absolute"),
    ("by_A", "current"),
    ("to_A", "current"),
)
WIDEST = 120
"""Headers longer than this take several lines."""


def statement_text(
    statement: Statement | Broken, control: Control, indent: str = "", holes: Holes | None = None, path: Path = ()
) -> str:
    """One statement as cue text without a newline at its end; ``holes`` names parameters by path and field."""
    writer = _Writer(control, holes or {})
    return writer.statement(statement, indent, path)


class _Writer:
    """Writes statements; a parameter stands in for a number where ``holes`` names one."""

    def __init__(self, control: Control, holes: Holes) -> None:
        self.control = control
        self.holes = holes

    def goal(self, part: object, path: Path) -> str:
        """Return where a statement leads, such as ``by 6 °C`` or ``to 0.5 A``."""
        name, kind = next(pair for pair in _GOALS if getattr(part, pair[0], None) is not None)
        return f"{name[:2]} {self.value(part, path, name, kind)}"

    def pace(self, part: object, path: Path) -> str:
        """Return how fast a statement is, or how long it takes: ``at 3 °C/s`` or ``over 2 s``."""
        rates: tuple[tuple[str, Kind], ...] = (
            ("rate_K_per_s", "rate"),
            ("rate_A_per_s", "current_rate"),
            ("rate_per_s", "current_rate" if self.control == "current" else "rate"),
        )
        for name, kind in rates:
            if getattr(part, name, None) is not None:
                return f"at {self.value(part, path, name, kind)}"
        return f"over {self.value(part, path, 'duration_s', 'time')}"

    def value(self, part: object, path: Path, name: str, kind: Kind) -> str:
        """Return the number in a field with its unit, or the parameter that stands there."""
        hole = self.holes.get((path, name))
        return quantity(float(getattr(part, name)), kind) if hole is None else hole

    def statement(self, part: Statement | Broken, indent: str, path: Path) -> str:
        if isinstance(part, Repeat):
            lines = (self.statement(inner, indent + "  ", (*path, n)) for n, inner in enumerate(part.body))
            count = self.value(part, path, "count", "count")
            return f"{indent}repeat {count} {{\n{chr(10).join(lines)}\n{indent}}}"
        assert not isinstance(part, Broken), "what could not be read has no text"
        return indent + self.line(part, path)

    def line(self, part: Leaf | Play, path: Path) -> str:
        match part:
            case Ramp(direction=word):
                return f"{word} {self.goal(part, path)} {self.pace(part, path)}"
            case Current():
                return f"{self.goal(part, path)} {self.pace(part, path)}"
            case Hold():
                return f"hold for {self.value(part, path, 'duration_s', 'time')}"
            case Rest():
                return f"rest for {self.value(part, path, 'duration_s', 'time')}"
            case Total():
                bound = "" if part.bound == "exactly" else f"{part.bound} "
                return f"total {bound}{self.value(part, path, 'duration_s', 'time')}"
            case Play():
                return f"play {part.icon.name}"
            case Step():
                return f"step {_word(part.direction)}{self.goal(part, path)}"
            case Pulse():
                time = self.value(part, path, "duration_s", "time")
                return f"pulse {_word(part.direction)}{self.goal(part, path)} for {time}"
            case Wave():
                period, time = (self.value(part, path, name, "time") for name in ("period_s", "duration_s"))
                start = "" if part.start in ("warm", "up") else f" starting {part.start}"
                cut = " cut" if part.cut else ""
                return f"{part.shape} {self.goal(part, path)} every {period} for {time}{start}{cut}"
            case Return():
                return f"return {self.pace(part, path)}"
        assert_never(part)


def icon_text(icon: "Icon | Family | SpatialIcon") -> str:
    """Return the complete text of a file that holds this icon or family, after the icons that it plays."""
    needed = [] if hasattr(icon, "parts") else list(_needed(icon, {}).values())
    return _file(_set_lines("", "", icon.context, None), [*needed, icon])


def set_text(icons: "IconSet") -> str:
    """Return the complete text of the file of a set."""
    return _file(_set_lines(icons.name, icons.title, icons.context, icons.metadata), (*icons.entries, *icons.spatial))


def quoted(text: str) -> str:
    """Return a text in quotation marks, with what stands in its way escaped."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _needed(icon: "Icon | Family", found: "dict[str, Icon]") -> "dict[str, Icon]":
    for played in played_icons(_body(icon)):
        if played.name not in found:
            _needed(played, found)
            found[played.name] = played
    return found


def _body(icon: "Icon | Family") -> tuple[Statement, ...]:
    return icon.template if hasattr(icon, "template") else icon.statements


def _file(set_lines: list[str], icons: "Iterable[Icon | Family | SpatialIcon]") -> str:
    blocks = ["cue 1"]
    if set_lines:
        blocks.append("\n".join(set_lines))
    for icon in icons:
        slots = getattr(icon, "slots", ())
        parameters = list(map(str, getattr(icon, "parameters", ())))
        header = header_lines(f"icon {icon.name}", parameters, metadata_texts(icon.metadata))
        holes = {(slot.path, slot.field): slot.parameter for slot in slots}
        if hasattr(icon, "parts"):
            body = [_part_text(part, icon.context, "  ") for part in icon.parts]
        else:
            body = [statement_text(part, icon.context.control, "  ", holes, (n,)) for n, part in enumerate(_body(icon))]
        blocks.append("\n".join([*header, *body, "}"]))
    return "\n\n".join(blocks) + "\n"


def _part_text(part: "Part", context: "Context", indent: str) -> str:
    if hasattr(part, "parts"):
        head, body = "together", [_part_text(each, context, indent + "  ") for each in part.parts]
    else:
        names = "all" if part.names == context.elements else ", ".join(part.names)
        head = f"along {names} every {quantity(part.every_s, 'time')}" if hasattr(part, "every_s") else f"on {names}"
        body = [statement_text(each, context.control, indent + "  ") for each in part.body]
    return "\n".join([f"{indent}{head} {{", *body, f"{indent}}}"])


def header_lines(head: str, parameters: Sequence[str], keys: Sequence[str]) -> list[str]:
    """Return the header of an icon, its brace included: one line, or one for each part where that is too long."""
    listed = f"{head}({', '.join(parameters)})" if parameters else head
    whole = " ".join([listed, *keys, "{"])
    if len(whole) <= WIDEST or len(parameters) + len(keys) < 2:
        return [whole]
    rows = [listed]
    if len(listed) > WIDEST and len(parameters) > 1:
        rows = [f"{head}(", *(f"  {text}," for text in parameters[:-1]), f"  {parameters[-1]}", ")"]
    if keys:
        return [*rows, *(f"  {key}" for key in keys), "{"]
    return [*rows[:-1], f"{rows[-1]} {{"]


def _set_lines(name: str, title: str, context: "Context", metadata: "Metadata | None") -> list[str]:
    lines = [f"  elements {', '.join(context.elements)}"] if context.elements else []
    lines += [f"  site {context.site}"] if context.site is not None else []
    if context.control != "skin":
        lines.append(f"  control {context.control}")
    if context.baseline_C is not None:
        lines.append(f"  baseline {quantity(context.baseline_C, 'absolute')}")
    lines += [f"  {line}" for line in metadata_texts(metadata)] if metadata else []
    if not (lines or name or title):
        return []
    header = " ".join(part for part in ("set", name, quoted(title) if title else "", "{") if part)
    return [header, *lines, "}"]


def metadata_texts(metadata: "Metadata") -> list[str]:
    """Return each key of metadata with its text, in canonical order."""
    keys = ("means", "by", "doi", "licence")
    found = [f"{key} {quoted(value)}" for key in keys if (value := getattr(metadata, key)) is not None]
    return [*found, f"tags {quoted(', '.join(metadata.tags))}"] if metadata.tags else found


def _word(direction: str) -> str:
    return "" if direction == "change" else f"{direction} "

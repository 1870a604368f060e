"""Every command with its options as ``--help`` states them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from typer.main import get_command

from thermicon.notebooks.cli.main import app


def command_options() -> str:
    """Return Markdown: for each command a heading and a table of its options, in the order of ``thermicon --help``."""
    group: Any = get_command(app)
    context = group.context_class(group, info_name="thermicon")
    jobs: dict[str, list[str]] = {}
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if not command.hidden:
            jobs.setdefault(str(command.rich_help_panel), []).append("\n".join(_command(command, name, context)))
    return "\n".join(f"## {job}\n\n" + "\n".join(commands) for job, commands in jobs.items())


def _command(command: Any, name: str, above: Any) -> Iterator[str]:
    context = command.context_class(command, info_name=name, parent=above)
    yield f"### `{name}`\n"
    yield f"{plain(' '.join(command.help.split()))}\n"
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"```text\nthermicon {name} {usage}\n```\n"
    yield "| option | meaning |\n|---|---|"
    for parameter in command.params:
        record = parameter.get_help_record(context)
        if record is not None and parameter.name != "help":
            names, meaning = record
            names = parameter.metavar if parameter.param_type_name == "argument" else names.strip()
            yield f"| `{names}` | {plain(meaning)} |"
    yield ""


def plain(text: str) -> str:
    r"""Return text with everything escaped that Markdown would read as a mark.

    >>> plain("A|B with <C> and *")
    'A\\|B with \\<C\\> and \\*'
    """
    return re.sub(r"([|<>*_\[\]`\\$])", r"\\\1", " ".join(text.split()))

"""``thermicon sweep``: one key of the rig over a range, and every number of a run at each value."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, complete_or_absent
from ..text.messages import Progress, fail, note, progress_bar, usage
from ..text.number_text import span
from .cues import pick, read_set, warn_of_site

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

MOST_VALUES = 10_000
FORM = "give KEY=LOW:HIGH:N, for example contact.area_cm2=4:16:7, or LOW:HIGH:Nlog for equal ratios"


@dataclass(frozen=True, slots=True)
class Vary:
    """A dotted key of the rig file and the values it takes, in the file's unit."""

    key: str
    values: tuple[float, ...]
    log: bool


def read_vary(text: str) -> Vary:
    """Return what ``--vary`` asks for; a usage error that shows the form where it is not of it.

    >>> read_vary("contact.area_cm2=4:9:3").values, read_vary("contact.resistance_m2K_per_W=1e-4:1e-2:3log").values
    ((4.0, 6.5, 9.0), (0.0001, 0.001, 0.01))
    """
    key, equals, rest = text.partition("=")
    parts = [part.strip() for part in rest.split(":")]
    if not (key.strip() and equals and len(parts) == 3):
        raise usage(f"{text!r}: {FORM}", "--vary")
    log = parts[2].endswith("log")
    low, high = (_bound(part, text) for part in parts[:2])
    try:
        count = int(parts[2].removesuffix("log"))
    except ValueError:
        raise usage(f"{text!r}: {parts[2]!r} is not a number of values; {FORM}", "--vary") from None
    if not 2 <= count <= MOST_VALUES:
        raise usage(f"{text!r}: {count} values is outside 2 to {MOST_VALUES}", "--vary")
    if low == high:
        raise usage(f"{text!r}: both ends are {low:g}; a sweep needs two different ends", "--vary")
    if log and not (low > 0 and high > 0):
        raise usage(f"{text!r}: equal ratios need both ends above 0; leave out log for equal steps", "--vary")
    shares = [k / (count - 1) for k in range(count)]
    values = [low * (high / low) ** share if log else low + (high - low) * share for share in shares]
    return Vary(key.strip(), tuple(float(f"{value:.12g}") for value in values), log)


def _bound(text: str, whole: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise usage(f"{whole!r}: {text!r} is not a number; {FORM}", "--vary")
    return value


def sweep(
    icons: Iterable[Icon],
    rig: Rig,
    key: str,
    values: Sequence[float],
    *,
    tail_s: float = 0.0,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Play every icon at every value of a key of the rig; a row each, values in the unit of the rig file.

    Columns: icon, the key, the fields of `thermicon.circuit.Summary`, what the receptors see, and `reason`. A value at
    which the rig cannot be, or cannot play the icon, gives a row with only the reason. Raises RigError for a key that
    no rig has.
    """
    import pandas as pd

    from thermicon.circuit import Summary
    from thermicon.circuit.rig.settings import put

    put(json.loads(rig.document), key, float(values[0]))
    played, rows = list(icons), []
    for value in values:
        rows += [{"icon": icon.name, key: float(value), **_run(icon, rig, key, value, tail_s)} for icon in played]
        if progress is not None:
            progress(len(rows), len(played) * len(values))
    numbers = [field.name for field in fields(Summary) if field.name != "reason"]
    frame = pd.DataFrame(rows, columns=["icon", key, *numbers, *RECEPTORS, "reason"])
    words = {"icon": "string", "safety": "string", "reason": "string", "reached": "boolean", "safe": "boolean"}
    kinds: dict[str, Any] = {name: words.get(name, "float64") for name in frame.columns}
    order = {icon.name: place for place, icon in enumerate(played)}
    return frame.astype(kinds).sort_values("icon", key=lambda names: names.map(order), kind="stable", ignore_index=True)


RECEPTORS = tuple(
    f"{channel}_receptor_{what}"
    for channel in ("cold", "warm")
    for what in ("peak_change_K", "attack_K_per_s", "delay_s")
)
"""Columns for what the receptors see: largest change, steepest rate towards it, lag of its half behind the skin's."""


def _run(icon: Icon, rig: Rig, key: str, value: float, tail_s: float) -> dict[str, Any]:
    import numpy

    from thermicon.circuit import InputError, simulate, summarise

    try:
        with numpy.errstate(all="ignore"):  # what overflows ends as a reason
            trace = simulate(icon, rig.with_(**{key: float(value)}), tail_s=tail_s)
    except (InputError, ValueError, ArithmeticError) as problem:
        return {"reason": "; ".join(str(problem).splitlines())}
    return {**summarise(trace).to_dict(), **_receptors(trace)}


def _receptors(trace: Trace) -> dict[str, float | None]:
    from thermicon.perception.observer.observer import CHANNELS
    from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

    seen = [(what(trace, channel)) for channel in CHANNELS for what in (peak_change_K, attack_K_per_s, delay_s)]
    return dict(zip(RECEPTORS, seen, strict=True))


def sweep_file(
    file: str, vary: Vary, icon: str | None, rig: Rig, tail_s: float, output: Path, figure: Path | None
) -> None:
    """Sweep the icons of a file (or the one named); write the table, draw the figure, tell each icon's outcome."""
    check_output(output, TRACE_SUFFIXES, "a sweep")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    icons = pick(whole := read_set([file]), icon)
    warn_of_site(file, whole, rig)
    with progress_bar("sweep") as progress:
        frame = sweep(icons, rig, vary.key, vary.values, tail_s=tail_s, progress=progress)
    if frame["duration_s"].isna().all():
        first = frame["reason"].iloc[0]
        fail(f"--vary {vary.key}: none of its {len(vary.values)} values can be played; the first: {first}")
    if output != STDOUT:
        with complete_or_absent(output) as draft:
            write_frame(frame, draft)
    if figure is not None:
        from ..figures.sweep_figure import sweep_figure

        with complete_or_absent(figure) as draft:
            sweep_figure(frame, vary.key, log=vary.log).savefig(draft, dpi=130)
    for line in (*(headline(frame[frame["icon"] == each.name]) for each in icons), *_impossible(frame, vary.key)):
        note(line)
    for written in (output, figure):
        if written not in (None, STDOUT):
            note(f"wrote {written}")
    if output == STDOUT:
        typer.echo(frame.to_csv(index=False, float_format="%.9g"), nl=False)


def write_frame(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as ``.parquet`` or ``.csv``, by its suffix."""
    if path.suffix == ".parquet":
        frame.to_parquet(path, index=False)
    else:
        frame.to_csv(path, index=False, float_format="%.9g", lineterminator="\n")


def headline(rows: pd.DataFrame) -> str:
    """Say of one icon's rows at how many values it was reached, and how large its misses are."""
    ran = rows[rows["duration_s"].notna()]
    judged = ran[ran["reached"].notna()]
    if len(judged):
        miss = judged["largest_miss_K"].abs()
        low, high = float(miss.min()), float(miss.max())
        said = "everywhere within 1 mK" if high < 1e-3 else f"largest miss {span(low, high, 'K', 3)}"
        parts = [f"reached at {int(judged['reached'].sum())} of {len(rows)} values", said]
    else:
        parts = [f"played at {len(ran)} of {len(rows)} values"]
    if unsafe := int((~ran["safe"]).sum()):
        parts.append(f"NOT SAFE at {unsafe}")
    if len(ran) < len(rows):
        parts.append(f"impossible at {len(rows) - len(ran)}")
    return f"{rows['icon'].iloc[0]}: {', '.join(parts)}"


def _impossible(frame: pd.DataFrame, key: str) -> list[str]:
    """Return the first reason for which a value could not be played, as a line; none where all could."""
    lost = frame[frame["duration_s"].isna()]
    return [f"impossible, as at {key} = {row[key]:g}: {row['reason']}" for _, row in lost[:1].iterrows()]

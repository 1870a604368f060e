"""``thermicon sweep``: one or two keys of the rig over a range, and every number of a run at each value."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import typer

from thermicon.icons.number_text import span

from ..figures.figure_look import SCREEN, Look
from ..figures.print_figure import write_figure
from ..files.cues import pick, read_set, warn_of_site
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate, complete_or_absent
from ..text.messages import Progress, fail, note, progress_bar, usage

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

MOST_VALUES = 10_000
FORM = "give KEY=LOW:HIGH:N, for example contact.area_cm2=4:16:7, or LOW:HIGH:Nlog for equal ratios"


class Study(Protocol):
    """What has a table and a figure."""

    def to_frame(self) -> pd.DataFrame:
        """Return its table."""

    def plot(self) -> Axes:
        """Draw it."""


@dataclass(frozen=True, slots=True)
class Vary:
    """A dotted key of the rig file and the values it takes, in the file's unit."""

    key: str
    values: tuple[float, ...]
    log: bool


def read_varied(texts: Sequence[str]) -> tuple[Vary, ...]:
    """Read every ``--vary``: one key, or two for a grid of all their combinations; more are a usage error."""
    varied = tuple(read_vary(text) for text in texts)
    if len(varied) > 2:
        raise usage(f"{len(varied)} keys are given; at most 2 can be varied, and 2 make a grid", "--vary")
    if len({vary.key for vary in varied}) < len(varied):
        raise usage(f"{varied[0].key} is given twice; a grid needs two different keys", "--vary")
    if (count := math.prod(len(vary.values) for vary in varied)) > MOST_VALUES:
        raise usage(f"{count:,} combinations are more than {MOST_VALUES:,}; use fewer values", "--vary")
    return varied


def read_vary(text: str) -> Vary:
    """Read one ``--vary``; a text of another form is a usage error that shows the form.

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
    second: tuple[str, Sequence[float]] | None = None,
    tail_s: float = 0.0,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Play every icon at every value of a key of the rig.

    Parameters
    ----------
    icons
        Icons to play.
    rig
        Rig to change.
    key
        Dotted key of the rig file.
    values
        Its values, in the unit of the rig file.
    second
        A second key and its values; every combination of both keys is played.
    tail_s
        Time in s that is simulated after the last corner.
    progress
        Called with the number of runs done and their total.

    Returns
    -------
    pandas.DataFrame
        One row per icon and value (or combination). Columns: icon, the key or keys, the fields of
        `thermicon.circuit.Summary`, what the receptors see, and `reason`. Where the rig is impossible or cannot play
        the icon, the row has only the reason.

    Raises
    ------
    RigError
        For a key that no rig has.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import load_library
    >>> step = load_library("six-icons")["cooling-step"]
    >>> frame = sweep([step], Rig.load("thenar"), "driver.current_limit_A", [0.5, 1.5])
    >>> frame["reached"].tolist()
    [False, True]
    """
    import pandas as pd

    from thermicon.circuit.rig.settings import put
    from thermicon.circuit.safety.summary import Summary

    varied = [(key, values), *([second] if second is not None else [])]
    for name, numbers in varied:
        put(json.loads(rig.document), name, float(numbers[0]))
    keys = [name for name, _ in varied]
    combinations = list(itertools.product(*([float(value) for value in numbers] for _, numbers in varied)))
    played: list[Icon] = list(icons)
    rows: list[dict[str, Any]] = []
    for combination in combinations:
        changes = dict(zip(keys, combination, strict=True))
        rows += [{"icon": icon.name, **changes, **_run(icon, rig, changes, tail_s)} for icon in played]
        if progress is not None:
            progress(len(rows), len(played) * len(combinations))
    summary = [field.name for field in fields(Summary) if field.name != "reason"]
    frame = pd.DataFrame(rows, columns=["icon", *keys, *summary, *RECEPTORS, "reason"])
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


def _run(icon: Icon, rig: Rig, changes: Mapping[str, float], tail_s: float) -> dict[str, Any]:
    import numpy

    from thermicon.circuit import InputError, simulate, summarise

    try:
        with numpy.errstate(all="ignore"):  # what overflows ends as a reason
            trace = simulate(icon, rig.with_(**changes), tail_s=tail_s)
    except (InputError, ValueError, ArithmeticError) as problem:
        return {"reason": "; ".join(str(problem).splitlines())}
    return {**summarise(trace).to_dict(), **_receptors(trace)}


def _receptors(trace: Trace) -> dict[str, float | None]:
    from thermicon.perception.observer.observer import CHANNELS
    from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

    seen = [(what(trace, channel)) for channel in CHANNELS for what in (peak_change_K, attack_K_per_s, delay_s)]
    return dict(zip(RECEPTORS, seen, strict=True))


def sweep_file(
    file: str,
    varied: Sequence[Vary],
    icon: str | None,
    rig: Rig,
    tail_s: float,
    output: Path,
    figure: Path | None,
    look: Look = SCREEN,
) -> None:
    """Sweep the icons of a file (or the one named); write the table, draw the figure, report each icon's outcome."""
    check_output(output, TRACE_SUFFIXES, "a sweep")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    check_separate([file], [output, figure])
    icons = pick(whole := read_set([file]), icon)
    warn_of_site(file, whole, rig)
    first, *others = varied
    second = (others[0].key, others[0].values) if others else None
    with progress_bar("sweep") as progress:
        frame = sweep(icons, rig, first.key, first.values, second=second, tail_s=tail_s, progress=progress)
    keys, points = [vary.key for vary in varied], "combinations" if others else "values"
    if frame["duration_s"].isna().all():
        count = math.prod(len(vary.values) for vary in varied)
        reason = frame["reason"].iloc[0]
        fail(f"--vary {' and '.join(keys)}: none of the {count} {points} can be played; the first: {reason}")
    if output != STDOUT:
        with complete_or_absent(output) as draft:
            write_frame(frame, draft)
    if figure is not None:
        write_figure(_figure(frame, varied, look), figure, look)
    lines = [headline(frame[frame["icon"] == each.name], points) for each in icons]
    for line in (*lines, *_impossible(frame, keys)):
        note(line)
    for written in (output, figure):
        if written not in (None, STDOUT):
            note(f"wrote {written}")
    if output == STDOUT:
        typer.echo(frame.to_csv(index=False, float_format="%.9g"), nl=False)


def _figure(frame: pd.DataFrame, varied: Sequence[Vary], look: Look) -> Figure:
    """Lines over one key, heat maps over two."""
    if len(varied) == 1:
        from ..figures.sweep_figure import sweep_figure

        return sweep_figure(frame, varied[0].key, log=varied[0].log, across=look.across(3))
    from ..figures.sweep_map import MOST_ROWS, sweep_map

    if (count := frame["icon"].nunique()) > MOST_ROWS:
        note(f"the figure shows the first {MOST_ROWS} of {count} icons; --icon NAME selects another one")
    return sweep_map(frame, varied[0].key, varied[1].key)


def write_study(found: Study, output: Path | None, figure: Path | None, look: Look = SCREEN) -> bool:
    """Write table and figure of a study where asked for; whether its table went to stdout, in place of a summary."""
    if output is not None and output != STDOUT:
        with complete_or_absent(output) as draft:
            write_frame(found.to_frame(), draft)
        note(f"wrote {output}")
    if figure is not None:
        drawn: Any = found.plot().figure
        write_figure(drawn, figure, look)
        note(f"wrote {figure}")
    if output == STDOUT:
        typer.echo(found.to_frame().to_csv(index=False, float_format="%.9g"), nl=False)
    return output == STDOUT


def write_frame(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as ``.parquet`` or ``.csv``, by its suffix."""
    if path.suffix == ".parquet":
        frame.to_parquet(path, index=False)
    else:
        frame.to_csv(path, index=False, float_format="%.9g", lineterminator="\n")


def headline(rows: pd.DataFrame, points: str = "values") -> str:
    """Report at how many points one icon was reached, and how large its misses are."""
    ran = rows[rows["duration_s"].notna()]
    judged = ran[ran["reached"].notna()]
    if len(judged):
        miss = judged["largest_miss_K"].abs()
        low, high = float(miss.min()), float(miss.max())
        miss_text = "everywhere within 1 mK" if high < 1e-3 else f"largest miss {span(low, high, 'K', 3)}"
        parts = [f"reached at {int(judged['reached'].sum())} of {len(rows)} {points}", miss_text]
    else:
        parts = [f"played at {len(ran)} of {len(rows)} {points}"]
    if unsafe := int((~ran["safe"]).sum()):
        parts.append(f"NOT SAFE at {unsafe}")
    if len(ran) < len(rows):
        parts.append(f"impossible at {len(rows) - len(ran)}")
    return f"{rows['icon'].iloc[0]}: {', '.join(parts)}"


def _impossible(frame: pd.DataFrame, keys: Sequence[str]) -> list[str]:
    """Return the first reason why a point could not be played, as a line; none where all could."""
    lost = frame[frame["duration_s"].isna()]
    return [
        f"impossible, as at {', '.join(f'{key} = {row[key]:g}' for key in keys)}: {row['reason']}"
        for _, row in lost[:1].iterrows()
    ]

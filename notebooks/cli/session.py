"""``thermicon simulate --order`` or ``--random``: a session as one run, with one verdict and one row per play."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from ..files.outputs import TRACE_SUFFIXES, check_output, check_separate
from ..messages import note, progress_bar
from ..report.gate_words import CAUTION
from ..report.run_report import session_report
from ..report.terminal import show
from .options import FigureOptions, read_set, warn_of_site, write_text

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Session
    from thermicon.icons import IconSet

NUMBERS, ORDER = ".json", ".txt"


def session_file(
    file: str,
    rig: Rig,
    order: Path | None,
    repeats: int | None,
    gap_s: float,
    seed: int,
    tracking: str | None,
    output: Path | None,
    figure: FigureOptions,
) -> None:
    """Simulate a session with the icons of a file, in the order of a file or shuffled; print and write the report."""
    from thermicon.circuit import SessionPlan, play_session
    from thermicon.circuit.safety.session import check_repeats, order_text, read_order

    from .simulate import write_traces

    if output is not None:
        check_output(output, (*TRACE_SUFFIXES, NUMBERS, ORDER), "a session")
    check_separate([file] if order is None else [file, order], (output, figure.figure))
    icons = read_set([file])
    if order is not None:
        plan = SessionPlan(read_order(order, icons), gap_s)
    else:
        check_repeats(repeats or 1, len(icons), "icons")
        plan = SessionPlan.shuffled([icon.name for icon in icons], repeats or 1, seed=seed, gap_s=gap_s)
    warn_of_site(file, icons, rig)
    with progress_bar("worst case") as progress:
        played = [icons[name] for name in plan.names]
        session = play_session(played, plan, rig, tracking=tracking or "replay", progress=progress)
    if output is not None and output.suffix == ORDER:
        write_text(order_text(plan), output)
    elif output is not None and output.suffix == NUMBERS:
        write_text(session_text(session, icons, rig), output)
    elif output is not None:
        write_traces([session.trace], output)
        note(f"wrote {output}")
    if figure.figure is not None:
        from ..figures.session_figure import session_figure

        figure.write(session_figure(session))
    show(session_report(session))
    note(CAUTION)


def session_text(session: Session, icons: IconSet, rig: Rig) -> str:
    """The session as JSON text; missing values are null."""
    facts = {
        "thermicon": version("thermicon"),
        "content_hash": icons.content_hash,
        **session.to_dict(),
        "rig_changes": list(rig.changes),
        "rig_text": rig.document,
    }
    return json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

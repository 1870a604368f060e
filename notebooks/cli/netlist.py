"""``thermicon netlist``: the circuit that ``simulate`` computes, as a file for LTspice and ngspice."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ..files.outputs import NETLIST_SUFFIXES, STDOUT, check_output, complete_or_absent
from ..text.messages import note
from .cues import only, read_set, warn_of_site
from .simulate import headline

if TYPE_CHECKING:
    from thermicon.circuit import Rig


def netlist_file(file: str, icon: str | None, rig: Rig, tail_s: float, output: Path, record: str | None) -> None:
    """Write the circuit of a rig that plays an icon; with ``record``, ngspice writes all probes into that file."""
    from thermicon.circuit import netlist, simulate
    from thermicon.circuit.solver.inverse import design

    check_output(output, NETLIST_SUFFIXES, "a netlist")
    icons = read_set([file])
    played = only(icons, icon, file)
    warn_of_site(file, icons, rig)
    trace = simulate(played, rig, tail_s=tail_s)
    plan = design(played, rig, float(trace.time_s[-1]))
    title = f"{played.name} of {Path(file).name}"
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, title=title, out_file=record)
    if output == STDOUT:
        typer.echo(text, nl=False)
    else:
        with complete_or_absent(output) as draft:
            draft.write_text(text, encoding="ascii", newline="\n")
    note(headline(trace))
    if output != STDOUT:
        note(f"wrote {output}; {_how_to_run(output, record)}")


def _how_to_run(output: Path, record: str | None) -> str:
    if record is not None:
        return f"ngspice -b {output.name} writes the probes into {record}"
    return f"open it in LTspice, or run ngspice -b -r {output.stem}.raw {output.name}"

"""``thermicon simulate -o OUT.cir``: the circuit of a rig for LTspice and ngspice, with an icon or alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..files.outputs import NETLIST_SUFFIXES, SUBCIRCUIT_SUFFIXES, check_output, check_separate
from ..messages import note
from .cues import only, read_set, warn_of_site
from .options import write_text

if TYPE_CHECKING:
    from thermicon.circuit import Rig

NGSPICE = ".sp"
"""The ending of a netlist that makes ngspice write all probes; LTspice does not read that."""


def subcircuit_file(rig: Rig, output: Path) -> None:
    """Write module and skin of a rig as a library of subcircuits."""
    from thermicon.circuit.delivery.subcircuit import subcircuits

    check_output(output, SUBCIRCUIT_SUFFIXES, "a library of subcircuits")
    text = subcircuits(rig)
    more = f": thermicon_module and thermicon_skin; in a schematic, .include {output.name}"
    write_text(text, output, more, "ascii")


def netlist_file(file: str, icon: str | None, rig: Rig, tail_s: float, output: Path) -> None:
    """Write the circuit of a rig that plays an icon; what ends with .sp makes ngspice write all probes."""
    from thermicon.circuit import netlist, simulate
    from thermicon.circuit.delivery.netlist_landing import lead_s
    from thermicon.circuit.solver.inverse import design

    from .simulate import headline

    check_output(output, NETLIST_SUFFIXES, "a netlist")
    record = f"{output.stem}.txt" if output.suffix.lower() == NGSPICE else None
    check_separate([file], [output])
    icons = read_set([file])
    played = only(icons, icon, file)
    warn_of_site(file, icons, rig)
    trace = simulate(played, rig, tail_s=tail_s)
    plan = design(played, rig, float(trace.time_s[-1]))
    title = f"{played.name} of {Path(file).name}"
    text = netlist(rig, plan.drive, rest_A=plan.rest_A, lead_A=plan.lead_A, title=title, out_file=record)
    note(headline(trace))
    if rig.contact.lands_s is not None:
        note(f"the netlist's clock begins when the hand lands; the cue begins at {lead_s(rig):g} s")
    how = f"open it in LTspice, or run ngspice -b -r {output.stem}.raw {output.name}"
    if record is not None:
        how = f"ngspice -b {output.name} writes the probes into {record}"
    write_text(text, output, f"; {how}", "ascii")

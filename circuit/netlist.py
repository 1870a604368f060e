"""The same circuit as text for ngspice and LTspice.

1 V is 1 °C and 1 A is 1 W; the drive is the source Vdrive on node i, whose 1 V is 1 A of drive current.
"""

from __future__ import annotations

from thermicon.circuit.drive import Drive
from thermicon.circuit.module import ZERO_C_IN_K
from thermicon.circuit.network import PROBES, network_of
from thermicon.circuit.rig import Rig

EDGE_S = 1e-6
"""Width of the flank that stands for a jump of a held current."""


def node_name(place: int, lumps: int) -> str:
    """Name of the circuit node of a place in the state vector (hot, cold, s1 … sN, deep)."""
    if place < 2:
        return ("hot", "cold")[place]
    return "deep" if place == lumps + 2 else f"s{place - 1}"


def netlist(
    rig: Rig, drive: Drive, *, rows_Hz: float = 100.0, out_file: str | None = None, reltol: float = 1e-6
) -> str:
    """Return a netlist of a rig and a drive; its run starts from the steady state of the drive's first current.

    With `out_file`, ngspice in batch mode writes every temperature probe (PROBES ending in `_C`) there, in order.

    >>> text = netlist(Rig.load("shani2021"), Drive([0, 1], [0.1, 0.1]))
    >>> [line for line in text.splitlines() if line.startswith("Rsink")]
    ['Rsink sink hot 0.2']
    """
    net, module = network_of(rig), rig.module
    n = len(net.capacity_J_per_K)
    alpha, ohm, theta = module.seebeck_V_per_K, module.resistance_ohm, module.thermal_resistance_K_per_W
    joule = f"{ohm / 2!r}*V(i)*V(i)"
    lines = [
        f"* thermicon: rig {rig.name}; 1 V = 1 degC, 1 A = 1 W, V(i) = drive current in A",
        f"Vsink sink 0 {rig.heat_sink.temperature_C!r}",
        f"Rsink sink hot {rig.heat_sink.resistance_K_per_W!r}",
        f"Chot hot 0 {module.hot_plate_J_per_K!r}",
        f"Ccold cold 0 {module.cold_plate_J_per_K!r}",
        f"Rmodule hot cold {theta!r}",
        f"Bcold cold 0 I={alpha!r}*(V(cold)+{ZERO_C_IN_K!r})*V(i)-{joule}",
        f"Bhot 0 hot I={alpha!r}*(V(hot)+{ZERO_C_IN_K!r})*V(i)+{joule}",
        f"Vdeep deep 0 {net.deep_C!r}",
    ]
    for i in range(n + 1):
        above, below = node_name(i + 1, n), node_name(i + 2, n)
        lines.append(f"R{i + 1} {above} {below} {1 / float(net.conductance_W_per_K[i])!r}")
    for i in range(n):
        name = node_name(i + 2, n)
        lines.append(f"C{name} {name} 0 {float(net.capacity_J_per_K[i])!r}")
        if net.perfusion_W_per_K[i] > 0:
            lines.append(f"Rblood{name} {name} deep {1 / float(net.perfusion_W_per_K[i])!r}")
    lines.append("Vdrive i 0 PWL(")
    lines += [f"+ {time!r} {current!r}" for time, current in _points(drive)]
    lines.append("+ )")
    lines += _probe_lines(rig)
    end, step = float(drive.time_s[-1]), 1.0 / rows_Hz
    lines += [f".options reltol={reltol!r} abstol=1e-12 vntol=1e-9", f".tran {step!r} {end!r} 0 {step!r}"]
    if out_file is not None:
        wanted = " ".join(f"v(p{row})" for row, probe in enumerate(PROBES) if probe.endswith("_C"))
        lines += [
            ".control",
            "set wr_singlescale",
            "set numdgt=15",
            "run",
            f"wrdata {out_file} {wanted}",
            "quit 0",
            ".endc",
        ]
    return "\n".join([*lines, ".end", ""])


def _probe_lines(rig: Rig) -> list[str]:
    net, lines = network_of(rig), []
    n = len(net.capacity_J_per_K)
    for row, probe in enumerate(PROBES):
        start = int(net.probe_start[row])
        terms = [
            f"{float(weight)!r}*V({node_name(start + k, n)})"
            for k, weight in enumerate(net.probe_weight[row])
            if weight
        ]
        lines.append(f"Bp{row} p{row} 0 V={'+'.join(terms).replace('+-', '-')}")
        lines.append(f"* p{row} = {probe}")
    return lines


def _points(drive: Drive) -> list[tuple[float, float]]:
    times, currents = drive.time_s.tolist(), drive.current_A.tolist()
    if not drive.held:
        return list(zip(times, currents, strict=True))
    points, before = [(0.0, currents[0])], currents[0]
    for time, current in zip(times[1:], currents[1:], strict=True):
        if current != before:
            points += [(time - EDGE_S / 2, before), (time + EDGE_S / 2, current)]
        before = current
    return [*points, (times[-1] + 1.0, before)]

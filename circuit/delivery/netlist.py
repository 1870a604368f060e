"""The circuit as a netlist that both LTspice and ngspice read.

After Fig. 2b of Shani & Lineykin 2021: electrical side in V and A; thermal side 1 V is 1 °C and 1 A is 1 W.
"""

import re
import string
import textwrap
from collections.abc import Iterator

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError, shipped_text
from thermicon.base.numbers.program import own_version

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import AnyRig, Rig
from ..solver.drive import Drive
from ..solver.network import RECORDED, Network, network_of

LONGEST_STEP_S = 2.5e-3
"""Longest step for either program: at 10 ms a steep ramp of the current costs them 2 mK."""

ROWS_HZ = 100.0
"""Rows per second that ngspice writes."""

RELATIVE_TOLERANCE = 1e-6
"""Of the solver of either program."""

LEAST_PERFUSION_W_PER_K = 1e-12
"""Perfusion below this has no resistor: it would be larger than either program reads."""

HOLDING_W_PER_K = 1e6
"""Conductance that holds a passive heat sink where it starts, in the operating point alone."""

WRITTEN_BY_NGSPICE = ("i(vsense)", "v(plus)", *(f"v({probe})" for probe in RECORDED))
"""What ngspice writes besides the time: current, voltage at the module, and the RECORDED quantities."""


@checked
def netlist(
    rig: AnyRig,
    drive: Drive,
    *,
    rest_A: float | None = None,
    title: str = "drive",
    out_file: str | None = None,
) -> str:
    """Return a netlist of a rig and a drive that LTspice and ngspice both read.

    Parameters
    ----------
    rig, drive
        A rig with a module, or the name or file of one, and the current that it plays.
    rest_A
        Current in A whose steady state the run starts from (`Design.rest_A`); the drive's first current follows 1 µs
        later. None: the drive's first current.
    title
        First line of the netlist.
    out_file
        Adds a control section, with which `ngspice -b` writes WRITTEN_BY_NGSPICE to this file, one row per time in s.

    Returns
    -------
    str
        The netlist.

    Raises
    ------
    RigError
        For a thermode, and where there is no steady state to start from.

    Examples
    --------
    >>> text = netlist(Rig.load("shani2021"), Drive([0, 1], [0.1, 0.1]))
    >>> [line for line in text.splitlines() if line.startswith(("Gdriver", "Rcontact"))]
    ['Gdriver 0 plus command 0 0.1', 'Rcontact cold skin 0.6']
    """
    rig = Rig.of(rig)
    net = network_of(rig)
    names, skin = _skin(rig, net)
    end, step = float(drive.time_s[-1]), 1.0 / ROWS_HZ
    lines = [
        *_header(rig, names, title),
        *_electrical(rig, points(drive, rest_A)),
        *_module(rig),
        *_sink(rig),
        *skin,
        *_probes(net, names),
        "*",
        f".options reltol={RELATIVE_TOLERANCE!r} abstol=1e-12 vntol=1e-9",
        f".tran {step!r} {end!r} 0 {min(step, LONGEST_STEP_S)!r}",
    ]
    if out_file is not None:
        lines += [".control", "set wr_singlescale", "set wr_vecnames", "set numdgt=15", "run"]
        lines += [f"wrdata {_quoted(out_file)} {' '.join(WRITTEN_BY_NGSPICE)}", "quit 0", ".endc"]
    return "\n".join([*lines, ".end", ""])


def _quoted(name: str) -> str:
    """The name of a file as ngspice's control language accepts it; InputError where it cannot."""
    if not re.fullmatch(r"[\w./\\:+ -]+", name):
        raise InputError(
            f"{name!r}: ngspice cannot write to a file of this name; use letters, digits, blanks and . / : + - _"
        )
    return f"'{name}'" if " " in name else name


def _header(rig: Rig, names: list[str], title: str) -> Iterator[str]:
    driver = rig.driver
    yield from _comment(f"{title} on rig {rig.name}, written by thermicon {own_version()}")
    if rig.title:
        yield from _comment(rig.title)
    rest = "The operating point is the steady state of the current that is commanded at 0 s."
    if rig.probes:
        left_out = ", ".join(probe.name for probe in rig.probes)
        rest = f"Not in this file: the rig's own probes with their lags ({left_out}).\n{rest}"
    text = string.Template(shipped_text("data/netlist-header.txt")).substitute(
        gain=repr(driver.transconductance_A_per_V),
        compliance=repr(driver.voltage_limit_V),
        inside=f"{names[2] if names[2] != 'skin' else names[3]} ... {names[-2]}",
        temperatures=", ".join(probe for probe in RECORDED if probe.endswith("_C")),
        flows=", ".join(probe for probe in RECORDED if not probe.endswith("_C")),
        rest=rest,
    )
    for line in text.splitlines():
        yield from [line] if line.startswith("*") else _comment(line)


def _electrical(rig: Rig, corners: list[tuple[float, float]]) -> Iterator[str]:
    gain = rig.driver.transconductance_A_per_V
    yield from _section("driver: a voltage-controlled current source")
    yield "Vcommand command 0 PWL("
    yield from (f"+ {time!r} {current / gain!r}" for time, current in corners)
    yield "+ )"
    yield f"Gdriver 0 plus command 0 {gain!r}"
    yield from _section("the module's electrical port")
    yield "Vsense plus ohmic 0"
    yield f"Rmodule ohmic seebeck {rig.module.resistance_ohm!r}"
    yield f"Bseebeck seebeck 0 V={rig.module.seebeck_V_per_K!r}*(V(hot)-V(cold))"


def _module(rig: Rig) -> Iterator[str]:
    module, alpha = rig.module, repr(rig.module.seebeck_V_per_K)
    joule = f"{module.resistance_ohm / 2!r}*I(Vsense)*I(Vsense)"
    yield from _section(f"the module's thermal side; {ZERO_C_IN_K!r} makes kelvin of degC")
    yield f"Bcold cold 0 I={alpha}*(V(cold)+{ZERO_C_IN_K!r})*I(Vsense)-{joule}"
    yield f"Bhot 0 hot I={alpha}*(V(hot)+{ZERO_C_IN_K!r})*I(Vsense)+{joule}"
    yield f"Rtheta hot cold {module.thermal_resistance_K_per_W!r}"
    yield f"Chot hot 0 {module.hot_plate_J_per_K!r}"
    yield f"Ccold cold 0 {module.cold_plate_J_per_K!r}"


def _sink(rig: Rig) -> Iterator[str]:
    """The heat sink: ideal or passive."""
    sink = rig.heat_sink
    yield from _section("heat sink")
    yield f"Rsink sink hot {sink.resistance_K_per_W!r}"
    if (passive := sink.passive) is not None:
        yield f"Rair sink air {passive.air_resistance_K_per_W!r}"
        yield f"Vair air 0 {passive.air_C!r}"
        yield f"Csink sink 0 {passive.capacity_J_per_K!r}"
        if not passive.steady:
            yield "* held at its starting temperature in the operating point, then free"
            yield f"Bstart sink 0 I=V(held)*(V(sink)-{sink.temperature_C!r})*{HOLDING_W_PER_K!r}"
            yield f"Vheld held 0 PWL(0 1 {EDGE_S!r} 0)"
        return
    yield f"Vsink sink 0 {sink.temperature_C!r}"


def _skin(rig: Rig, net: Network) -> tuple[list[str], list[str]]:
    """Names of the nodes of the state vector, and the lines from the display down to the deep node."""
    count = len(net.capacity_J_per_K)
    names = ["hot", "cold", *(f"s{i + 1}" for i in range(count)), "deep"]
    resistance = [1 / float(conductance) for conductance in net.conductance_W_per_K]
    contact = rig.contact.resistance_m2K_per_W / rig.contact.area_m2
    lines, in_face = list(_section("contact")), resistance[0] - contact < 1e-9 * resistance[0]
    names[2] = "skin" if in_face else names[2]  # the first lump may lie in the face
    lines.append(f"Rcontact cold skin {contact!r}")
    if not in_face:
        lines.append(f"Rface skin {names[2]} {resistance[0] - contact!r}")
    lines += _section("skin")
    ends, layer = np.cumsum([layer.thickness_m for layer in rig.skin.layers]).tolist(), -1
    for i in range(count):
        depth = float(rig.column.depth_m[i])
        while layer + 1 < len(ends) and (layer < 0 or depth >= ends[layer] - 1e-9):
            layer += 1
            lines += _comment(f"{rig.skin.layers[layer].name}, down to {ends[layer] * 1e3:.4g} mm")
        name, below = names[2 + i], names[3 + i]
        lines.append(f"* {name}: {depth * 1e3:.4g} mm")
        lines.append(f"C{name} {name} 0 {float(net.capacity_J_per_K[i])!r}")
        if net.perfusion_W_per_K[i] > LEAST_PERFUSION_W_PER_K:
            lines.append(f"Rblood_{name} {name} blood {1 / float(net.perfusion_W_per_K[i])!r}")
        lines.append(f"R{name}_{below} {name} {below} {resistance[i + 1]!r}")
    return names, [*lines, f"Vdeep deep 0 {net.deep_C!r}", f"Vblood blood 0 {net.deep_C!r}"]


def _probes(net: Network, names: list[str]) -> Iterator[str]:
    yield from _section("probes")
    for row, probe in enumerate(RECORDED):
        start = int(net.probe_start[row])
        terms = [f"{float(weight)!r}*V({names[start + k]})" for k, weight in enumerate(net.probe_weight[row]) if weight]
        yield f"B{probe} {probe} 0 V={'+'.join(terms).replace('+-', '-')}"


def _section(what: str) -> Iterator[str]:
    yield "*"
    yield from _comment(f"--- {what} ---")


def _comment(text: str) -> list[str]:
    """Comment lines; only ASCII, since LTspice reads other letters in its own code page."""
    indent = " " * (len(text) - len(text.lstrip()))
    for sign, plain in (("°", "deg"), ("µ", "u"), ("²", "2"), ("–", "-"), ("×", "x")):
        text = text.replace(sign, plain)
    plain = " ".join(text.encode("ascii", "replace").decode("ascii").split())
    return textwrap.wrap(plain, 110, initial_indent=f"* {indent}", subsequent_indent=f"* {indent}  ")


EDGE_S = 1e-6
"""Width of the flank that replaces a jump of a held current; less where rows are closer than four of these."""


def points(drive: Drive, rest_A: float | None) -> list[tuple[float, float]]:
    """Corners of a drive's current: (time s, A), a flank of 1 µs for each jump."""
    times, currents = drive.time_s.tolist(), drive.current_A.tolist()
    start: list[tuple[float, float]] = [(0.0, currents[0])]
    if rest_A is not None and rest_A != currents[0]:
        edge = min(EDGE_S, times[1] / 4)
        slope = 0.0 if drive.held else (currents[1] - currents[0]) / times[1]
        start = [(0.0, float(rest_A)), (edge, currents[0] + slope * edge)]
    if not drive.held:
        return [*start, *zip(times[1:], currents[1:], strict=True)]
    points, before = start, currents[0]
    for k in range(1, len(times) - 1):
        if currents[k] != before:
            half = min(EDGE_S / 2, (times[k] - times[k - 1]) / 4, (times[k + 1] - times[k]) / 4)
            points += [(times[k] - half, before), (times[k] + half, currents[k])]
            before = currents[k]
    return [*points, (times[-1], before)]

"""``thermicon doctor``: whether the installation is sound, each check on its own, and what cures it where it is not."""

from __future__ import annotations

import json as json_text
import platform
import sys
import tomllib
from collections.abc import Callable, Iterator
from importlib import resources
from importlib.metadata import PackageNotFoundError, version
from math import nan
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import typer

from ..messages import BAD_INPUT
from .options import flag

PROGRAM = "thermicon"
PIP = f'"{sys.executable}" -m pip'
REPORTED = ("numpy", "scipy", "pandas", "matplotlib", "numba", "pydantic", "typer", "jupyterlab", "ipywidgets")
"""Packages whose versions a report of a fault should state."""
EXTRAS = {
    "hardware": ("npTDMS", "drives in TDMS, the format of National Instruments"),
    "parquet": ("pyarrow", "traces in Parquet (simulate -o OUT.parquet)"),
    "cluster": ("distributed", "ranking on a dask cluster (rank --workers ADDRESS)"),
    "calibrate": ("emcee", "sampling the constants of the observer again (python -m thermicon.perception.evidence)"),
    "study": ("questplus", "QUEST+ threshold runs in a study ([threshold])"),
}
"""The package that each extra brings, and what it is for; extras that only developers need are left out."""
KERNEL = "python3"
"""The kernel that the shipped notebooks name."""
REINSTALL = "install thermicon again in a new environment; if that does not help, report it with doctor --json"


class Finding(NamedTuple):
    """What a check found: one line, and the cure where the state is not ``ok``.

    A note costs something that can be done without; a fault keeps thermicon from working or from being right.
    """

    check: str
    state: Literal["ok", "note", "fault"]
    text: str
    cure: str | None = None

    @property
    def line(self) -> str:
        """The finding as one line of text."""
        return f"{self.state:<5}  {self.check}: {self.text}{'' if self.cure is None else f'; {self.cure}'}"


def doctor_command(
    json: Annotated[bool, flag("--json", "Print one JSON object instead of lines.")] = False,
) -> None:
    """Check the installation: versions, extras, the cache, the kernel of Jupyter, and a self-test.

    Every line is ok, a note (something that can be done without) or a fault, with its cure. With a fault, the exit code
    is 1.
    """
    findings: list[Finding] = []
    for finding in examine():
        findings.append(finding)
        if not json:
            typer.echo(finding.line)
    faults, notes = (sum(each.state == state for each in findings) for state in ("fault", "note"))
    if json:
        found = {
            PROGRAM: installed_version(PROGRAM),
            "ok": not faults,
            "findings": [each._asdict() for each in findings],
        }
        typer.echo(json_text.dumps(found, indent=1))
    elif faults:
        typer.echo(
            f"\n{faults} fault{'s' * (faults > 1)}: what stands behind each of them cures it. Begin with the first."
        )
    elif notes:
        typer.echo(f"\nthermicon works. {notes} note{'s' * (notes > 1)}: something optional can be added.")
    else:
        typer.echo("\nNothing is missing.")
    raise typer.Exit(BAD_INPUT if faults else 0)


def examine() -> Iterator[Finding]:
    """Make every check, the slowest last; one that cannot be made is a fault, and the others are still made."""
    for name, check in CHECKS.items():
        try:
            yield from check()
        except Exception as error:
            said = (str(error).strip().splitlines() or [""])[0]
            cure = "mend the faults above, then run this again; else install thermicon in a new environment"
            yield Finding(name, "fault", f"cannot be checked ({type(error).__name__}: {said})", cure)


def check_python() -> Iterator[Finding]:
    """State the Python that runs, and on what; and the installed thermicon."""
    text = f"{platform.python_version()} ({sys.executable}) on {platform.platform(terse=True)} {platform.machine()}"
    yield Finding("Python", "ok", _readable(text))
    here, found = _readable(str(Path(__file__).parents[1])), installed_version(PROGRAM)
    if found is None:
        cure = f"in the folder of its pyproject.toml: {PIP} install -e ."
        yield Finding(PROGRAM, "fault", f"runs from {here}, but is not installed", cure)
    else:
        yield Finding(PROGRAM, "ok", f"{found} in {here}")


def _readable(text: str) -> str:
    """Letters of paths that Python read without knowing their encoding, as with LC_ALL=C."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def check_required() -> Iterator[Finding]:
    """State the versions of the packages that matter most; one that is missing is a fault."""
    found = {name: installed_version(name) for name in REPORTED}
    for name in (name for name, there in found.items() if there is None):
        yield Finding("packages", "fault", f"{name} is not installed", f"{PIP} install {PROGRAM}")
    yield Finding("packages", "ok", ", ".join(f"{name} {there}" for name, there in found.items() if there))


def check_extras() -> Iterator[Finding]:
    """Look which extras are installed."""
    for extra, (package, purpose) in EXTRAS.items():
        if installed_version(package) is not None:
            yield Finding(f"extra {extra}", "ok", f"for {purpose}")
        else:
            cure = f'{PIP} install "{PROGRAM}[{extra}]"'
            yield Finding(f"extra {extra}", "note", f"not installed, for {purpose}", cure)


def check_cache() -> Iterator[Finding]:
    """Look whether compiled code can be kept, and how much is kept."""
    from thermicon.icons.atomic import NotPrivate, cache_folder, compiled_folder, private_folder

    cache = cache_folder()
    try:
        private_folder(compiled_folder(version("numba"), version("llvmlite")))
    except NotPrivate as problem:
        text = f"nothing can be kept, so that every run compiles its code again, about half a minute ({problem})"
        yield Finding("cache", "note", text, "set THERMICON_CACHE to a folder that only you can write to")
        return
    total = sum(path.lstat().st_size for path in cache.rglob("*") if path.is_file()) / 1e6
    yield Finding("cache", "ok", f"{cache}, writable, {total:.0f} MB; nothing but time is lost where it is deleted")


def check_kernel() -> Iterator[Finding]:
    """Look which Python runs the notebooks: it has to be the one that thermicon is installed in."""
    from jupyter_client.kernelspec import KernelSpecManager

    kernel = KernelSpecManager().get_kernel_spec(KERNEL)
    python = str(kernel.argv[0]) if kernel.argv else ""
    own = Path(python).name == python and python.startswith("python")  # by jupyter_client, the server's own
    # Links to another environment's interpreter are not followed, which would leave the environment.
    if own or Path(python).parent.resolve() == Path(sys.executable).parent.resolve():
        yield Finding("kernel", "ok", f"{KERNEL} runs {'the Python of the notebook server' if own else python}")
        return
    text = f"notebooks do not find thermicon: {KERNEL} runs {python} and not {sys.executable} ({kernel.resource_dir})"
    yield Finding("kernel", "fault", text, f"{sys.executable} -m ipykernel install --sys-prefix")


def stored() -> dict[str, Any]:
    """The icon, the rig, and the numbers of the self-test, with how far they may differ between machines."""
    return tomllib.loads((resources.files("thermicon.notebooks") / "data" / "self-test.toml").read_text("utf-8"))


def compute(case: dict[str, Any]) -> dict[str, float]:
    """Play the icon of the self-test and predict what is felt; the numbers by the names under which they are stored."""
    from thermicon.circuit import Rig, simulate
    from thermicon.icons import load_library
    from thermicon.perception import perceive

    trace = simulate(load_library(case["set"])[case["icon"]], Rig.load(case["rig"]), tail_s=10.0)
    percept = perceive(trace)
    return {
        "largest current": float(abs(trace.current_A).max()),
        "coldest skin": float(trace.skin_C.min()),
        "coldest cold receptor": float(trace.cold_receptor_C.min()),
        "detected probability": percept.detected_probability,
        "onset": nan if percept.onset_s is None else percept.onset_s,
        "peak of the cold channel": float(percept.psi_cold.max()),
    }


def check_self_test() -> Iterator[Finding]:
    """Compare the numbers of the self-test with the stored ones."""
    case = stored()
    computed, wrong = compute(case), False
    played = f"{case['icon']} of {case['set']} on the {case['rig']} rig"
    for each in case["number"]:
        value, wanted, within, unit = computed[each["name"]], each["value"], each["tolerance"], each["unit"]
        if not abs(value - wanted) <= within:
            wrong = True
            text = f"{played}: {each['name']} is {value:g} {unit} and should be {wanted:g} ± {within:g} {unit}"
            yield Finding("self-test", "fault", text, REINSTALL)
    if not wrong:
        yield Finding("self-test", "ok", f"{played} gives the {len(case['number'])} stored numbers")


CHECKS: dict[str, Callable[[], Iterator[Finding]]] = {
    "Python": check_python,
    "packages": check_required,
    "extras": check_extras,
    "cache": check_cache,
    "kernel": check_kernel,
    "self-test": check_self_test,
}


def installed_version(name: str) -> str | None:
    """The version of an installed distribution, None where there is none."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None

"""``thermicon doctor``: independent checks of the installation."""

import json as json_text
import platform
import sys
import tomllib
from collections.abc import Callable
from importlib import resources
from importlib.metadata import version
from math import nan
from pathlib import Path
from typing import Annotated, Any

import typer

from ..messages import BAD_INPUT
from .options import flag

REPORTED = ("numpy", "scipy", "pandas", "matplotlib", "numba", "pydantic", "typer", "jupyterlab", "ipywidgets")
"""Packages whose versions a report of a fault should state."""
CURE = "install thermicon again in a new environment; if that does not help, report it with doctor --json"


def doctor_command(json: Annotated[bool, flag("--json", "Print one JSON object instead of lines.")] = False) -> None:
    """Check the installation: Python, versions of packages, the cache, and the numbers of one icon.

    Every line is ok, a note (something that can be done without) or a fault, with its cure. With a fault, the exit code
    is 1.
    """
    findings: list[dict[str, str | None]] = []
    for name, check in CHECKS.items():
        try:
            state, text, cure = check()
        except Exception as error:  # the others are still made
            said = (str(error).strip().splitlines() or [""])[0]
            state, text, cure = "fault", f"cannot be checked ({type(error).__name__}: {said})", CURE
        findings.append({"check": name, "state": state, "text": text, "cure": cure})
        if not json:
            typer.echo(f"{state:<5}  {name}: {text}{'' if cure is None else f'; {cure}'}")
    sound = all(each["state"] != "fault" for each in findings)
    if json:
        typer.echo(json_text.dumps({"thermicon": version("thermicon"), "ok": sound, "findings": findings}, indent=1))
    raise typer.Exit(0 if sound else BAD_INPUT)


Found = tuple[str, str, str | None]
"""The state (ok, note, fault), what was found, and the cure."""


def check_python() -> Found:
    """State the Python that runs, on what, and the installed thermicon."""
    runs = f"{platform.python_version()} ({sys.executable}) on {platform.platform(terse=True)} {platform.machine()}"
    text = f"{runs}; thermicon {version('thermicon')} in {Path(__file__).parents[1]}"
    # letters of paths that Python read without knowing their encoding, as with LC_ALL=C
    return "ok", text.encode("utf-8", "surrogateescape").decode("utf-8", "replace"), None


def check_packages() -> Found:
    """State the versions of the packages that matter most; one that is missing is a fault."""
    return "ok", ", ".join(f"{name} {version(name)}" for name in REPORTED), None


def check_cache() -> Found:
    """Look whether compiled code and verdicts can be kept, and how much is kept."""
    from thermicon.base.files.cache_folder import NotPrivate, cache_folder, compiled_folder, private_folder

    cache = cache_folder()
    try:
        private_folder(compiled_folder(version("numba"), version("llvmlite")))
    except NotPrivate as problem:
        again = "every run compiles its code again, about half a minute, and judges its drives again"
        text = f"nothing can be kept, so that {again} ({problem})"
        return "note", text, "set THERMICON_CACHE to a folder that only you can write to"
    total = sum(path.lstat().st_size for path in cache.rglob("*") if path.is_file()) / 1e6
    return "ok", f"{cache}, writable, {total:.0f} MB; nothing but time is lost where it is deleted", None


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


def check_self_test() -> Found:
    """Compare the numbers of the self-test with the stored ones."""
    case = stored()
    computed = compute(case)
    wrong = [
        f"{each['name']} is {value:g} {each['unit']} and should be {each['value']:g} ± {each['tolerance']:g}"
        for each in case["number"]
        if not abs((value := computed[each["name"]]) - each["value"]) <= each["tolerance"]
    ]
    played = f"{case['icon']} of {case['set']} on the {case['rig']} rig"
    if wrong:
        return "fault", f"{played}: {'; '.join(wrong)}", CURE
    return "ok", f"{played} gives the {len(case['number'])} stored numbers", None


CHECKS: dict[str, Callable[[], Found]] = {
    "Python": check_python,
    "packages": check_packages,
    "cache": check_cache,
    "self-test": check_self_test,
}

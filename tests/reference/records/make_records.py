"""Records of what the program computes, made through its command line, so that any commit can make or check them.

``python make_records.py`` writes `*.json` beside this file; ``--check`` writes nothing and prints what differs;
``--thermicon PATH`` takes the program of another checkout. A record holds digests, which are those of one kind of
processor, and key numbers, which any processor reproduces to TOLERANCE.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import math
import random
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
TOLERANCE = 1e-6
"""Largest relative difference of a number between two kinds of processors."""
SETS = ("six-icons", "pulse-sequences", "wave-shapes", "wave-confusions", "wilson-ramps", "cooling-step-skin")
SEEDS = (0, 1, 2)
EXPORTS = (
    *((name, "thenar", "csv") for name in (*SETS, "calibration-drive")),
    *(("six-icons", rig, "csv") for rig in ("fingertip", "forearm", "hand-dorsum")),
    *(("six-icons", "thenar", form) for form in ("setpoint-csv", "tdms", "c-array", "psychopy")),
    *(("six-icons", "tcs2", form) for form in ("tcs2-serial", "csv")),
)
FITTED = "contact.resistance_m2K_per_W,module.seebeck_V_per_K,module.resistance_ohm"
TIED_TO_THE_CODE = {"thermicon", "program", "code_sha256", "sidecar_sha256"}

Run = Callable[..., subprocess.CompletedProcess[str]]


def numbers(value: Any, place: str = "") -> Iterator[tuple[str, float]]:
    """Every number of a document with its place in it; truth values are left out."""
    if isinstance(value, dict):
        for key, part in value.items():
            if key not in TIED_TO_THE_CODE:
                yield from numbers(part, f"{place}.{key}" if place else str(key))
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from numbers(part, f"{place}[{k}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield place, float(value)


def digest_of_numbers(document: Any) -> str:
    """Digest of every number of a document, to 9 digits: words may change, numbers may not."""
    text = "\n".join(f"{place}={value:.9g}" for place, value in sorted(numbers(document)))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def digest_of_file(path: Path) -> str:
    """Digest of the bytes of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def document_of(run: Run, folder: Path, *words: str) -> dict[str, Any]:
    """The JSON document that a command writes; empty where it refuses, with its exit code."""
    out = folder / "out.json"
    out.unlink(missing_ok=True)
    done = run(*words, "--json", str(out))
    if not out.is_file():
        return {"exit": done.returncode}
    found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    return found


def rankings(run: Run, folder: Path) -> dict[str, Any]:
    """Each shipped set with each seed: what the table and the summary show."""
    found = {}
    for name in SETS:
        for seed in SEEDS:
            document = document_of(run, folder, "rank", name, "--people", "60", "--seed", str(seed))
            whole = document.get("set", {})
            found[f"{name} seed {seed}"] = {
                "numbers": digest_of_numbers(document),
                "icons": {
                    icon["name"]: [icon["detected_probability"], icon["onset_s"], icon["proportion_correct"]]
                    for icon in document.get("icons", [])
                },
                "set": {
                    key: whole.get(key)
                    for key in (
                        *("proportion_correct", "proportion_correct_interval", "information_bits"),
                        *("proportion_correct_interval_new_laboratory", "information_bits_interval_new_laboratory"),
                        "worst_pair",
                    )
                },
                "confusion": digest_of_numbers(document.get("confusion")),
            }
    return found


def exports(run: Run, folder: Path) -> dict[str, Any]:
    """Each export: bytes of the drives, numbers of the sidecars, and what the hardware must prevent."""
    found = {}
    for number, (name, rig, form) in enumerate(EXPORTS):
        out = folder / f"export-{number}"
        done = run("export", name, "--rig", rig, "--to", form, "--force", "-o", str(out))
        files = sorted(path for path in out.rglob("*") if path.is_file()) if out.is_dir() else []
        sidecars = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in files if path.suffix == ".json"}
        found[f"{name} on {rig} to {form}"] = {
            "exit": done.returncode,
            "bytes": {path.name: digest_of_file(path) for path in files if path.suffix != ".json"},
            "numbers": {stem: digest_of_numbers(sidecar) for stem, sidecar in sidecars.items()},
            "demands": {
                stem: {
                    key: value
                    for key, value in sidecar.get("hardware_must_prevent", {}).items()
                    if key.startswith(("watchdog", "cut_off", "pause", "current_limit", "rest_before"))
                }
                for stem, sidecar in sidecars.items()
            },
            "shortest_pause_s": [sidecar.get("safety", {}).get("shortest_pause_s") for sidecar in sidecars.values()],
        }
    return found


def validation(run: Run, folder: Path) -> dict[str, Any]:
    """The report on published results: the median prediction of each row in each variant."""
    document = document_of(run, folder, "validate")
    rows = {}
    for target in document["targets"]:
        for row in target["rows"]:
            rows[f"{target['number']} {row['row']}"] = digest_of_numbers(row.get("predicted"))
    return {"numbers": digest_of_numbers(document), "rows": rows}


def fitted(run: Run, folder: Path) -> dict[str, Any]:
    """A rig fitted to a log that this program simulated, with noise of a fixed seed."""
    clean, log, rig = folder / "clean.csv", folder / "log.csv", folder / "bench.toml"
    true = ("--set", "contact.resistance_m2K_per_W=7e-4", "--set", "module.seebeck_V_per_K=0.0505")
    run("simulate", "calibration-drive", *true, "-o", str(clean), "--rate", "100")
    draws = random.Random(5)
    with clean.open(encoding="utf-8", newline="") as source, log.open("w", encoding="utf-8", newline="") as noisy:
        rows = csv.DictReader(line for line in source if not line.startswith("#"))
        out = csv.writer(noisy)
        out.writerow(["time_s", "current_A", "display_C", "voltage_V"])
        for row in rows:
            display, volts = float(row["display_C"]), float(row["voltage_V"])
            measured = (f"{display + draws.gauss(0, 0.02):.4f}", f"{volts + draws.gauss(0, 0.005):.5f}")
            out.writerow([row["time_s"], row["current_A"], *measured])
    done = run("fit", str(log), "--free", FITTED, "-o", str(rig))
    return {"exit": done.returncode, "rig": _toml_numbers(rig)}


def _toml_numbers(path: Path) -> dict[str, float]:
    import tomllib

    if not path.is_file():
        return {}
    document = tomllib.loads(path.read_text(encoding="utf-8"))
    keys = [*FITTED.split(","), "uncertainty"]
    return {place: value for place, value in numbers(document) if any(place.startswith(key) for key in keys)}


def pilot(run: Run, folder: Path) -> dict[str, Any]:
    """The prediction for six icons, conditioned on answers of two participants of a fixed seed."""
    names = ["cooling-step", "warming-step", "linear-cooling", "cold-to-warm", "linear-warming", "double-dip"]
    draws, trials = random.Random(3), folder / "trials.csv"
    with trials.open("w", encoding="utf-8", newline="") as file:
        out = csv.writer(file)
        out.writerow(["participant", "trial", "presented", "responded"])
        for person in ("P1", "P2"):
            for trial in range(1, 25):
                shown = draws.choice(names)
                out.writerow([person, trial, shown, shown if draws.random() < 0.85 else draws.choice(names)])
    document = document_of(run, folder, "pilot", "six-icons", "--answers", str(trials), "--draws", "200")
    key = dict(numbers({part: document[part] for part in document if part in ("observed", "predicted", "conditioned")}))
    return {"numbers": digest_of_numbers(document), "key": dict(list(key.items())[:60])}


RECORDS: dict[str, Callable[[Run, Path], dict[str, Any]]] = {
    "rank": rankings,
    "export": exports,
    "validate": validation,
    "fit": fitted,
    "pilot": pilot,
}


def differences(before: Any, now: Any, place: str = "") -> Iterator[str]:
    """Every place where two records differ: digests at all, numbers by more than TOLERANCE."""
    if isinstance(before, dict) and isinstance(now, dict):
        for key in sorted({*before, *now}):
            yield from differences(before.get(key), now.get(key), f"{place} / {key}" if place else key)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for k, (one, other) in enumerate(zip(before, now, strict=True)):
            yield from differences(one, other, f"{place}[{k}]")
    elif isinstance(before, int | float) and isinstance(now, int | float):
        if not math.isclose(before, now, rel_tol=TOLERANCE, abs_tol=1e-9):
            yield f"{place}: {before:.9g} is now {now:.9g}"
    elif before != now:
        yield f"{place}: {before} is now {now}"


def main() -> int:
    """Make the records, or check them; the exit code is 1 where one differs."""
    options = argparse.ArgumentParser(description=__doc__)
    beside = Path(sys.executable).with_name("thermicon")
    options.add_argument("--thermicon", default=str(beside), help="the program that makes the records")
    options.add_argument("--only", choices=RECORDS, action="append", help="only this record; may be repeated")
    options.add_argument("--check", action="store_true", help="compare with the records that are there")
    chosen = options.parse_args()

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([chosen.thermicon, *words], capture_output=True, text=True, check=False)

    different = 0
    for name in chosen.only or RECORDS:
        path = HERE / f"{name}.json"
        with tempfile.TemporaryDirectory() as folder:
            made = RECORDS[name](run, Path(folder))
        if not chosen.check:
            path.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
            continue
        for line in differences(json.loads(path.read_text(encoding="utf-8")), made):
            different += 1
            print(f"{name}: {line}")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())

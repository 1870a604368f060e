"""The files of a study's folder."""

from __future__ import annotations

import hashlib
import io
import json
import re
import string
from collections.abc import Mapping
from dataclasses import replace
from importlib import resources
from importlib.metadata import version
from typing import Any

from thermicon.circuit.delivery.formats.tables import has_voltage
from thermicon.circuit.delivery.pack import sidecar_name
from thermicon.circuit.live.ready import with_sensors
from thermicon.circuit.play.script import board_script
from thermicon.circuit.rig.settings import toml_text

from ..figures.session_figure import session_figure
from .build import FELT, UNFELT, Plan, levels_K, plays_of
from .live_facts import live_facts
from .schedule import Pace, events_description, json_bytes, planned_events, planned_plays, table
from .study_file import labels_of

SCRIPT = "run_study.py"
MODULES = ("study_options.py", "study_run.py", "study_answers.py", "study_bench.py", "study_simulated.py")
"""The script of a study and what it imports."""

OWN, FIRST_OWN = re.compile(r"^( *)from \.", re.MULTILINE), re.compile(r"^(?=from \.)", re.MULTILINE)
BOARD = re.compile(r"from thermicon\.circuit\.play\.board\b")
FROM_HERE = "sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # wherever it is started from\n\n"

CONDITIONS = ("participant", "trial", "block", "icon", "drive_file", "sidecar_file", "duration_s", "marker")
LEVELS = ("icon", "change_K", "drive_file", "sidecar_file", "duration_s", "marker")
QUESTIONS = ("Which pattern was that?", "Did you feel a change?")
"""What the screen asks, in a study of naming and in one of a threshold."""

CATCH, MANIFEST = "nothing", "study.json"
"""What is presented in a catch trial; and the file with everything known about a study, digests of its files too."""


def files_of(plan: Plan) -> dict[str, bytes]:
    """Return the bytes of every file of a study, by name; equal studies give equal bytes."""
    materials, ready = plan.materials, plan.judged.ready
    study, rig = materials.study, materials.rig
    names = list(plan.durations_s)
    markers = {name: place for place, name in enumerate(names, 1)}
    stimuli = {one.delivery.icon.name: ready.form.file_name(one.delivery) for one in ready.prepared}
    title = study.title or study.name
    facts = study_facts(plan, stimuli, markers)
    if study.threshold is not None:
        markers[CATCH] = len(names) + 1
    files = {
        "study.toml": materials.text.encode("utf-8"),
        "icons.cue": _icons(plan).encode("utf-8"),
        "rig.toml": toml_text(json.loads((with_sensors(rig) if facts["live"] else rig).document)).encode("utf-8"),
        **ready.files,
        **_scripts(study.threshold is not None, facts["live"] is not None),
        "participants.tsv": table(
            ["participant_id"], [{"participant_id": f"sub-{label}"} for label in labels_of(study)], "\t"
        ),
        "dataset_description.json": json_bytes(
            {"Name": title, "BIDSVersion": "1.10.0", "DatasetType": "raw"}
            | {"GeneratedBy": [{"Name": "thermicon", "Version": version("thermicon")}]}
        ),
        f"task-{study.name}_events.json": events_description(title, markers, _texts(plan)),
        "README.txt": _readme(plan, facts["live"] is not None).encode("utf-8"),
        **_timeline(plan),
    }
    if study.threshold is not None:
        changes = zip(names, levels_K(study.threshold), strict=True)
        levels = [
            {"icon": name, "change_K": f"{change:g}", **_drive(name, plan, stimuli, markers)}
            for name, change in changes
        ]
        files["levels.csv"] = table(LEVELS, levels)
    for course in plan.courses:
        rows = [
            {
                "participant": course.label, "trial": str(trial.trial), "block": str(trial.block), "icon": trial.icon,
                **_drive(trial.icon, plan, stimuli, markers),
            }
            for trial in course.trials
        ]  # fmt: skip
        stem = f"sub-{course.label}_task-{study.name}"
        files[f"{stem}_conditions.csv"] = table(CONDITIONS, rows)
        plays = planned_plays(course, plan.durations_s, pace_of(plan))
        files[f"{stem}_desc-planned_events.tsv"] = planned_events(course, plays, stimuli, markers)
    manifest = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    return {**files, MANIFEST: json_bytes({**facts, "study_files": manifest})}


def pace_of(plan: Plan) -> Pace:
    """The planned times between plays."""
    return Pace(plan.landing.landing_s, plan.judged.gap.gap_s, plan.materials.study.timing.break_s)


def planned_s(plan: Plan) -> float:
    """How long a participant sits, landing and breaks included, if every answer comes within the gap."""
    if plan.courses:
        return planned_plays(plan.courses[0], plan.durations_s, pace_of(plan))[-1].end_s
    count, longest_s = plays_of(plan.materials.study, 1), max(plan.durations_s.values())
    return plan.landing.landing_s + count * longest_s + (count - 1) * plan.judged.gap.gap_s


def study_facts(plan: Plan, stimuli: Mapping[str, str], markers: Mapping[str, int]) -> dict[str, Any]:
    """Return what the script reads and what a methods section needs; units are in the names."""
    materials, judged, landing = plan.materials, plan.judged, plan.landing
    study, threshold = materials.study, materials.study.threshold
    left_out = ("plays", "checks", "uncertainty", "limits", "what_it_is_not")
    return {
        "thermicon": version("thermicon"),
        "study_sha256": materials.sha256,
        "seed": materials.seed,
        "name": study.name,
        "title": study.title,
        "kind": "naming" if threshold is None else "threshold",
        "what_it_is_not": "A simulation was checked against limits. This is not a medical or ethical clearance.",
        "participants": list(labels_of(study)),
        "rig": materials.rig.name,
        "device": materials.device.name,
        "plays": "ni" if has_voltage(materials.device) else materials.device.kind.player,
        "stimuli": list(stimuli.values()),
        "choices": _choices(plan),
        "question": study.run.question or QUESTIONS[threshold is not None],
        "keys": {"start": study.run.start_key, "stop": study.run.stop_key, "abort": study.run.abort_key},
        "marker": study.run.marker,
        "gap_s": judged.gap.gap_s,
        "gap_because": judged.gap.reason,
        "carry_over_d_prime": judged.gap.carry_over_d_prime,
        "carry_over_from_to": judged.gap.carried_by,
        "landing_s": landing.landing_s,
        "landing_derived": landing.derived,
        "landing_from_K": landing.from_K,
        "landing_left_K": landing.left_K,
        "landing_left_at_10_s_K": landing.left_at_10_s_K,
        "break_s": study.timing.break_s,
        "answer_s": study.timing.answer_s,
        "planned_s": planned_s(plan),
        "levels": dict(zip(markers, levels_K(threshold), strict=True)) if threshold else None,
        "live": live_facts(judged.ready),
        "threshold": None if threshold is None else threshold.model_dump(),
        "sessions": {
            label: {key: value for key, value in session.to_dict().items() if key not in left_out}
            for label, session in judged.sessions.items()
        },
        "after_breaks": {label: blocks.colour for label, blocks in judged.after_breaks.items()},
        "baseline_drift_K": dict(judged.drift_K),
        "cautions": list(judged.cautions),
    }


def _choices(plan: Plan) -> dict[str, dict[str, str]]:
    """Possible answers: a key and a text for each name."""
    study = plan.materials.study
    used = {study.run.start_key, study.run.stop_key, study.run.abort_key}
    if study.threshold is not None:
        keys = [key for key in ("y", "n", "1", "2", "3", "4") if key not in used]
        return {FELT: {"key": keys[0], "text": "felt"}, UNFELT: {"key": keys[1], "text": "not felt"}}
    free = [key for key in string.digits[1:] + string.ascii_lowercase if key not in used]
    texts = _texts(plan)
    return {name: {"key": key, "text": texts[name]} for name, key in zip(texts, free, strict=False)}


def _texts(plan: Plan) -> dict[str, str]:
    """The text of each icon on the screen: its meaning, or its name."""
    return {icon.name: icon.metadata.means or icon.name for icon in plan.materials.chosen}


def _drive(name: str, plan: Plan, stimuli: Mapping[str, str], markers: Mapping[str, int]) -> dict[str, str]:
    return {
        "drive_file": stimuli[name],
        "sidecar_file": sidecar_name(name, plan.judged.ready.form),
        "duration_s": f"{plan.durations_s[name]:.9g}",
        "marker": str(markers[name]),
    }


def _scripts(has_threshold: bool, is_live: bool) -> dict[str, bytes]:
    """The source of the player as modules of one folder, which import one another by their names."""
    names = [SCRIPT, *MODULES] + ["study_questplus.py"] * has_threshold + ["study_live.py"] * is_live
    folder = resources.files("thermicon.notebooks.study").joinpath("player")
    texts = {name: folder.joinpath(name).read_text(encoding="utf-8") for name in names}
    texts[SCRIPT] = FIRST_OWN.sub(FROM_HERE, texts[SCRIPT], count=1)
    texts = {name: OWN.sub(r"\1from ", BOARD.sub("from study_board", text)) for name, text in texts.items()}
    if is_live:
        texts["study_board.py"] = board_script()
    return {name: text.encode("utf-8") for name, text in texts.items()}


def _shipped(name: str) -> bytes:
    return resources.files("thermicon.notebooks").joinpath("templates", name).read_bytes()


def _icons(plan: Plan) -> str:
    """The icons that are played as a cue file; the whole set where they play others of it."""
    materials = plan.materials
    try:
        played = replace(materials.icons, entries=materials.chosen)
    except ValueError:
        played = materials.icons
    return str(played).rstrip("\n") + "\n"


def _timeline(plan: Plan) -> dict[str, bytes]:
    """The first session that was judged, on the clock; nothing for a thermode, which has none."""
    if not plan.judged.sessions:
        return {}
    content = io.BytesIO()
    figure = session_figure(next(iter(plan.judged.sessions.values())))
    figure.savefig(content, dpi=130, format="png", metadata={"Software": None})
    return {"timeline.png": content.getvalue()}


def _readme(plan: Plan, is_live: bool) -> str:
    """Instructions for the study, in a few lines of plain text."""
    study = plan.materials.study
    compile_it = (
        f"thermicon export icons.cue --rig rig.toml --device {study.stimuli.device} --to c-array "
        f"--pause {plan.judged.gap.gap_s:g} -o board\n"
        f"                           python run_study.py --participant {labels_of(study)[0]} --device board --port COM3"
    )
    compare = "thermicon pilot icons.cue --answers data/answers.csv --rig rig.toml"
    return string.Template(_shipped("study_readme.txt").decode("utf-8")).substitute(
        title=study.title or study.name,
        version=version("thermicon"),
        sha256=plan.materials.sha256,
        label=labels_of(study)[0],
        live="" if not is_live else f"For a board of yours:      {compile_it}\n",
        compare="" if study.threshold else f"Compare with predictions:  {compare}\n",
    )

"""Runs one participant of a study that thermicon made.

    python run_study.py --participant 01 --simulate     no hardware, no PsychoPy, in a second
    python run_study.py --participant 01                with PsychoPy and the device
    python run_study.py --participant 01 --device board --port COM3    with a board that plays by itself
    python run_study.py --collect                       the answers of all participants in one file

Nothing of it was ever played on a device. It never blocks: the abort key switches the display off at any time, the stop
key ends after the trial. Every answer is on the disk before the next trial begins. Hardware on skin needs a temperature
cut-off that works without software.
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import os
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TextIO

from .study_answers import HERE, NoDisk, Row, StudyFiles, read_study, told
from .study_options import options
from .study_run import Abort, ParticipantRun, Stop

if TYPE_CHECKING:
    from .study_bench import Display, Screen
    from .study_simulated import SimulatedScreen

Bench = tuple["Screen | SimulatedScreen", "Display", Callable[[int], object]]


class Output:
    """Standard output whose reader may leave, as `| head` does: the run goes on in silence."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text as far as somebody reads it."""
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
        return len(text)

    def flush(self) -> None:
        """Every write is flushed."""


def trials_of(files: StudyFiles, who: str) -> list[Row]:
    """The rows of a participant's conditions; the levels of a threshold."""
    study = files.study
    path = HERE / (f"sub-{who}_task-{files.task}_conditions.csv" if study["threshold"] is None else "levels.csv")
    if who not in study["participants"]:
        raise SystemExit(f"there is no participant {who}; the study has {', '.join(study['participants'])}")
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def dataset(files: StudyFiles) -> None:
    """What a BIDS dataset has beside its events: description, participants, stimuli."""
    folder = files.folder
    (folder / "stimuli").mkdir(parents=True, exist_ok=True)
    for name in ("dataset_description.json", "participants.tsv", f"task-{files.task}_events.json"):
        shutil.copyfile(HERE / name, folder / name)
    for name in files.study["stimuli"]:
        shutil.copyfile(HERE / name, folder / "stimuli" / name)


def set_up(files: StudyFiles, chosen: argparse.Namespace) -> Bench:
    """Screen, display and marker, real or simulated."""
    study = files.study
    if study["threshold"] is not None and importlib.util.find_spec("questplus") is None:
        raise SystemExit("the package questplus, which chooses the levels, is missing; pip install questplus")
    if chosen.device is not None and study.get("live") is None:
        raise SystemExit(
            f"--device {chosen.device}: the study is for {study['device']}, which takes no set-points one by one; make "
            f"it again for a controller (stimuli.device)"
        )
    if chosen.bench is not None and not chosen.simulate and not chosen.bench.is_file():
        raise SystemExit(f"--bench {chosen.bench}: there is no such file")
    if chosen.simulate:
        return rehearsal(study, chosen)
    try:
        from .study_bench import Display, Marker, Screen, load

        if chosen.device is not None:
            from .study_live import live_display

            display = live_display(study, chosen, time)
        else:
            own = None if chosen.bench is None else load(chosen.bench, "own_bench")
            display = Display(study["plays"], own, chosen.channel, chosen.port)
        marker = Marker(chosen.marker)
        return Screen(fullscreen=not chosen.window), display, marker
    except ImportError as missing:
        raise SystemExit(
            f"the package {missing.name} is missing in this Python; use the Python of PsychoPy, or install it with "
            f"pip; --simulate needs no package"
        ) from None
    except Exception as problem:
        raise SystemExit(f"the hardware does not open: {problem}; check --port, --channel, --marker") from problem


def rehearsal(study: Mapping[str, Any], chosen: argparse.Namespace) -> Bench:
    """A virtual person, on a clock that jumps."""
    from .study_simulated import SimulatedClock, SimulatedDisplay, SimulatedScreen, virtual_person

    clock, keys = SimulatedClock(chosen.press), study["keys"]
    if chosen.device is not None:
        from .study_live import live_display

        display = live_display(study, chosen, clock)
    else:
        display = SimulatedDisplay(study["plays"], clock)
    clock.on_key = lambda key: display.player.abort() if key == keys["abort"] else None
    seed = f"{chosen.seed} {chosen.participant}"
    if study["threshold"] is None:
        person = virtual_person(seed, chosen.correct)
    else:
        from .study_questplus import threshold_person

        person = threshold_person(seed, chosen.threshold, study)
    return SimulatedScreen(clock, person, keys["start"], not chosen.verbose), display, lambda code: None


def finished(files: StudyFiles, who: str, rows: Sequence[Row], given: Mapping[int, object]) -> bool:
    """Whether every trial of a participant was run, and a threshold written."""
    threshold = files.study["threshold"]
    if threshold is None:
        return not rows
    return len(given) >= threshold["trials"] and files.threshold_file(who).exists()


def switched_off(display: Display, why: object) -> str:
    """Switch the display off after a problem, and return how that ended."""
    try:
        display.abort()
    except Exception as problem:
        return f"NOT SWITCHED OFF, do that by hand at once ({problem}): {why}"
    return f"SWITCHED OFF: {why}"


def main() -> int:
    """Run, and report how it ended: 0 done or stopped, 1 bad input, 3 aborted or switched off by the guard."""
    study = read_study()
    chosen = options(study)
    sys.stdout = Output(sys.stdout)
    study["keys"] = {"start": chosen.start_key, "stop": chosen.stop_key, "abort": chosen.abort_key}
    nobody = chosen.simulate or chosen.device == "simulated"
    files = StudyFiles(chosen.output or HERE / ("simulated" if nobody else "data"), study)
    try:
        if chosen.collect:
            files.collect()
            return 0
        if chosen.participant is None:
            raise SystemExit("whose trials? give --participant LABEL, one of " + ", ".join(study["participants"]))
        rows = trials_of(files, chosen.participant)
        with files.claimed(chosen.participant):
            return begin(files, chosen, rows)
    except NoDisk as problem:
        raise SystemExit(str(problem)) from None


def begin(files: StudyFiles, chosen: argparse.Namespace, rows: list[Row]) -> int:
    """Run the trials that have no answer yet."""
    who, is_naming = chosen.participant, files.study["threshold"] is None
    given = files.given_answers(who)
    if given and not chosen.resume:
        raise SystemExit(
            f"{files.answers_file(who)} has {len(given)} trials already: --resume goes on after them; or give another "
            f"--output"
        )
    if given and is_naming:
        rows = [row for row in rows if int(row["trial"]) and int(row["trial"]) not in given]
    if given and finished(files, who, rows, given):
        print(f"{who}: done before, {len(given)} trials; there is nothing to resume")
        return 0
    screen, display, marker = set_up(files, chosen)  # first, so that a start that fails leaves nothing behind
    with told(files.folder):
        dataset(files)
    return play_all(ParticipantRun(files, who, screen, display, marker, given), rows)


def play_all(run: ParticipantRun, rows: Sequence[Row]) -> int:
    """Play the trials to the end, and say how they ended; whatever ends them early switches the display off."""
    code, ending = 3, "INTERRUPTED"
    try:
        try:
            if run.study["threshold"] is None:
                run.go(rows)
            else:
                from .study_questplus import go

                go(run, rows)
            last = "done"
        except Stop:
            last = "stopped by key; --resume goes on"
        run.finish()
        code, ending = 0, last
    except Abort:
        ending = "ABORTED by key; the display is off"
    except NoDisk as problem:
        trials = f"trial {[*run.given][-1]} is the last" if run.given else "no trial is"
        ending = switched_off(run.display, f"{problem}; {trials} on the disk, and --resume goes on after it")
    except Exception as problem:
        ending = switched_off(run.display, problem)
    except BaseException:
        ending = switched_off(run.display, ending)
        raise
    finally:
        run.screen.close()
        answered = sum(bool(said) for _, said in run.given.values())
        print(f"{run.who}: {ending}; {answered} answers after {(run.screen.now() - run.begun) / 60:.1f} min")
    return code


if __name__ == "__main__":
    sys.exit(main())

"""``thermicon pilot``: the plan of an experiment or the prediction conditioned on its answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from thermicon.base.files.atomic import OutputError, complete_or_absent

from ..files.outputs import STDOUT, check_output, check_separate
from ..messages import note, noted, progress_bar, usage
from ..report.pilot_report import observed_report, opened_report
from ..report.plan_report import plan_report
from ..report.terminal import show
from .options import (
    FigureOptions,
    FileNames,
    Json,
    ObserverOptions,
    Options,
    RigOptions,
    Theirs,
    command_text,
    opt,
    out,
    read_set,
    refuse,
    theirs_of,
    write_text,
)

if TYPE_CHECKING:
    from thermicon.perception.pilot.measurements_file import Measurements
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.trials import Trials

LEAST_DRAWS, MOST_DRAWS, USUAL_DRAWS, USUAL_PLAN_DRAWS = 20, 20_000, 1000, 300
"""The least as in `thermicon.perception.pilot.observed`, repeated here to avoid its imports."""
MOST_SIZES, MOST_PARTICIPANTS, MOST_TRIALS = 12, 500, 5000
PARTICIPANTS, TRIALS = "4,8,12,16,24,32,48", "12,24,48,96"
KEEP_IT = "With --keep lab.toml, rank, improve and the workbench can predict for this laboratory."
NEEDS = "laboratories are drawn from draws of a posterior"


@dataclass(frozen=True)
class PilotOptions(Options):
    """What is asked of a set before or after an experiment, and the files that hold and get answers."""

    answers: Annotated[
        list[Path] | None,
        out(
            "TRIALS.csv",
            "Sharpen the prediction by answers: columns participant, trial, presented, responded (none: not felt). "
            "Or by measurements: participant, kind (threshold, reaction_time, rating), method, channel, size_K, value, "
            "unit, standard_error, trials.",
            "--answers",
            "--measurements",
        ),
    ] = None
    column: Theirs = None
    keep: Annotated[
        Path | None,
        out(
            "LAB.toml",
            "With answers: write the conditioned observer, and its draws, half as many as --draws, as LAB.csv.",
            "--keep",
        ),
    ] = None
    participants: Annotated[
        str | None, opt("N,N,…", f"Plan: numbers of participants to try, 2 to 500.  [default: {PARTICIPANTS}]")
    ] = None
    trials: Annotated[
        str | None, opt("N,N,…", f"Plan: trials of a participant with each set, to try.  [default: {TRIALS}]")
    ] = None
    wanted: Annotated[
        float | None,
        opt(
            "PERCENT",
            "Plan: wanted width of the 95 % interval in points; with two sets, wanted share of experiments that "
            "distinguish them.  [default: 10; 80]",
        ),
    ] = None
    draws: Annotated[
        int | None,
        opt(
            "N",
            "Draws of the posterior, each with a laboratory.  [default: 1000; 300 for a plan]",
            LEAST_DRAWS,
            MOST_DRAWS,
        ),
    ] = None
    json: Json = None

    def check(self, files: Sequence[str], sealed: Sequence[str], figure: Path | None) -> None:
        """Refuse options that belong to another use of the command: a plan, answers, or a sealed prediction."""
        if self.answers is not None and len(self.answers) > 1:
            raise usage("give one file of answers or of measurements, not both", "--answers' / '--measurements")
        if sealed and (self.answers is None or len(sealed) > 1 or len(sealed) == len(files)):
            raise usage(
                "a sealed prediction stands beside the cue files it was made of, one at a time, with --answers", "FILE"
            )
        of_plan = {"--participants": self.participants, "--trials": self.trials, "--wanted": self.wanted}
        of_answers = {"--keep": self.keep, "--column": self.column, "--figure": figure}
        refuse(of_plan, self.answers is not None, "belongs to a plan, before there are answers")
        refuse(of_answers, self.answers is None, "needs --answers FILE")
        check_output(self.json, (".json",), "JSON")
        of_prediction = {"--keep": self.keep, "--figure": figure}
        refuse(of_prediction, bool(sealed), "belongs to answers without a sealed prediction, which is scored as it is")

    def sizes(self, sets: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Participants and trials that a plan for so many sets tries; what no plan can be for is refused."""
        participants = _numbers(self.participants or PARTICIPANTS, "--participants", 2, MOST_PARTICIPANTS)
        trials = _numbers(self.trials or TRIALS, "--trials", 1, MOST_TRIALS)
        if sets > 2:
            raise usage("a plan is for one set, or for two that are to be distinguished", "FILE")
        if self.wanted is not None and not 0.0 < self.wanted < 100.0:
            raise usage(f"{self.wanted:g} is outside 0 to 100", "--wanted")
        if self.wanted is not None and self.wanted < 1.0 and sets == 2:
            raise usage(
                f"{self.wanted:g} % of experiments is next to nothing; give per cent, such as {100 * self.wanted:g}",
                "--wanted",
            )
        return participants, trials

    def kept(self, files: Sequence[str | Path], figure: Path | None) -> tuple[Path, Path] | None:
        """The observer and the table of draws that are kept, which are new files of their own; None: nothing is."""
        kept = None if self.keep is None else (self.keep, self.keep.with_suffix(".csv"))
        check_output(self.keep, (".toml",), "an observer")
        if self.keep == STDOUT:
            raise usage("- is not a file; give a name such as lab.toml", "--keep")
        check_output(kept and kept[1], (".csv",), "a table of draws")
        check_separate(files, [self.json, *(kept or ()), figure])
        if there := [str(path) for path in kept or () if path.exists()]:
            raise OutputError(
                f"{' and '.join(there)} already there and kept; give --keep another name, or move them away"
            )
        return kept


def pilot_command(
    files: FileNames, asked: PilotOptions, crowd: ObserverOptions, rig: RigOptions, figure: FigureOptions
) -> None:
    """Plan an identification experiment, or compare its answers with the prediction and sharpen it by them.

    Without answers, whole experiments are simulated in laboratories that the evidence allows: how many participants and
    trials give the wanted interval of FILE's per cent named, or distinguish two sets. With
    answers, FILE is the set that was presented; further ones are predicted for the laboratory too. A laboratory is one
    draw of the posterior with people of its own: those that make the answers likely count more. With the JSON of a
    ranking beside its FILES, that prediction is scored on the answers as it was sealed.
    """
    sealed = [name for name in files if name.lower().endswith(".json")]
    asked.check(files, sealed, figure.figure)
    if not asked.answers:
        plan_experiment(files, asked, crowd, rig)
    elif sealed:
        open_sealed(Path(sealed[0]), asked.answers[0], [name for name in files if name not in sealed], asked, rig)
    else:
        condition(asked.answers[0], files, asked, crowd, rig, figure)


def plan_experiment(files: Sequence[str], asked: PilotOptions, crowd: ObserverOptions, rig: RigOptions) -> None:
    """Simulate experiments of several sizes; write and show how much each would tell."""
    participants, trials = asked.sizes(len(files))
    check_separate(files, [asked.json])
    from thermicon.perception.pilot.plan import plan

    icons, *others = (read_set([name]) for name in files)
    where = rig.load(icons, files[0])
    people = crowd.load(where, NEEDS)
    wanted = None if asked.wanted is None else asked.wanted / 100.0
    with progress_bar("simulating experiments") as progress:
        planned = plan(
            icons, where, *others, crowd=people, participants=participants, trials=trials, wanted=wanted,
            draws=asked.draws or USUAL_PLAN_DRAWS, progress=progress,
        )  # fmt: skip
    if asked.json is not None:
        write_text(planned.to_json() + "\n", asked.json)
    if asked.json != STDOUT:
        show(plan_report(planned, [Path(name).name for name in files]))


def open_sealed(sealed: Path, answers: Path, files: Sequence[str], asked: PilotOptions, rig: RigOptions) -> None:
    """Score a sealed prediction on answers; write and show how it did."""
    theirs = theirs_of(asked.column)
    check_separate([sealed, answers, *files], [asked.json])
    from thermicon.perception.pilot.sealed import opened, read_sealed
    from thermicon.perception.pilot.trials_file import read_trials

    icons = read_set(files)
    where = rig.load(icons, files[0])
    prediction = read_sealed(sealed, icons, where)
    with noted():
        trials = read_trials(answers, prediction.labels, theirs)
    scores = opened(prediction, trials, icons, where)
    if asked.json is not None:
        write_text(scores.to_json() + "\n", asked.json)
    if asked.json != STDOUT:
        show(opened_report(scores))


def condition(
    answers: Path, files: Sequence[str], asked: PilotOptions, crowd: ObserverOptions, rig: RigOptions,
    figure: FigureOptions,
) -> None:  # fmt: skip
    """Sharpen the prediction for the sets of a laboratory by its answers or measurements; write, keep and show it."""
    columns = theirs_of(asked.column)
    kept = asked.kept([answers, *files, *([crowd.observer] if crowd.observer else [])], figure.figure)
    from thermicon.perception.pilot.measurements_file import is_measurements, read_measurements
    from thermicon.perception.pilot.observed import observed
    from thermicon.perception.pilot.trials_file import read_trials

    from ..figures.set_figures import observed_figure

    icons, *others = (read_set([name]) for name in files)
    where = rig.load(icons, files[0])
    people = crowd.load(where, NEEDS)
    data: Trials | Measurements
    if is_measurements(answers, columns):
        data = read_measurements(answers, where, columns)
    else:
        with noted():
            data = read_trials(answers, [icon.name for icon in icons], columns)
    draws = asked.draws or USUAL_DRAWS
    with progress_bar("simulating laboratories") as progress:
        laboratory = observed(data, icons, where, crowd=people, others=others, draws=draws, progress=progress)
    if asked.json is not None:
        write_text(laboratory.to_json() + "\n", asked.json)
    figure.write(lambda: observed_figure(laboratory, figure.look))
    last = KEEP_IT
    if kept is not None:
        _keep(laboratory, *kept)
        command = command_text(files[:1], rig, replace(crowd, seed=0, observer=kept[1]), paths=True)
        last = f"Predict for this laboratory:\n  {command}"
    if asked.json != STDOUT:
        show(observed_report(laboratory, files, last))


def _keep(found: Observed[Any, Any], keep: Path, drawn: Path) -> None:
    """Write the conditioned observer and its draws, both or none."""
    observer, draws = found.files()
    with complete_or_absent(drawn) as table, complete_or_absent(keep) as draft:
        table.write_text(draws, encoding="utf-8")
        draft.write_text(observer, encoding="utf-8")
    note(f"wrote {keep} and {drawn}")


def _numbers(text: str, option: str, least: int, most: int) -> tuple[int, ...]:
    """Whole numbers between commas, each once and in rising order."""
    try:
        found = sorted({int(part) for part in text.split(",")})
    except ValueError:
        raise usage(f"{text!r} is not a list of whole numbers such as 8,16,32", option) from None
    if wrong := [number for number in found if not least <= number <= most]:
        raise usage(f"{wrong[0]} is outside {least} to {most}", option)
    if len(found) > MOST_SIZES:
        raise usage(f"{len(found)} numbers; at most {MOST_SIZES} are tried at once", option)
    return tuple(found)

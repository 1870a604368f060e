"""``thermicon pilot``: the plan of an experiment or the prediction conditioned on its answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from thermicon.base.files.atomic import OutputError, complete_or_absent

from ..files.outputs import STDOUT, check_output, check_separate
from ..messages import note, noted, progress_bar, usage
from .options import (
    FigureOptions,
    FileNames,
    Json,
    ObserverOptions,
    RigOptions,
    Theirs,
    command_text,
    opt,
    out,
    read_set,
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


def pilot_command(
    files: FileNames,
    crowd: ObserverOptions,
    rig: RigOptions,
    figure: FigureOptions,
    answers: Annotated[
        list[Path] | None,
        out(
            "TRIALS.csv",
            "Sharpen the prediction by answers: columns participant, trial, presented, responded (none: not felt); "
            "given again for each participant, one file each.",
            "--answers",
        ),
    ] = None,
    measurements: Annotated[
        list[Path] | None,
        out(
            "VALUES.csv",
            "Sharpen the prediction by measurements: participant, kind (threshold, reaction_time, rating), method, "
            "channel, size_K, value, unit, standard_error, trials.",
            "--measurements",
        ),
    ] = None,
    column: Theirs = None,
    keep: Annotated[
        Path | None,
        out(
            "LAB.toml",
            "With answers: write the conditioned observer, and its draws, half as many as --draws, as LAB.csv.",
            "--keep",
        ),
    ] = None,
    participants: Annotated[
        str | None, opt("N,N,…", f"Plan: numbers of participants to try, 2 to 500.  [default: {PARTICIPANTS}]")
    ] = None,
    trials: Annotated[
        str | None, opt("N,N,…", f"Plan: trials of a participant with each set, to try.  [default: {TRIALS}]")
    ] = None,
    wanted: Annotated[
        float | None,
        opt(
            "PERCENT",
            "Plan: wanted width of the 95 % interval in points; with two sets, wanted share of experiments that "
            "distinguish them.  [default: 10; 80]",
        ),
    ] = None,
    draws: Annotated[
        int | None,
        opt(
            "N",
            "Draws of the posterior, each with a laboratory.  [default: 1000; 300 for a plan]",
            LEAST_DRAWS,
            MOST_DRAWS,
        ),
    ] = None,
    json: Json = None,
) -> None:
    """Plan an identification experiment, or compare its answers with the prediction and sharpen it by them.

    Without answers, whole experiments are simulated in laboratories that the evidence allows: how many participants and
    trials give the wanted interval of FILE's per cent named, or distinguish two sets. With
    answers, FILE is the set that was presented; further ones are predicted for the laboratory too. A laboratory is one
    draw of the posterior with people of its own: those that make the answers likely count more. With the JSON of a
    ranking beside its FILES, that prediction is scored on the answers as it was sealed.
    """
    if (answers and measurements) or len(measurements or ()) > 1:
        raise usage("give files of answers, or one file of measurements", "--answers' / '--measurements")
    data = answers or measurements
    sealed = [name for name in files if name.lower().endswith(".json")]
    if sealed and (answers is None or len(sealed) > 1 or len(sealed) == len(files)):
        raise usage(
            "a sealed prediction stands beside the cue files it was made of, one at a time, with --answers", "FILE"
        )
    planned = {"--participants": participants, "--trials": trials, "--wanted": wanted}
    given = {"--keep": keep, "--column": column, "--figure": figure.figure}
    for option, value in (planned if data is not None else given).items():
        if value is not None:
            raise usage("belongs to a plan, before there are answers" if data else "needs --answers FILE", option)
    if json is not None:
        check_output(json, (".json",), "JSON")
    if answers is not None and sealed:
        if keep is not None or figure.figure is not None:
            option = "--keep" if keep is not None else "--figure"
            raise usage("belongs to answers without a sealed prediction, which is scored as it is", option)
        open_sealed(
            Path(sealed[0]), answers, theirs_of(column), [name for name in files if name not in sealed], rig, json
        )
        return
    if data is not None:
        measured = data is measurements
        condition(data, measured, theirs_of(column), files, crowd, rig, figure, keep, draws or USUAL_DRAWS, json)
        return
    people = _numbers(participants or PARTICIPANTS, "--participants", 2, MOST_PARTICIPANTS)
    times = _numbers(trials or TRIALS, "--trials", 1, MOST_TRIALS)
    plan_experiment(files, people, times, wanted, crowd, rig, draws or USUAL_PLAN_DRAWS, json)


def plan_experiment(
    files: Sequence[str],
    participants: tuple[int, ...],
    trials: tuple[int, ...],
    wanted: float | None,
    crowd: ObserverOptions,
    rig: RigOptions,
    draws: int,
    json: Path | None,
) -> None:
    """Simulate whole experiments with one set, or with two that are to be distinguished; show and write the plan."""
    if len(files) > 2:
        raise usage("a plan is for one set, or for two that are to be distinguished", "FILE")
    if wanted is not None and not 0.0 < wanted < 100.0:
        raise usage(f"{wanted:g} is outside 0 to 100", "--wanted")
    if wanted is not None and wanted < 1.0 and len(files) == 2:
        raise usage(
            f"{wanted:g} % of experiments is next to nothing; give per cent, such as {100 * wanted:g}", "--wanted"
        )
    check_separate(files, [json])
    from thermicon.perception.pilot.plan import plan

    from ..report.plan_report import plan_report
    from ..report.terminal import show

    sets = [read_set([name]) for name in files]
    where = rig.load(sets[0], files[0])
    model = crowd.load(where, NEEDS)
    with progress_bar("simulating experiments") as progress:
        planned = plan(
            sets[0],
            where,
            *sets[1:],
            participants=participants,
            trials=trials,
            wanted=None if wanted is None else wanted / 100.0,
            draws=draws,
            **crowd.asked,
            observer=model,
            progress=progress,
        )
    if json is not None:
        write_text(planned.to_json() + "\n", json)
    if json != STDOUT:
        show(plan_report(planned, [Path(name).name for name in files]))


def open_sealed(
    sealed: Path, answers: list[Path], theirs: dict[str, str], files: Sequence[str], rig: RigOptions, json: Path | None
) -> None:
    """Score a sealed prediction on answers; show and write it."""
    check_separate([sealed, *answers, *files], [json])
    from thermicon.perception.pilot.sealed import opened, read_sealed
    from thermicon.perception.pilot.trials_file import read_trials

    from ..report.pilot_report import opened_report
    from ..report.terminal import show

    icons = read_set(files)
    where = rig.load(icons, files[0])
    held = read_sealed(sealed, icons, where)
    with noted():
        data = read_trials(answers, held.labels, theirs)
    found = opened(held, data, icons, where)
    if json is not None:
        write_text(found.to_json() + "\n", json)
    if json != STDOUT:
        show(opened_report(found))


def condition(
    answers: list[Path],
    measured: bool,
    theirs: dict[str, str],
    files: Sequence[str],
    crowd: ObserverOptions,
    rig: RigOptions,
    figure: FigureOptions,
    keep: Path | None,
    draws: int,
    json: Path | None,
) -> None:
    """Sharpen the prediction for the sets of a laboratory by its answers or measurements; show and keep it."""
    drawn = None if keep is None else keep.with_suffix(".csv")
    if keep is not None and drawn is not None:
        check_output(keep, (".toml",), "an observer")
        if keep == STDOUT:
            raise usage("- is not a file; give a name such as lab.toml", "--keep")
        check_output(drawn, (".csv",), "a table of draws")
    read: list[str | Path] = [*answers, *files, *([crowd.observer] if crowd.observer else [])]
    check_separate(read, [json, keep, drawn, figure.figure])
    if there := [str(path) for path in (keep, drawn) if path is not None and path.exists()]:
        raise OutputError(f"{' and '.join(there)} already there and kept; give --keep another name, or move them away")
    from thermicon.perception.pilot.measurements_file import read_measurements
    from thermicon.perception.pilot.observed import observed
    from thermicon.perception.pilot.trials_file import read_trials

    from ..figures.set_figures import observed_figure
    from ..report.pilot_report import observed_report
    from ..report.terminal import show

    icons, *others = (read_set([name]) for name in files)
    where = rig.load(icons, files[0])
    model = crowd.load(where, NEEDS)
    data: Trials | Measurements
    if measured:
        data = read_measurements(answers[0], where, theirs)
    else:
        with noted():
            data = read_trials(answers, [icon.name for icon in icons], theirs)
    with progress_bar("simulating laboratories") as progress:
        found = observed(
            data, icons, where, others=others, draws=draws, observer=model, progress=progress, **crowd.asked
        )
    if json is not None:
        write_text(found.to_json() + "\n", json)
    figure.write(lambda: observed_figure(found, figure.look))
    last = KEEP_IT
    if keep is not None and drawn is not None and not found.unusable:
        _keep(found, keep, drawn)
        kept = replace(crowd, seed=0, observer=drawn)
        last = (
            "Predict for this laboratory (with pairs by chance: only the prediction above knows which were confused):"
            f"\n  {command_text(files[:1], rig, kept, paths=True)}"
        )
    if json != STDOUT:
        show(observed_report(found, files, last))
    if keep is not None and found.unusable:
        raise OutputError(
            f"{keep} is not written: there are no draws of this laboratory, since the likelihood of the "
            f"{found.data.noun} cannot be used; check the table, or use more --draws, or another --seed"
        )


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

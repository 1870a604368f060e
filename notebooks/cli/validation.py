"""``thermicon validate``: predicted beside published results."""

from json import dumps
from typing import Annotated

from ..files.outputs import STDOUT, check_output
from ..messages import progress_bar, usage
from .options import Json, Seed, opt, write_text


def validate_command(
    people: Annotated[int, opt("N", "Number of virtual people.", 2, 2000)] = 200,
    draws: Annotated[int, opt("N", "Number of observers drawn for intervals; 0 for none.", 0, 1000)] = 128,
    seed: Seed = 0,
    json: Json = None,
) -> None:
    """Validate the model: predict published results that it was not calibrated on, and show every miss with its size.

    The JSON has all numbers, with predictions from temperature and from heat flow side by side; the notebook
    07_validation.ipynb, which lab copies, asks what they say.
    """
    if draws == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--draws")
    check_output(json, (".json",), "JSON")
    from thermicon.perception.evidence.validate import validate

    from ..report.terminal import show
    from ..report.validate_report import validate_report

    with progress_bar("validating") as progress:
        report = validate(people=people, draws=draws, seed=seed, progress=progress)
    if json is not None:
        write_text(dumps(report.to_dict(), ensure_ascii=False, indent=1, allow_nan=False) + "\n", json)
    if json != STDOUT:
        show(validate_report(report))

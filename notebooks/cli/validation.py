"""``thermicon validate``: predicted and published results side by side, as a table or as an executed notebook."""

from __future__ import annotations

import tempfile
from contextlib import suppress
from importlib import resources
from importlib.util import find_spec
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.icons.atomic import check_folder, complete_or_absent

from ..files.outputs import STDOUT, check_output
from ..messages import fail, note, progress_bar, usage
from .options import Json, Seed, out, write_text

if TYPE_CHECKING:
    from thermicon.perception.evidence.validate import Judged, Line, ValidationReport

HEADS = ("temp.", "flow")
NOTEBOOK, DATA = "07_validation.ipynb", "validation.json"
COMPUTED = "data = report_file("
"""How the cell of the notebook begins that computes the numbers; a report has them in its file."""
KEPT = f'import json\nfrom pathlib import Path\n\ndata = json.loads(Path("{DATA}").read_text(encoding="utf-8"))'
QUIET = "--IPKernelApp.log_level=40"
NEEDED = ("nbclient", "ipykernel")


def validate_command(
    output: Annotated[
        Path | None,
        out("DIR", "Write the numbers and a notebook that shows them to this folder.", "-o", "--output"),
    ] = None,
    people: Annotated[int, typer.Option(metavar="N", min=2, max=2000, help="Number of virtual people.")] = 200,
    draws: Annotated[
        int,
        typer.Option(
            metavar="N", min=0, max=1000, help="Number of observers drawn for intervals and trade-offs; 0 for none."
        ),
    ] = 128,
    seed: Seed = 0,
    json: Json = None,
) -> None:
    """Validate the model: predict published results that it was not calibrated on, and show every miss with its size.

    Without -o, a table is printed. With -o, validation.json has all numbers, with predictions from temperature and from
    heat flow side by side, and the executed notebook 07_validation.ipynb shows them in tables and figures.
    """
    if draws == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--draws")
    if output is not None:
        check_folder(output)
        if missing := [name for name in NEEDED if find_spec(name) is None]:
            fail(f"-o executes a notebook, which needs {missing[0]}: pip install {missing[0]}, or use --json")
    if json is not None:
        check_output(json, (), "JSON")
    from thermicon.perception.evidence.validate import validate

    with progress_bar("validating") as progress:
        report = validate(people=people, draws=draws, seed=seed, progress=progress)
    if json is not None:
        write_text(json_text(report), json)
    if output is not None:
        write_report(report, output)
        for name in (NOTEBOOK, DATA):
            note(f"wrote {output / name}")
    elif json != STDOUT:
        show_report(report)


def show_report(report: ValidationReport) -> None:
    """Print every number, published and predicted, and how many agree."""
    from thermicon.perception.observer.variants import VARIABLES

    from ..report.conditioning_text import show_conditioning
    from ..report.tables import show, table

    show_conditioning(report.conditioning)
    mark = {"holds": "✓", "misses": "✗", "shown": " "}
    for section in report.sections:
        made = table("", "published", *HEADS, numbers=HEADS)
        for line in section.lines:
            cells = [f"{number_text(line, one)} {mark[one.verdict.word]}" for one in line.judged]
            unit = "" if line.row.unit == line.published.unit else unit_text(line.row.unit)
            made.add_row(f"{line.row.label}{',' if unit else ''}{unit}", line.published.text, *cells)
        show(f"{section.target.number} {section.target.title}", made, "")
    held = [report.counts(k) for k in range(len(VARIABLES))]
    counted = ", ".join(f"{name} {a} of {b}" for name, (a, b) in zip(VARIABLES, held, strict=True))
    show(
        f"✓ holds, ✗ misses, no mark: shown and not judged. Hold: {counted}.",
        "temp.: receptors respond to temperature; flow: to heat flow. All are "
        "predictions, not measurements; rows marked fitted are among the experiments above. -o DIR "
        "writes sources, intervals, sizes of the misses, suspected mechanisms and figures.",
    )


def number_text(line: Line, one: Judged) -> str:
    """Format a prediction."""
    from thermicon.perception.evidence.verdicts import value_text

    if one.predicted.value is None:
        return "not felt"
    return value_text(line.row, one.predicted.value, line.published)


def unit_text(unit: str) -> str:
    """Format the unit that follows a number; empty for pure numbers and proportions.

    >>> unit_text("s"), unit_text("proportion")
    (' s', '')
    """
    return "" if unit in ("", "1", "proportion") else f" {unit}"


def write_report(report: ValidationReport, folder: Path) -> None:
    """Write the numbers and the executed notebook, both or none.

    Raises `OutputError` where the folder cannot be written.
    """
    numbers = json_text(report)
    notebook = executed_notebook(numbers)
    made = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        with complete_or_absent(folder / DATA) as data, complete_or_absent(folder / NOTEBOOK) as shown:
            data.write_text(numbers, encoding="utf-8")
            shown.write_text(notebook, encoding="utf-8")
    except BaseException:
        if made:
            with suppress(OSError):
                folder.rmdir()
        raise


def executed_notebook(numbers: str) -> str:
    """The shipped notebook with its outputs, for numbers that lie beside it as `DATA`."""
    import nbformat
    from nbclient import NotebookClient

    text = (resources.files("thermicon.notebooks") / NOTEBOOK).read_text(encoding="utf-8")
    notebook = nbformat.reads(text, as_version=4)  # type: ignore[no-untyped-call]
    (computing,) = [cell for cell in notebook.cells if cell.source.startswith(COMPUTED)]
    computing.source = KEPT
    with tempfile.TemporaryDirectory(prefix="thermicon-validation-") as work:
        (Path(work) / DATA).write_text(numbers, encoding="utf-8")
        place = {"metadata": {"path": work}}
        NotebookClient(
            notebook, kernel_name="python3", resources=place, record_timing=False, extra_arguments=[QUIET]
        ).execute()
    executed: str = nbformat.writes(notebook)  # type: ignore[no-untyped-call]
    return executed + "\n"


def json_text(report: ValidationReport) -> str:
    """Every number of the report as JSON."""
    from thermicon.perception.evidence.validate_file import report_file

    return dumps(report_file(report), ensure_ascii=False, indent=1, allow_nan=False) + "\n"

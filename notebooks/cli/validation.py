"""``thermicon validate``: predicted and published results side by side, as a table or as a report in a folder."""

from __future__ import annotations

import io
import json
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..files.outputs import STDOUT, OutputError, check_folder, check_output, complete_or_absent
from ..text.messages import check_bounds, note, usage

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.perception.validation.validate import ValidationReport

DPI = 110
HEADS = ("temp.", "flow")
PAGE, TEXT, DATA, FIGURES = "validation.html", "validation.md", "validation.json", "figures"


def validate_command(
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", readable=False, help="Write the whole report to this folder."),
    ] = None,
    people: Annotated[int, typer.Option("--people", metavar="N", help="Number of virtual people.")] = 200,
    draws: Annotated[
        int,
        typer.Option(
            "--draws", metavar="N", help="Number of observers drawn for intervals and trade-offs; 0 for none."
        ),
    ] = 128,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the virtual people and the draws.")] = 0,
    json_out: Annotated[
        Path | None,
        typer.Option("--json", metavar="OUT", readable=False, help="Write every number as JSON; - prints it."),
    ] = None,
    leave_out: Annotated[
        bool,
        typer.Option(
            "--leave-out",
            help="Instead: infer all constants again without each experiment in turn, and predict it. Takes hours.",
        ),
    ] = False,
    keep: Annotated[
        Path | None,
        typer.Option("--keep", metavar="DIR", readable=False, help="With --leave-out: folder of finished parts."),
    ] = None,
) -> None:
    """Validate the model: predict published results that it was not calibrated on, and show every miss with its size.

    Without -o, a table is printed. With -o, validation.html, validation.md with its figures, and validation.json are
    written, with predictions from temperature and from heat flow side by side. With --leave-out, the tables that the
    report shows of left-out experiments are made again, coverage, log scores and weights of the variants included.
    """
    check_bounds(("--people", people, 2, 2000), ("--draws", draws, 0, 1000), ("--seed", seed, 0, 2**32 - 1))
    if leave_out:
        if json_out is not None:
            raise usage("--leave-out writes tables: give a folder with -o", "--json")
        from .leave_out import leave_out_files

        leave_out_files(output, keep, seed)
        return
    if keep is not None:
        raise usage("only --leave-out keeps parts", "--keep")
    if draws == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--draws")
    if output is not None:
        check_folder(output)
    if json_out is not None:
        check_output(json_out, (), "JSON")
    from thermicon.perception.validation.validate import validate

    from ..text.messages import progress_bar

    with progress_bar("validating") as progress:
        report = validate(people=people, draws=draws, seed=seed, progress=progress)
    if json_out == STDOUT:
        typer.echo(json_text(report), nl=False)
    elif json_out is not None:
        with complete_or_absent(json_out) as draft:
            draft.write_text(json_text(report), encoding="utf-8")
        note(f"wrote {json_out}")
    if output is None and json_out != STDOUT:
        show_report(report)
    if output is not None:
        write_report(report, output)
        for name in (PAGE, TEXT, DATA):
            note(f"wrote {output / name}")


def show_report(report: ValidationReport) -> None:
    """Print every number, published and predicted, and how many agree."""
    from thermicon.perception.observer.variants import VARIABLES

    from ..pages.conditioning_tables import show_conditioning
    from ..pages.validation_page import NAMES, number_text, unit_text
    from ..text.tables import show, table

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
    counted = ", ".join(f"{name} {a} of {b}" for name, (a, b) in zip(NAMES, held, strict=True))
    show(
        f"✓ holds, ✗ misses, no mark: shown and not judged. Hold: {counted}.",
        "temp.: receptors respond to temperature; flow: to heat flow. All are "
        "predictions, not measurements; rows marked fitted are among the experiments above. -o DIR "
        "writes sources, intervals, sizes of the misses, suspected mechanisms and figures.",
    )


def write_report(report: ValidationReport, folder: Path) -> None:
    """Write the report completely or not at all; an older report is replaced as a whole.

    Raises `OutputError` where the folder cannot be written.
    """
    from thermicon.perception.validation.published_figure import NAME, published_figure

    from ..pages.blocks import as_html, as_markdown
    from ..pages.validation_page import TITLE, page

    blocks, pictures, lead = page(report), draw_pictures(report), _drawn(published_figure(report), "pdf")
    texts = {
        PAGE: as_html(blocks, TITLE, pictures),
        TEXT: as_markdown(blocks, FIGURES),
        DATA: json_text(report),
    }
    made = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=".validation-", suffix=".part", dir=folder))
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror or error}") from error
    try:
        (draft / FIGURES).mkdir()
        for name, held in pictures.items():
            (draft / FIGURES / f"{name}.png").write_bytes(held)
        (draft / FIGURES / f"{NAME}.pdf").write_bytes(lead)
        for name, text in texts.items():
            (draft / name).write_text(text, encoding="utf-8")
        _replace(draft, folder)
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
        if made and not any(folder.iterdir()):
            folder.rmdir()


def draw_pictures(report: ValidationReport) -> dict[str, bytes]:
    """Every figure of the report as PNG, by name."""
    from thermicon.perception.validation.published_figure import CAPTION, NAME, published_figure
    from thermicon.perception.validation.tradeoffs import FEWEST
    from thermicon.perception.validation.validate_maps import FIGURES as DRAWN
    from thermicon.perception.validation.validate_maps import TRADE_OFF

    wanted = [(NAME, CAPTION, published_figure), *(one for those in DRAWN.values() for one in those)]
    wanted += [TRADE_OFF] if report.draws >= FEWEST else []
    return {name: _drawn(draw(report), "png") for name, _, draw in wanted}


def json_text(report: ValidationReport) -> str:
    """Every number of the report as JSON."""
    from thermicon.perception.validation.validate_file import report_file

    return json.dumps(report_file(report), ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def _drawn(figure: Figure, kind: Literal["png", "pdf"]) -> bytes:
    """A figure as a file, without a date, so that the same report gives the same bytes."""
    held = io.BytesIO()
    nothing = {"Software": None} if kind == "png" else {"CreationDate": None, "Producer": None, "Creator": None}
    figure.savefig(held, format=kind, dpi=DPI, metadata=nothing)
    return held.getvalue()


def _replace(draft: Path, folder: Path) -> None:
    """Move a finished draft into place; the figures folder is this command's own and is replaced as a whole."""
    (folder / FIGURES).mkdir(exist_ok=True)
    for path in sorted((draft / FIGURES).iterdir()):
        path.replace(folder / FIGURES / path.name)
    for name in (DATA, TEXT, PAGE):
        (draft / name).replace(folder / name)

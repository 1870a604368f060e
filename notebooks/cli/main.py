"""The command line: every command of ``thermicon``, grouped by job.

A command imports what it needs when it runs, so that ``check`` answers at once. The work of each command is in a module
of this package.
"""

from __future__ import annotations

import gc
import sys
from typing import Annotated

import typer

from ..messages import be_quiet, interrupted
from ..startup import is_command, print_anywhere, warn_if_hidden
from .app import Commands, with_command
from .check import check_command
from .compare import compare_command
from .convert import convert_command
from .export import export_command
from .fit import fit_command
from .improve import improve_command
from .lab import lab_command
from .listing import list_command
from .options import flat
from .pilot import pilot_command
from .ranking import rank_command
from .simulate import simulate_command
from .study import study_command
from .sweep import sweep_command
from .validation import validate_command

WRITE, SIMULATE, PREDICT = "Write icons", "Simulate a rig", "Predict perception"
PLAY, NOTEBOOKS, INSTALLATION = "Play on hardware", "Notebooks", "Installation"
"""Jobs, as the headings of ``thermicon --help``."""

app = typer.Typer(
    name="thermicon",
    cls=Commands,
    help="Design thermal icons, simulate them on display and skin, and predict which ones people confuse.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"thermicon {version('thermicon')}")
        raise typer.Exit


@app.callback()
def thermicon(
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="No progress, notes or warnings: results and errors only.")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Design thermal icons, simulate them on display and skin, and predict which ones people confuse."""
    be_quiet(quiet)


def doctor_command(
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of lines.")] = False,
) -> None:
    """Check the installation: versions, extras, outside programs, cache, fonts, Jupyter, and a self-test.

    Every line is ok, a note (something that can be done without) or a fault, with its cure. With a fault, the exit code
    is 1.
    """
    from .examine import doctor

    raise typer.Exit(doctor(json))


for _name, _command, _job in (
    ("check", check_command, WRITE),
    ("convert", convert_command, WRITE),
    ("list", list_command, WRITE),
    ("simulate", simulate_command, SIMULATE),
    ("sweep", sweep_command, SIMULATE),
    ("compare", compare_command, SIMULATE),
    ("fit", fit_command, SIMULATE),
    ("rank", rank_command, PREDICT),
    ("improve", improve_command, PREDICT),
    ("pilot", pilot_command, PREDICT),
    ("validate", validate_command, PREDICT),
    ("export", export_command, PLAY),
    ("study", study_command, PLAY),
    ("lab", lab_command, NOTEBOOKS),
    ("doctor", doctor_command, INSTALLATION),
):
    app.command(_name, rich_help_panel=_job)(flat(_command))


def main() -> None:
    """Run the command line of the process; the entry point of the ``thermicon`` command."""
    # What imports create is not garbage, and looking for some after each 700 objects takes a twentieth of a command.
    gc.set_threshold(100_000)
    try:
        if is_command():
            warn_if_hidden()
        print_anywhere()
        with_command(app, sys.argv[1:2])(prog_name="thermicon")
    except KeyboardInterrupt:
        sys.exit(interrupted().exit_code)
    finally:
        gc.freeze()  # a process that ends needs no last search for garbage either


if __name__ == "__main__":
    main()

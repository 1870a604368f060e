"""The faces of thermicon: command line, figures, notebooks."""

from .startup import guard

guard()  # before anything that takes time to import

from typing import TYPE_CHECKING, Any

from .figures.overview import overview, set_figure
from .cli.sweep import sweep
from .figures.sweep_figure import sweep_figure

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from .workbench.workbench import Workbench as Workbench

__all__ = ["overview", "set_figure", "sweep", "sweep_figure", "Workbench"]


def __getattr__(name: str) -> Any:
    """Load the workbench when it is first asked for: commands that draw nothing do without."""
    if name == "Workbench":
        from .workbench.workbench import Workbench

        return Workbench
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Bring the ``%%cue`` cell magic and small pictures of figures: what ``%load_ext thermicon.notebooks`` calls."""
    from .figures import inline
    from .workbench import magic

    magic.register(shell)
    inline.register(shell)


def unload_ipython_extension(shell: "InteractiveShell") -> None:
    """Take both away again: what ``%unload_ext thermicon.notebooks`` calls."""
    from .figures import inline
    from .workbench import magic

    magic.unregister(shell)
    inline.unregister(shell)

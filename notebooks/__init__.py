"""The faces of thermicon: command line, figures, notebooks."""

from .startup import guard, print_anywhere


def _examine(error: BaseException) -> int:
    import sys

    from .cli.examine import doctor

    print_anywhere()
    return doctor("--json" in sys.argv, error)


guard(_examine)  # before anything that takes time to import, or that may be broken

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from .cli.sweep import sweep as sweep
    from .figures.overview import overview as overview, set_figure as set_figure
    from .figures.sweep_figure import sweep_figure as sweep_figure
    from .workbench.workbench import Workbench as Workbench

__all__ = ["overview", "set_figure", "sweep", "sweep_figure", "Workbench"]

_ROOMS = {
    "overview": "figures.overview",
    "set_figure": "figures.overview",
    "sweep": "cli.sweep",
    "sweep_figure": "figures.sweep_figure",
    "Workbench": "workbench.workbench",
}


def __getattr__(name: str) -> Any:
    """Load what is first asked for: commands do without, and where a library is missing, the others still work."""
    if name in _ROOMS:
        return getattr(import_module(f".{_ROOMS[name]}", __name__), name)
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

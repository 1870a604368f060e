"""thermicon.notebooks: the command line and the workbench."""

from .startup import guard

guard()  # before anything that takes time to import, or that may be broken

from typing import TYPE_CHECKING

from lazy_loader import attach_stub

from thermicon.base.checks.arguments import register

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Bring the ``%%cue`` cell magic and small pictures of figures: what ``%load_ext thermicon.notebooks`` calls."""
    from .workbench import magic

    magic.register(shell)


def unload_ipython_extension(shell: "InteractiveShell") -> None:
    """Take both away again: what ``%unload_ext thermicon.notebooks`` calls."""
    from .workbench import magic

    magic.unregister(shell)


register("thermicon.icons", "thermicon.circuit", "thermicon.perception", "thermicon.notebooks")

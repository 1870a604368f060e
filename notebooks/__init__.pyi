# The names of this package in the order of the flow; each is imported when it is first asked for.
import IPython.core.interactiveshell

from .cli.sweep import sweep as sweep
from .figures.overview import overview as overview
from .workbench.live_panel import LivePlay as LivePlay
from .workbench.workbench import Workbench as Workbench

def load_ipython_extension(shell: IPython.core.interactiveshell.InteractiveShell) -> None: ...
def unload_ipython_extension(shell: IPython.core.interactiveshell.InteractiveShell) -> None: ...

"""The command line, as ``python -m thermicon.notebooks``."""

from __future__ import annotations

from .cli.main import main

if __name__ == "__main__":
    main()

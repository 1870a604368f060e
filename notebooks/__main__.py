"""The command line as ``python -m thermicon.notebooks``."""

from .cli.main import main

if __name__ == "__main__":
    main()

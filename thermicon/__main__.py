"""The command line as ``python -m thermicon``."""

from thermicon.notebooks.cli.main import main

if __name__ == "__main__":
    main()

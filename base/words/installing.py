"""The command that adds a missing package to the running environment."""

import sys
from importlib.util import find_spec
from pathlib import Path

TOOLS = {
    "conda-meta": "conda install -c conda-forge",
    "pipx_metadata.json": "pipx inject thermicon",
    "uv-receipt.toml": "uv tool install thermicon -w",
}
"""What stands in the folder of an environment, by the tool that made it and whose command adds to it."""


def install(package: str) -> str:
    """The command that adds a package, by its name on PyPI, as thermicon itself was installed."""
    for mark, command in TOOLS.items():
        if (Path(sys.prefix) / mark).exists():
            return f"{command} {package.lower() if 'conda' in command else package}"
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    return f"{python} -m pip install {package}" if find_spec("pip") else f"uv pip install -p {python} {package}"

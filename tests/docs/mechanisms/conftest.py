"""The pictures of mechanisms and of the inference are made beside their pages and are not installed."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "docs" / "explain"))

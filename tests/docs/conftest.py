"""The pictures, studies and tables of the pages are made beside them and are not installed."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path[:0] = [str(DOCS / "explain"), str(DOCS / "builder")]

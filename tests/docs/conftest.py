"""The path to the pictures, studies or tables that stand beside the pages without being installed."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
sys.path[:0] = [str(DOCS / "explain"), str(DOCS / "builder")]

import subprocess
import sys


def test_import_is_light() -> None:
    heavy = "numba pandas matplotlib scipy IPython"
    code = f"import sys, thermicon.perception; print([m for m in '{heavy}'.split() if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"

import subprocess
import sys

import thermicon.perception as package


def test_every_public_name_is_there() -> None:
    for name in package.__all__:
        assert getattr(package, name).__doc__ or name.isupper() or name in ("Channel", "Norm", "Variable", "Model")


def test_import_is_light() -> None:
    heavy = "numba pandas matplotlib scipy IPython"
    code = f"import sys, thermicon.perception; print([m for m in '{heavy}'.split() if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"

"""The package as a whole: what it names, what it imports and what it draws."""

import subprocess
import sys

from matplotlib.colors import to_rgb

import thermicon.icons
from thermicon.icons import load_library
from thermicon.icons.pictures.draw import COOL, STAY, WARM


def test_all_names_exist() -> None:
    assert all(hasattr(thermicon.icons, name) for name in thermicon.icons.__all__)


def test_parsing_imports_nothing_heavy() -> None:
    code = (
        "import sys; from thermicon.icons import read_cue; repr(read_cue('six-icons').icons[0].corners()); "
        "print([name for name in ('numpy', 'pandas', 'numba', 'matplotlib', 'pydantic') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_plot_shows_levels_times_and_directions() -> None:
    icon = load_library("six-icons")["cooling-step"]
    ax = icon.plot()
    (lines,) = ax.collections
    assert [segment.tolist() for segment in lines.get_segments()] == [
        [[0.0, 32.0], [2.0, 26.0]],
        [[2.0, 26.0], [6.0, 26.0]],
        [[6.0, 26.0], [8.0, 32.0]],
    ]
    assert [tuple(colour[:3]) for colour in lines.get_colors()] == [to_rgb(c) for c in (COOL, STAY, WARM)]
    assert (ax.get_title(), ax.get_xlabel(), ax.get_ylabel()) == (
        "cooling-step",
        "time (s)",
        "display temperature (°C)",
    )


def test_cool_and_warm_differ_in_grey() -> None:
    grey = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in map(to_rgb, (COOL, WARM, STAY))]
    assert grey[1] - grey[0] > 0.25
    assert grey[1] - grey[2] > 0.25

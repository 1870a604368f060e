"""Films of an icon and of what is felt of it."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.legible import troubles
from thermicon.base.files.atomic import OutputError
from thermicon.circuit import simulate
from thermicon.icons import Icon, load_library, parse
from thermicon.perception import perceive
from thermicon.perception.plots.film import GREY, Film, movie_writer


def film_of(icon: Icon) -> Film:
    trace = simulate(icon, "thenar", tail_s=1.0)
    return perceive(trace).film(trace)


@pytest.fixture(scope="module")
def felt() -> Film:
    return film_of(load_library("six-icons")["cold-to-warm"])


@pytest.fixture(scope="module")
def unfelt() -> Film:
    text = "cue 1\nset a { control skin }\nicon faint { cool by 0.05 °C at 1 °C/s; return at 1 °C/s }\n"
    return film_of(parse(text)["faint"])


def test_a_moving_svg_shows_what_is_felt_at_each_moment(felt: Film) -> None:
    svg, percept = felt.svg(), felt.percept
    assert svg == felt.svg()
    for name, psi in (("cold", percept.psi_cold), ("warm", percept.psi_warm)):
        frames = re.search(f"@keyframes {name} .*", svg)
        assert frames is not None
        shares = np.array(re.findall(r"scaleY\(([\d.]+)\)", frames[0]), dtype=float)
        np.testing.assert_allclose(shares, np.interp(felt.moments_s, percept.time_s, psi) / psi.max(), atol=0.001)
    stands = re.search(r"animation-delay: -([\d.]+)s", felt.svg(still=True))
    assert stands is not None
    assert percept.onset_s is not None
    assert float(stands[1]) >= percept.onset_s


def test_a_gif_lasts_as_long_as_the_run_and_no_letters_collide(felt: Film, tmp_path: Path) -> None:
    felt.save(tmp_path / "a.gif")
    lasts_s = 0.0
    with Image.open(tmp_path / "a.gif") as image:
        for k in range(image.n_frames):  # type: ignore[attr-defined]
            image.seek(k)
            lasts_s += image.info["duration"] / 1000.0
    assert lasts_s == pytest.approx(felt.percept.time_s[-1] + felt.moments_s[1])
    assert troubles(felt._drawn()[0]) == []


def test_what_is_not_felt_is_grey_and_the_film_says_so(felt: Film, unfelt: Film) -> None:
    assert "not felt" in unfelt.svg()
    assert "not felt" not in felt.svg()
    assert "not felt" in unfelt._repr_html_()
    colours = [{bar.get_facecolor()[:3] for bar in film._drawn()[0].axes[3].patches} for film in (unfelt, felt)]
    assert colours[0] == {(float(GREY),) * 3}
    assert len(colours[1]) == 2


def test_a_film_of_another_run_or_ending_or_without_ffmpeg_is_refused(
    felt: Film, unfelt: Film, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="not its run"):
        felt.percept.film(unfelt.trace)
    with pytest.raises(OutputError, match=r"\.gif"):
        felt.save(tmp_path / "a.png")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OutputError, match="apt install ffmpeg"):
        movie_writer(Path("a.mp4"))
    program = tmp_path / "ffmpeg"
    program.write_text("")
    program.chmod(0o755)
    assert movie_writer(Path("a.mp4")) is not None

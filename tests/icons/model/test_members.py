"""Members of a family that are sound exactly when each is sound as an icon."""

from itertools import product
from typing import Any

import pytest
from hypothesis import strategies as st

from tests.builders import messages
from tests.properties import for_any
from thermicon.icons import CueErrors, Family, parse
from thermicon.icons.model.check import MOST_CORNERS, corner_count
from thermicon.icons.model.statements import Wave

FOUND = messages(__file__, "cases.toml")["members"]
VALUES, SKIN, CURRENT, BOTH, ENDS, OTHER = (
    FOUND[name] for name in ("values", "skin", "current", "both", "ends", "other")
)


class Chooser:
    """Fills statements with numbers, or with the parameters of the family."""

    def __init__(self, draw: Any) -> None:
        self.draw = draw
        self.over = {
            f"p{letter}": (kind, draw(st.lists(st.sampled_from(VALUES[kind][1]), min_size=1, max_size=3, unique=True)))
            for letter, kind in zip("abc", draw(st.permutations(list(VALUES)))[:3], strict=True)
        }
        self.used: set[str] = set()

    def body(self, control: str, depth: int) -> str:
        lines = []
        for _ in range(self.draw(st.integers(1, 3))):
            line = self.draw(st.sampled_from((SKIN if control == "skin" else CURRENT) + BOTH[: 5 if depth else 4]))
            lines.append(self.filled(line, control, depth))
        return "; ".join(lines)

    def filled(self, line: str, control: str, depth: int) -> str:
        for kind, (unit, numbers) in VALUES.items():
            while f"{{{kind}}}" in line:
                own = [name for name, (of, _) in self.over.items() if of == kind]
                name = own[0] if own and self.draw(st.booleans()) else None
                text = f"<{name}>" if name else f"{self.draw(st.sampled_from(numbers[:-1]))} {unit}"
                self.used |= {name} if name else set()
                line = line.replace(f"{{{kind}}}", text, 1)
        if "{body}" in line:
            line = line.replace("{{{body}}}", f"{{ {self.body(control, depth - 1)} }}")
        return line


@st.composite
def families(draw: Any) -> tuple[str, list[str]]:
    """The text of a file with a family, and a text for each of its members."""
    control = draw(st.sampled_from(["skin", "skin", "current"]))
    chooser = Chooser(draw)
    body = chooser.body(control, 2)
    if draw(st.integers(0, 3)) == 0:
        body += "; " + chooser.filled(draw(st.sampled_from(ENDS)), control, 0)
    names = [name for name in chooser.over if name in chooser.used]
    if not names:
        body, names, chooser.over["pa"] = body + "; hold for <pa>", ["pa"], ("time", ["1", "2"])
    head = f"cue 1\nset {{ control {control} }}\n{OTHER[control]}\n"
    over = [f"{name} in [{', '.join(chooser.over[name][1])}] {VALUES[chooser.over[name][0]][0]}" for name in names]
    members = []
    for values in product(*(chooser.over[name][1] for name in names)):
        text = body
        for name, value in zip(names, values, strict=True):
            text = text.replace(f"<{name}>", f"{value} {VALUES[chooser.over[name][0]][0]}")
        members.append(f"{head}icon x {{ {text} }}")
    plain = body.replace("<", "").replace(">", "")
    return f"{head}icon x({', '.join(over)}) {{ {plain} }}", members


def outcome(text: str) -> Any:
    try:
        return parse(text).entries[-1]
    except CueErrors as found:
        return found


@for_any(families(), examples=300)
def test_a_family_is_sound_exactly_when_its_members_are(made: tuple[str, list[str]]) -> None:
    text, members = made
    family, icons = outcome(text), [outcome(member) for member in members]
    wrong = [str(found) for found in icons if isinstance(found, CueErrors)]
    if wrong:
        assert isinstance(family, CueErrors), (text, wrong[0])
        assert {error.code for error in family.errors} & {
            error.code for found in icons if isinstance(found, CueErrors) for error in found.errors
        }, (text, str(family), wrong)
        return
    assert isinstance(family, Family), (text, str(family))
    assert [icon.statements for icon in family] == [icon.statements for icon in icons]
    found, corners = family.summary(), [icon.corners() for icon in icons]
    # A corner of a sine that is cut may lie half a tolerance above it; its chords are a little less steep.
    near, slope = (5.1e-4, 0.05) if "sine" in text else (1e-9, 1e-5)
    lowest, highest = min(one.lowest for one in corners), max(one.highest for one in corners)
    assert found.shortest_s == pytest.approx(min(one.duration_s for one in corners), rel=1e-12)
    assert found.longest_s == pytest.approx(max(one.duration_s for one in corners), rel=1e-12)
    assert found.lowest <= lowest + near
    assert found.highest >= highest - near
    if "step" not in text:  # a level between two steps in one moment is passed, but no corner
        assert found.lowest >= lowest - near
        assert found.highest <= highest + near
    assert found.steepest_per_s == pytest.approx(max(one.steepest_per_s for one in corners), rel=slope, abs=1e-9)


MESSAGES = messages(__file__)


@pytest.mark.parametrize("family", MESSAGES["member"])
def test_what_is_wrong_with_a_member_is_told(family: str) -> None:
    holds = "; ".join(["hold for 1 ms"] * 10)
    with pytest.raises(CueErrors, match=f"(?s){MESSAGES['member'][family]}"):
        parse(f"cue 1\nicon p {{ {holds} }}\nicon {family}")


def test_quotients_that_floats_miss_are_whole() -> None:
    text = "cue 1; icon x(a in 0.1..9.9 step 0.1 s) { square by 3 K every 100 ms for a cut; rest for 1 s }"
    assert len(parse(text).families[0]) == 99
    assert len(parse(text.replace(" cut", "").replace("square", "sine"))) == 99


def test_an_amplitude_counts_with_its_own_corners() -> None:
    waves = [Wave("sine", by_K=n / 10, period_s=1, duration_s=2500) for n in range(1, 31)]
    many = sum(corner_count([wave]) > MOST_CORNERS for wave in waves)
    assert 0 < many < 29
    with pytest.raises(CueErrors, match=f"E220 (?s:.)*one of {many} such members of 30"):
        parse("cue 1; icon x(a in 0.1..3 step 0.1 K) { sine by a every 1 s for 2500 s }")

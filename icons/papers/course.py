"""The course of an icon in the words of a paper, from its statements."""

from collections.abc import Sequence

from ..model.format import Holes, Path, Wording
from ..model.shapes import Pulse, Step, Wave
from ..model.statements import Broken, Current, Hold, Play, Ramp, Repeat, Rest, Return, Statement, Total
from ..model.units import Kind
from ..model.value_limits import Control

_RAMPS = {"warm": "warming", "cool": "cooling", "change": "a change"}
_SIDES = {"warm": " up", "cool": " down", "change": ""}
_COUNTS = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]


def course(body: Sequence[Statement], control: Control, holes: Holes | None = None, path: Path = ()) -> str:
    """Return statements as one phrase; ``holes`` names the parameter that stands in a field, as in ``format``.

    >>> course((Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)), "skin")
    'cooling by 6 °C at 3 °C/s, a hold of 4 s and a return to baseline at 3 °C/s'
    """
    teller = _Teller(control, holes or {})
    return teller.body(body, path)


def counted(count: int, noun: str) -> str:
    """Return a number and a noun, in words up to twelve.

    >>> counted(1, "icon"), counted(6, "icon"), counted(240, "icon")
    ('one icon', 'six icons', '240 icons')
    """
    number = _COUNTS[count] if count < len(_COUNTS) else f"{count:,}"
    return f"{number} {noun}{'' if count == 1 else 's'}"


def listed(parts: Sequence[str]) -> str:
    """Return parts joined as a sentence lists them.

    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join(filter(None, (", ".join(parts[:-1]), *parts[-1:])))


class _Teller(Wording):
    def body(self, body: "Sequence[Statement | Broken]", path: Path) -> str:
        told = (self.phrase(part, (*path, n)) for n, part in enumerate(body))
        return listed([phrase for phrase in told if phrase])

    def phrase(self, part: Statement | Broken, path: Path) -> str:
        match part:
            case Ramp(direction=word):
                return f"{_RAMPS[word]} {self.goal(part, path)} {self.pace(part, path)}"
            case Current():
                return f"a ramp {self.goal(part, path)} {self.pace(part, path)}"
            case Hold():
                return f"a hold of {self.value(part, path, 'duration_s', 'time')}"
            case Rest():
                return f"a rest of {self.value(part, path, 'duration_s', 'time')} at baseline"
            case Return():
                return f"a return to baseline {self.pace(part, path)}"
            case Step(direction=word):
                return f"a step{_SIDES[word]} {self.goal(part, path)}"
            case Pulse(direction=word):
                time = self.value(part, path, "duration_s", "time")
                return f"a pulse{_SIDES[word]} {self.goal(part, path)} for {time}"
            case Wave():
                size = self.goal(part, path).removeprefix("by ")
                period, time = (self.value(part, path, name, "time") for name in ("period_s", "duration_s"))
                shape = "sawtooth wave" if part.shape == "sawtooth" else f"{part.shape} wave"
                first = "upwards" if part.sign > 0 else "downwards"
                return f"a {shape} of ±{size} and a period of {period} for {time}, {first} first"
            case Play():
                return f"the course of {part.icon.name}"
            case Repeat():
                count = self.holes.get((path, "count"), f"{part.count:,}")
                return f"{count} times ({self.body(part.body, path)})"
            case Total() | Broken():
                return ""

    def value(self, part: object, path: Path, name: str, kind: Kind) -> str:
        text = super().value(part, path, name, kind)
        return text if (path, name) in self.holes else text.replace("-", "−", 1)

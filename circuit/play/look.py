"""One look at the sensors of a display in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping

from .watch import Stopped


class SensorLook:
    """Reads sensors one after another, so that functions of one bus are never called at once.

    The guard does not wait for them: a reading that never comes back must not keep the output on.
    """

    def __init__(self, sensors: Mapping[str, Callable[[], float]], clock: Callable[[], float]) -> None:
        self.done = threading.Event()
        self._names = list(sensors)
        self._answers: dict[str, object] = {}
        self._took_s: dict[str, float] = {}
        threading.Thread(target=self._read, args=(sensors, clock), daemon=True).start()

    def _read(self, sensors: Mapping[str, Callable[[], float]], clock: Callable[[], float]) -> None:
        for name, read in sensors.items():
            began_s = clock()
            try:
                self._answers[name] = read()
            except BaseException as problem:  # told where it is judged
                self._answers[name] = problem
            self._took_s[name] = clock() - began_s
        self.done.set()

    @property
    def took_s(self) -> float:
        """The time of all readings together, measured around them."""
        return sum(self._took_s.values())

    def slowest(self, waited_s: float) -> tuple[str, float]:
        """The sensor that took longest and its time in s, where one has not answered after `waited_s` that one."""
        took_s = dict(self._took_s)
        if len(took_s) < len(self._names):
            return self._names[len(took_s)], waited_s - sum(took_s.values())
        return max(took_s.items(), key=lambda taken: taken[1])

    def levels_C(self) -> dict[str, float]:
        """What was read in °C by sensor."""
        levels = {}
        for name, answer in self._answers.items():
            if not isinstance(answer, BaseException):
                try:
                    levels[name] = float(answer)  # type: ignore[arg-type]
                    continue
                except Exception as problem:
                    answer = problem
            raise Stopped(f"the {name} is lost ({str(answer) or type(answer).__name__})") from answer
        return levels

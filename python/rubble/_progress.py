"""Progress of long calls: a bar on a terminal, a line every tenth in a log."""
from __future__ import annotations

import sys
import time
from typing import Any, Callable, Optional, Union

#: True: shown on standard error. A function is called with what is done, all there is, and the time left [s].
ProgressOption = Union[bool, None, Callable[[int, int, float], Any]]

_WIDTH = 30
_REDRAW = 0.1  # time between two drawings of the bar [s]


def _duration(seconds: float) -> str:
    whole = round(seconds)
    return f"{whole} s" if whole < 60 else f"{whole // 60}:{whole % 60:02} min"


class Progress:
    """Shows `count` parts of a call, as the program `rubble` does.

    Args:
        option: What the caller of the package gave.
        title: What goes on.
        count: Number of parts.
        unit: What is counted.
    """

    def __init__(self, option: ProgressOption, title: str, count: int, unit: str = "step") -> None:
        self._call = option if callable(option) else None
        self._shown = bool(option) and self._call is None
        self._title, self._count, self._unit = title, max(count, 1), unit
        self._stream = sys.stderr
        self._terminal = self._shown and bool(getattr(self._stream, "isatty", bool)())
        self._start, self._drawn, self._tenths, self._open = time.monotonic(), 0.0, 0, False
        encoding = getattr(self._stream, "encoding", None) or "ascii"
        self._blocks = "█░" if encoding.lower().replace("-", "") == "utf8" else "#."

    def update(self, done: int, ms: float = 0) -> None:
        """After `done` parts. `ms`: of the last step; 0: it did not take one."""
        if self._call is None and not self._shown:
            return
        elapsed = time.monotonic() - self._start
        left = elapsed / done * (self._count - done)
        if self._call is not None:
            self._call(done, self._count, left)
        elif self._terminal:
            self._bar(done, ms, elapsed, left)
        else:
            self._line(done, ms, elapsed, left)

    def _bar(self, done: int, ms: float, elapsed: float, left: float) -> None:
        if done < self._count and elapsed - self._drawn < _REDRAW:
            return
        self._drawn = elapsed
        filled = min(_WIDTH, _WIDTH * done // self._count)
        bar = self._blocks[0] * filled + self._blocks[1] * (_WIDTH - filled)
        speed = f"{ms:.1f} ms/step  " if ms else ""
        rest = f"{_duration(left)} left" if done < self._count else _duration(elapsed)
        self._write(f"\r{self._title} {bar} {self._unit} {done}/{self._count}  {speed}{rest}\x1b[K")
        self._open = done < self._count
        if not self._open:
            self._write("\n")

    def _line(self, done: int, ms: float, elapsed: float, left: float) -> None:
        tenths = 10 * done // self._count
        if tenths == self._tenths:
            return
        self._tenths = tenths
        speed = f"{ms:.1f} ms/step, " if ms else ""
        self._write(f"{self._title}: {self._unit} {done}/{self._count}, {speed}{_duration(elapsed)}, "
                    f"{_duration(left)} left\n")

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *_: Any) -> Optional[bool]:
        """Ends an open bar, so that what comes after it, a traceback for instance, has its own line."""
        if self._open:
            self._write("\n")
        return None

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a person does with a keyboard or a joystick, as speeds from -1 to 1."""

import os
import re
import select
import struct
import sys
import termios
import tty
from contextlib import suppress
from typing import Dict, List, NamedTuple, Tuple

HOLD = 0.6  # seconds until a pressed key counts as released: longer than the delay of key repeat
DEAD_ZONE = 0.1  # share of a stick's range


class Command(NamedTuple):
    """Speed in shares of the maximum."""

    forward: float = 0.0  # translation
    left: float = 0.0  # rotation


KEYS: Dict[str, Command] = {
    "\x1b[A": Command(1, 0), "w": Command(1, 0), "\x1b[B": Command(-1, 0), "s": Command(-1, 0),
    "\x1b[D": Command(0, 1), "a": Command(0, 1), "\x1b[C": Command(0, -1), "d": Command(0, -1),
    "q": Command(1, 1), "e": Command(1, -1), " ": Command(),
}  # fmt: skip
_KEY = re.compile(r"\x1b\[.|.", re.DOTALL)  # an arrow sends three characters


class Keyboard:
    """The terminal: arrow keys or w, a, s, d; q and e for curves, space stops."""

    help = "arrow keys or w a s d: drive; q e: curves; space: stop; Ctrl-C: end"

    def __init__(self):
        """:raises OSError: there is no terminal"""
        if not sys.stdin.isatty():
            raise OSError(
                "no terminal for the keyboard: start `rosrun sextant teleop` in one, or set ~joystick"
            )
        self._file = sys.stdin.fileno()
        self._saved = termios.tcgetattr(self._file)
        tty.setcbreak(self._file)
        self._command, self._pressed = Command(), -HOLD

    def read(self, now: float) -> Command:
        """The command at a time, seconds."""
        while select.select([self._file], [], [], 0.0)[0]:
            keys = _KEY.findall(os.read(self._file, 64).decode(errors="ignore"))
            if not keys:  # the terminal was closed
                break
            self._command, self._pressed = KEYS.get(keys[-1], Command()), now
        return self._command if now - self._pressed < HOLD else Command()

    def close(self) -> None:
        """Restores the terminal."""
        with suppress(termios.error):  # it was closed
            termios.tcsetattr(self._file, termios.TCSADRAIN, self._saved)


class Joystick:
    """A joystick or gamepad of Linux: the first stick drives while a button is held.

    Its events: https://www.kernel.org/doc/html/latest/input/joydev/joystick-api.html
    """

    help = "hold any button: the first stick drives; release it: stop"
    _EVENT = struct.Struct("IhBB")  # milliseconds, value, type, number
    _BUTTON, _AXIS, _INITIAL = 1, 2, 0x80

    def __init__(self, device: str):
        """:raises OSError: the device cannot be opened"""
        self._device = device
        self._file = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        self._axes: Dict[int, float] = {}
        self._buttons: Dict[int, bool] = {}

    def read(self, _now: float) -> Command:
        """:raises OSError: the device was unplugged"""
        for value, kind, number in self._events():
            if kind == self._AXIS:
                self._axes[number] = value / 32767.0
            elif kind == self._BUTTON:
                self._buttons[number] = bool(value)
        if not any(self._buttons.values()):
            return Command()
        return Command(*(-self._stick(axis) for axis in (1, 0)))  # up and left are negative

    def _events(self) -> List[Tuple[int, int, int]]:
        events = []
        while select.select([self._file], [], [], 0.0)[0]:
            data = os.read(self._file, self._EVENT.size)
            if len(data) < self._EVENT.size:
                raise OSError(f"{self._device} was unplugged")
            _, value, kind, number = self._EVENT.unpack(data)
            events.append((value, kind & ~self._INITIAL, number))
        return events

    def _stick(self, axis: int) -> float:
        value = max(-1.0, min(1.0, self._axes.get(axis, 0.0)))
        return value if abs(value) > DEAD_ZONE else 0.0

    def close(self) -> None:
        """Closes the device."""
        os.close(self._file)

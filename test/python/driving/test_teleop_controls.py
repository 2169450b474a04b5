# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import pty
import struct
import sys
import termios

import pytest

from sextant.nodes.driving.teleop_controls import Command, Joystick, Keyboard


@pytest.fixture
def typed(monkeypatch):
    """A keyboard, and what types on it."""
    person, terminal = pty.openpty()
    with os.fdopen(terminal, "r", closefd=False) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        before = termios.tcgetattr(terminal)
        keyboard = Keyboard()
        yield keyboard, lambda keys: os.write(person, keys.encode())
        keyboard.close()
        assert termios.tcgetattr(terminal) == before  # as the shell expects it
    os.close(person)
    os.close(terminal)


def test_keys_drive_until_they_are_released(typed):
    keyboard, press = typed
    assert keyboard.read(0.0) == Command(0, 0)
    for keys, command in (
        ("\x1b[A", (1, 0)),
        ("s", (-1, 0)),
        ("\x1b[D", (0, 1)),
        ("e", (1, -1)),
        ("wwss", (-1, 0)),
        ("x", (0, 0)),
    ):
        press(keys)
        assert keyboard.read(1.0) == command
    press("w")
    assert keyboard.read(2.0) == (1, 0)
    assert keyboard.read(2.5) == (1, 0)  # the key is held: it is repeated after 0.5 s at the latest
    press("w")
    assert keyboard.read(2.55) == keyboard.read(3.1) == (1, 0)
    assert keyboard.read(3.2) == (0, 0)
    press("w")
    assert keyboard.read(4.0) == (1, 0)
    press(" ")
    assert keyboard.read(4.1) == (0, 0)


def test_without_a_terminal_there_is_a_reason(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    with open(tmp_path / "file") as file:
        monkeypatch.setattr(sys, "stdin", file)
        with pytest.raises(OSError, match="no terminal for the keyboard"):
            Keyboard()


@pytest.fixture
def stick(tmp_path):
    """A joystick, and what sends events of Linux's interface: (type, number, value)."""
    os.mkfifo(tmp_path / "js0")
    joystick = Joystick(str(tmp_path / "js0"))
    driver = os.open(tmp_path / "js0", os.O_WRONLY)

    def send(*events):
        for kind, number, value in events:
            os.write(driver, struct.pack("=IhBB", 1234, value, kind, number))

    yield joystick, send, lambda: os.close(driver)
    joystick.close()


BUTTON, AXIS, INITIAL = 1, 2, 0x80


def test_a_stick_drives_only_while_a_button_is_held(stick):
    joystick, send, unplug = stick
    send((BUTTON | INITIAL, 4, 0), (AXIS | INITIAL, 0, 0), (AXIS | INITIAL, 1, 0))
    assert joystick.read(0.0) == (0, 0)
    send((AXIS, 1, -32767), (AXIS, 0, 16384))  # up, half to the right
    assert joystick.read(0.1) == (0, 0)
    send((BUTTON, 4, 1))
    assert joystick.read(0.2) == pytest.approx((1.0, -0.5), abs=1e-4)
    send((AXIS, 1, 1000))  # a stick does not return to exactly zero
    assert joystick.read(0.3) == pytest.approx((0.0, -0.5), abs=1e-4)
    send((BUTTON, 4, 0))
    assert joystick.read(0.4) == (0, 0)
    unplug()
    with pytest.raises(OSError, match="js0 was unplugged"):
        joystick.read(0.5)

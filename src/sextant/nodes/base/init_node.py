# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Start of a rospy node: signal handlers that cannot deadlock, memory for images, check of registration."""

import atexit
import ctypes
import os
import signal
import sys
import threading
from contextlib import contextmanager
from typing import Iterator, List

import rospy

from sextant.nodes.base.registration_check import start_registration_check

EXIT = 0  # a byte that is no signal's number
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
M_MMAP_THRESHOLD = -3  # of glibc's malloc.h
MAPPED = 1 << 20  # bytes from which a buffer is returned to the system when it is freed


def init_node(name: str) -> None:
    """Calls rospy.init_node; SIGINT, SIGTERM and SIGHUP shut the node down in a thread of its own.

    rospy's own handler runs the shutdown in the main thread, wherever that was interrupted: if it held a lock
    that the shutdown needs (of an Event, of rospy's registrations), the node never ended.
    """
    signals, wakeup = os.pipe()
    os.set_blocking(wakeup, False)
    thread = threading.Thread(target=_shut_down_on_signal, args=(signals,), daemon=True)
    thread.start()
    signal.set_wakeup_fd(wakeup)
    for number in _handled_signals():
        signal.signal(number, lambda *_: None)  # Python writes its number to the pipe
    mend_rospy()
    ctypes.CDLL(None).mallopt(M_MMAP_THRESHOLD, MAPPED)  # else each thread of rospy keeps some freed images
    rospy.init_node(name, disable_signals=True)
    atexit.register(_finish, thread, wakeup)
    start_registration_check()


@contextmanager
def ends_on_signal() -> Iterator[None]:
    """Within it, a signal also raises SystemExit in the main thread: ends long work before the node runs.

    roslaunch kills a node 15 s after its signal.
    """

    def end(*_) -> None:
        restore()  # a second signal must not interrupt the clean-up
        sys.exit()

    def restore() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)

    before = {number: signal.signal(number, end) for number in _handled_signals()}
    try:
        if rospy.core.is_shutdown_requested():  # a signal came before
            sys.exit()
        yield
    finally:
        restore()


def _handled_signals() -> List[int]:
    """The signals that the node handles: not SIGHUP, that of a closed terminal, if nohup ignores it."""
    return [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]


def mend_rospy() -> None:
    """Adds the method of threads that rospy of Debian 11 calls at its shutdown and Python 3.9 lacks."""
    if not hasattr(threading.Thread, "isAlive"):
        threading.Thread.isAlive = threading.Thread.is_alive


def _shut_down_on_signal(signals: int) -> None:
    number = os.read(signals, 1)[0]
    if number != EXIT:
        rospy.signal_shutdown(f"signal-{number}")


def _finish(thread: threading.Thread, wakeup: int) -> None:
    """Waits until a shutdown that a signal has started is complete."""
    os.write(wakeup, bytes([EXIT]))
    thread.join()

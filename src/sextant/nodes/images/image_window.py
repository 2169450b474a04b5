# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A window that displays images. For the main thread only."""

import subprocess
import sys

import cv2
import numpy as np

MAX_SIDE = 900  # initial size of the window, pixels


class ImageWindow:
    """A resizable window."""

    def __init__(self, title: str):
        """:raises OSError: there is no display"""
        _require_display()
        self._title = title
        cv2.namedWindow(title, cv2.WINDOW_NORMAL | cv2.WINDOW_KEEPRATIO | cv2.WINDOW_GUI_NORMAL)
        self._is_sized = False

    def show(self, image: np.ndarray) -> None:
        """Displays an image: uint8 (height, width, 3), RGB."""
        height, width = image.shape[:2]
        if not self._is_sized:
            scale = min(1.0, MAX_SIDE / max(width, height))
            cv2.resizeWindow(self._title, round(scale * width), round(scale * height))
            self._is_sized = True
        cv2.imshow(self._title, image[:, :, ::-1])

    def live(self, seconds: float) -> bool:
        """Processes events of the window for this time; returns False when the window was closed."""
        cv2.waitKey(max(1, round(1000 * seconds)))
        try:
            visible = cv2.getWindowProperty(self._title, cv2.WND_PROP_VISIBLE)
            if visible < 0:  # OpenCV 4.5 with GTK does not have this property, but another of open windows
                visible = cv2.getWindowProperty(self._title, cv2.WND_PROP_AUTOSIZE) + 1
            return visible >= 1
        except cv2.error:  # OpenCV with Qt, after the last window
            return False


def _require_display() -> None:
    """In a process of its own, because Qt aborts the one that has no display."""
    trial = [sys.executable, "-c", "import cv2; cv2.namedWindow('trial')"]
    done = subprocess.run(trial, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
    if done.returncode != 0:
        raise OSError("there is no display for the window: set DISPLAY (ssh -X), or leave 'window' false")

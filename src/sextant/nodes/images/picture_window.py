# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A window that shows pictures. All of it is for the main thread."""

import subprocess
import sys

import cv2
import numpy as np

LARGEST_SIDE = 900  # pixels of the window at first; it can be drawn larger


class PictureWindow:
    """:raises OSError: there is no display"""

    def __init__(self, title: str):
        _require_display()
        self._title = title
        cv2.namedWindow(title, cv2.WINDOW_NORMAL | cv2.WINDOW_KEEPRATIO | cv2.WINDOW_GUI_NORMAL)
        self._is_sized = False

    def show(self, picture: np.ndarray) -> None:
        """:param picture: uint8 (height, width, 3), RGB"""
        height, width = picture.shape[:2]
        if not self._is_sized:
            scale = min(1.0, LARGEST_SIDE / max(width, height))
            cv2.resizeWindow(self._title, round(scale * width), round(scale * height))
            self._is_sized = True
        cv2.imshow(self._title, picture[:, :, ::-1])

    def live(self, seconds: float) -> bool:
        """Answers the user for so long. False: the window was closed."""
        cv2.waitKey(max(1, round(1000 * seconds)))
        try:
            return cv2.getWindowProperty(self._title, cv2.WND_PROP_VISIBLE) >= 1
        except cv2.error:  # OpenCV with Qt, after the last window
            return False


def _require_display() -> None:
    """In a process of its own, because Qt aborts the one that has no display."""
    trial = [sys.executable, "-c", "import cv2; cv2.namedWindow('trial')"]
    done = subprocess.run(trial, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
    if done.returncode != 0:
        raise OSError("there is no display for the window: set DISPLAY (ssh -X), or leave 'window' false")

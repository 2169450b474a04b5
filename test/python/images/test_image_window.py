# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A window on a display that exists, and on none."""

import os
import subprocess
import sys

import pytest

SHOWN = """
import cv2, numpy as np
from sextant.nodes.images.image_window import ImageWindow
window = ImageWindow("/park")
window.show(np.zeros((30, 40, 3), np.uint8))
print("open", window.live(0.2))
cv2.destroyAllWindows()
print("open", window.live(0.01))
"""


def run(*command):
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    return subprocess.run(
        [*command, sys.executable, "-c", SHOWN],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.slow
def test_a_window_lives_until_it_is_closed():
    done = run("xvfb-run", "-a")
    assert done.stdout.split("\n")[:2] == ["open True", "open False"], done.stderr


@pytest.mark.slow
def test_without_a_display_the_reason_is_reported():
    done = run()
    assert "OSError: there is no display for the window: set DISPLAY" in done.stderr
    assert done.returncode == 1

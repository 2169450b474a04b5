# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Waits for a file that another node writes."""

import time
from pathlib import Path

import rospy


def wait_for_file(path: str, timeout: float) -> None:
    """Returns when the file exists or the timeout has passed; reading a missing file then fails.

    :param timeout: seconds
    """
    end, is_logged = time.monotonic() + timeout, False
    while not Path(path).exists() and time.monotonic() < end and not rospy.is_shutdown():
        if not is_logged:
            rospy.loginfo("waiting for %s", path)
            is_logged = True
        time.sleep(0.1)

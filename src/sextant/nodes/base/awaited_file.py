# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Waiting for a file that another node makes."""

import time
from pathlib import Path

import rospy


def wait_for_file(path: str, patience: float) -> None:
    """Returns when the file is there, or nobody made it; then who reads it says so.

    :param patience: seconds
    """
    end, said = time.monotonic() + patience, False
    while not Path(path).exists() and time.monotonic() < end and not rospy.is_shutdown():
        if not said:
            rospy.loginfo("waiting for %s", path)
            said = True
        time.sleep(0.1)

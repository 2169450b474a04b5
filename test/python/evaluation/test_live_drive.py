# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.evaluation.live_drive import KEPT, JumpBack, LiveDrive

SECOND = 10**9
START = 1_600_000_000 * SECOND
T = np.eye(4)


def drive_of(*seconds):
    drive = LiveDrive()
    for second in seconds:
        drive.add_pose("map", START + second * SECOND, T, np.eye(6))
    return drive


def test_the_last_hour_is_kept():
    drive = drive_of(0, 1, 2)
    for second in (0, 1):
        drive.add_truth("map", START + second * SECOND, T)
    late = START + SECOND + KEPT
    drive.add_pose("map", late, T, np.eye(6))
    drive.add_truth("map", late, T)
    assert [pose[0] for pose in drive.poses] == [START + SECOND, START + 2 * SECOND, late]
    assert list(drive.truth) == [START + SECOND, late]
    assert [pose[0] for pose in drive.since(START + 2 * SECOND)] == [START + 2 * SECOND, late]


def test_a_truth_that_lags_behind_is_one():
    drive = drive_of(0, 10)
    for second in (5, 6, 7):
        drive.add_truth("map", START + second * SECOND, T)
    assert len(drive.truth) == 3 and len(drive.poses) == 2


@pytest.mark.parametrize("what", ["pose", "truth"])
def test_a_clock_that_was_set_back_is_reported(what):
    drive = drive_of(10)
    drive.add_truth("map", START + 10 * SECOND, T)

    def add(stamp):
        drive.add_pose("map", stamp, T, np.eye(6)) if what == "pose" else drive.add_truth("map", stamp, T)

    add(START + 9 * SECOND)  # out of order
    with pytest.raises(JumpBack):
        add(START + 8 * SECOND)
    assert START + 8 * SECOND not in [pose[0] for pose in drive.poses] + list(drive.truth)


def test_what_has_no_stamp_or_another_frame_is_refused_and_changes_nothing():
    drive = drive_of(0)
    with pytest.raises(ValueError, match="its stamp is zero"):
        drive.add_pose("map", 0, T, np.eye(6))
    elsewhere = "its frame is 'odom', the frame of the poses is 'map'"
    with pytest.raises(ValueError, match=elsewhere):
        drive.add_pose("odom", START, T, np.eye(6))
    with pytest.raises(ValueError, match=elsewhere):
        drive.add_truth("odom", START, T)
    assert (drive.frame, len(drive.poses), drive.truth) == ("map", 1, {})


def test_a_truth_before_the_first_pose_decides_nothing():
    drive = LiveDrive()
    drive.add_truth("odom", START, T)
    drive.add_pose("map", START, T, np.eye(6))
    assert (drive.frame, drive.truth) == ("map", {})

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Masters and nodes of the benchmarks."""

import pytest
import rospy
from ros_session import in_own_process, ros_node, wait_for
from std_msgs.msg import Int32


def received(number):
    """Numbers that this process receives from itself, as a node."""
    with ros_node() as folder:
        numbers = []
        rospy.Subscriber("numbers", Int32, lambda message: numbers.append(message.data), queue_size=1)
        rospy.Publisher("numbers", Int32, queue_size=1, latch=True).publish(number)
        wait_for("a number", lambda: numbers, 30.0)
    return numbers, folder


@pytest.mark.slow
def test_one_node_after_another():
    for number in (3, 4):
        numbers, folder = in_own_process(received, number)
        assert numbers == [number] and not folder.exists()


def never():
    return False


def test_errors_of_the_process_are_raised():
    with pytest.raises(TimeoutError, match="the end did not come within 0 s"):
        in_own_process(wait_for, "the end", never, 0.1)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by test_view_across_network.py on both sides: prints the stamps of the poses on a topic, seconds.

Arguments: topic, seconds of the wall clock after the first one.
"""

import json
import sys
import time

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped


def main():
    topic, seconds = sys.argv[1:]
    rospy.init_node("stamp_recorder", anonymous=True)
    stamps = []
    rospy.Subscriber(
        topic, PoseWithCovarianceStamped, lambda message: stamps.append(message.header.stamp.to_sec())
    )
    end = time.monotonic() + 30.0
    while not stamps and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(float(seconds))
    print(json.dumps(sorted(stamps)))


if __name__ == "__main__":
    main()

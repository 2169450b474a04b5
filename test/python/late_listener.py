# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by test_view_across_network.py on the viewing side: receives every topic once and prints a summary.

Arguments: topic of the pose, topic of the decompressed picture, seconds until it gives up, and the names of
nodes that it waits for until they subscribe to the map.
"""

import json
import sys
import time

import rosgraph
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from sensor_msgs.msg import Image
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray as Drawing

from sextant.msg import MarkerArray


class Received:
    def __init__(self):
        self.frames = set()  # of /tf_static, of which every node has a message of its own
        self.messages = {}

    def subscribe(self, name, topic, message_type):
        rospy.Subscriber(topic, message_type, lambda message: self.messages.setdefault(name, message))

    def complete(self):
        return len(self.messages) == 4 and len(self.frames) >= 9


def main():
    pose, picture, seconds, *viewers = sys.argv[1:]
    rospy.init_node("late_listener", anonymous=True)
    received = Received()
    rospy.Subscriber(
        "/tf_static", TFMessage, lambda all: received.frames.update(t.child_frame_id for t in all.transforms)
    )
    received.subscribe("pose", pose, PoseWithCovarianceStamped)
    received.subscribe("markers", "markers", MarkerArray)
    received.subscribe("boards", "marker_map", Drawing)
    received.subscribe("picture", picture, Image)
    end = time.monotonic() + float(seconds)
    while not (received.complete() and viewers_subscribe(viewers)) and time.monotonic() < end:
        time.sleep(0.1)
    print(json.dumps(summary(received)))


def subscribers():
    return dict(rosgraph.Master("late_listener").getSystemState()[1])


def viewers_subscribe(viewers):
    return not viewers or set(viewers) <= set(subscribers().get("/marker_map", []))


def summary(received):
    digests = {
        "pose": lambda message: message.header.frame_id,
        "markers": lambda message: message.header.frame_id,
        "boards": lambda message: len(message.markers),
        "picture": lambda message: [message.width, message.encoding],
    }
    brief = {name: digests[name](message) for name, message in received.messages.items()}
    return {**brief, "frames": sorted(received.frames), "subscribers": subscribers()}


if __name__ == "__main__":
    main()

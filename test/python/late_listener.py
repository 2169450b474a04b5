# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run by test_view_across_network.py on the viewing side: receives every topic once and prints a summary.

Arguments: seconds until it gives up; a node and a topic to which that node has to subscribe, or two empty
arguments; TOPIC:TYPE of what has to be received.
"""

import json
import sys
import time

import rosgraph
import rospy
from roslib.message import get_message_class
from tf2_msgs.msg import TFMessage


def main():
    seconds, node, displayed, *topics = sys.argv[1:]
    rospy.init_node("late_listener", anonymous=True)
    missing, frames, sizes = dict(each.split(":") for each in topics), set(), {}
    rospy.Subscriber(
        "/tf_static", TFMessage, lambda all: frames.update(t.child_frame_id for t in all.transforms)
    )

    def received(message, topic):
        sizes[topic] = len(getattr(message, "markers", ()))
        missing.pop(topic, None)

    subscribers = [
        rospy.Subscriber(topic, get_message_class(kind), received, topic)
        for topic, kind in list(missing.items())
    ]
    end = time.monotonic() + float(seconds)
    while (missing or node not in subscribers_of(displayed)) and time.monotonic() < end:
        time.sleep(0.2)
    time.sleep(5.0)  # /tf_static, of several nodes: a lost packet delays a connection by 1 to 3 s
    for subscriber in subscribers:
        subscriber.unregister()
    lacking = sorted(missing) + ([] if node in subscribers_of(displayed) else [node])
    summary = {"missing": lacking, "frames": sorted(frames), "sizes": sizes, "subscribers": all_subscribers()}
    print(json.dumps(summary))


def all_subscribers():
    return dict(rosgraph.Master("late_listener").getSystemState()[1])


def subscribers_of(topic):
    return all_subscribers().get(topic, []) if topic else [""]


if __name__ == "__main__":
    main()

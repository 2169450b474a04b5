# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests here listen with. Every wait ends; None is what came too late."""

import collections
import os
import re
import threading
import time
from xmlrpc.client import ServerProxy

import numpy as np
import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from sextant.nodes.base.init_node import mend_rospy

mend_rospy()
WAIT = 60.0  # s, far beyond what is needed: nodes may start at once, on a cold and busy machine

os.environ["PYTHONUNBUFFERED"] = "1"  # of nodes that a test starts: their output is in their log at once


def matrix(msg):
    """4 x 4 matrix of a Pose or a Transform."""
    p = getattr(msg, "position", None) or msg.translation
    q = getattr(msg, "orientation", None) or msg.rotation
    x, y, z, w = q.x, q.y, q.z, q.w
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = p.x, p.y, p.z
    return T


def transform(T_parent_child, parent, child, stamp):
    """Message of a pose (4 x 4)."""
    msg = TransformStamped(child_frame_id=child)
    msg.header.frame_id, msg.header.stamp = parent, stamp
    t, q = msg.transform.translation, msg.transform.rotation
    t.x, t.y, t.z = T_parent_child[:3, 3]
    q.x, q.y, q.z, q.w = quaternion(T_parent_child[:3, :3])
    return msg


def quaternion(R):
    """x y z w of a rotation: the eigenvector of Bar-Itzhack's matrix, which needs no cases."""
    N = np.array(
        [
            [R[0, 0] - R[1, 1] - R[2, 2], R[1, 0] + R[0, 1], R[2, 0] + R[0, 2], R[2, 1] - R[1, 2]],
            [0, R[1, 1] - R[0, 0] - R[2, 2], R[2, 1] + R[1, 2], R[0, 2] - R[2, 0]],
            [0, 0, R[2, 2] - R[0, 0] - R[1, 1], R[1, 0] - R[0, 1]],
            [0, 0, 0, np.trace(R)],
        ]
    )
    return np.linalg.eigh(N, UPLO="U")[1][:, -1]


class Recorder:
    """All messages of a topic by the stamp of their header."""

    def __init__(self, topic, type_):
        self._by_stamp = {}
        self._news = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, type_, self._on_message)

    def _on_message(self, msg):
        with self._news:
            self._by_stamp[msg.header.stamp] = msg
            self._news.notify_all()

    def at(self, stamp, timeout=WAIT):
        """The message of this stamp, or None after the timeout (seconds)."""
        with self._news:
            self._news.wait_for(lambda: stamp in self._by_stamp, timeout)
            return self._by_stamp.get(stamp)

    def has(self, stamp):
        return self.at(stamp, 0) is not None

    def all(self):
        with self._news:
            return list(self._by_stamp.values())

    def forget(self):
        with self._news:
            self._by_stamp.clear()

    def connected(self):
        """Whether a publisher, too, has the connection: its messages are received from now on."""
        return until(lambda: any(map(_reaches_publisher, self._subscriber.impl.get_stats_info())))

    def close(self):
        self._subscriber.unregister()


def _reaches_publisher(connection):
    """rospy counts a connection that it has only begun to make; the publisher lists those that it has."""
    _, publisher, _, _, _, _, text = connection
    port = re.search(r"on port (\d+) to", text)
    rows = ServerProxy(publisher).getBusInfo("/ros_probe")[2] if port else []
    return any(f":{port[1]} on socket" in row[-1] for row in rows)


class TransformRecorder:
    """The newest transform on /tf of every (parent, child, stamp)."""

    def __init__(self):
        self.seen = {}
        self._subscriber = rospy.Subscriber("/tf", TFMessage, self._on_message)

    def _on_message(self, msg):
        for each in msg.transforms:
            self.seen[each.header.frame_id, each.child_frame_id, each.header.stamp] = matrix(each.transform)

    def at(self, parent, child, stamp, timeout=WAIT):
        """4 x 4 matrix, or None after the timeout (seconds)."""
        until(lambda: (parent, child, stamp) in self.seen, timeout)
        return self.seen.get((parent, child, stamp))


class Diagnostics:
    """Rows of the newest diagnostics by the name of their status."""

    def __init__(self):
        self._status = {}
        self._received = collections.Counter()
        self._subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self._on_message)

    def _on_message(self, msg):
        for each in msg.status:
            self._status[each.name] = each
            self._received[each.name] += 1

    def renewed(self, name):
        """Waits for two further reports of this status: what happened before the call is in the second."""
        before = self._received[name]
        return until(lambda: self._received[name] >= before + 2)

    def summary(self, name):
        """What the operator reads of the status of this name."""
        status = self._status.get(name)
        return status.message if status else ""

    def count(self, name, key):
        """A counter; 0 while the row is not there."""
        return int(self.row(name, key) or 0)

    def row(self, name, key):
        """The text of a row; None while it is not there."""
        status = self._status.get(name)
        rows = {row.key: row.value for row in status.values} if status else {}
        return rows.get(key)

    def reaches(self, name, key, number, timeout=WAIT):
        return until(lambda: self.count(name, key) >= number, timeout)


def until(condition, timeout=WAIT):
    """True as soon as it holds, False after the timeout (seconds of the wall clock)."""
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def subscribers_of(topic):
    """Names of the nodes that subscribe to a topic, by the master."""
    _, subscribers, _ = rosgraph.Master("/ros_probe").getSystemState()
    return next((nodes for name, nodes in subscribers if name == topic), [])


def stamps():
    """Ever later stamps, 10 ms apart, from now on."""
    stamp = rospy.Time.now()
    while True:
        stamp += rospy.Duration(0.01)
        yield stamp

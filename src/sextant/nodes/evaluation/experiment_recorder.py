# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node experiment_recorder: records the poses of a simulated drive to a bag until it ends, then runs
accuracy_statistics."""

import sys
import threading
from dataclasses import dataclass
from typing import Dict, List

import rosbag
import rospkg
import rospy
from genpy.message import get_message_class
from nav_msgs.msg import Odometry

from sextant.base.strict_params import StrictParams, not_empty, param, required, within
from sextant.commands.accuracy_statistics import main as accuracy_statistics
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.evaluation.drive_watch import DriveWatch


@dataclass(frozen=True)
class ExperimentParams(StrictParams):
    """Parameters of the node."""

    output: str = required("prefix of the files to write: bag, errors and plots; overwritten", not_empty)
    poses: List[str] = required("topics of the poses to compare", not_empty)
    optional_poses: Dict[str, str] = param(
        {}, "further topics, by the package that publishes them; left out if the package is not installed"
    )
    align_start: List[str] = param([], "topics that have a frame of their own, as odometry")
    map_file: str = param("", "[marker map](marker_map.md) for the plots; empty: none")
    start_service: str = param(
        "", "service of type std_srvs/SetBool that is called when all topics are connected; empty: none"
    )
    timeout: float = param(
        60.0,
        "maximum time to wait for the topics, for the service, and for the next true pose",
        within(1.0, 3600.0),
        "s",
    )

    def all_poses(self) -> List[str]:
        """Returns the topics of poses, without those whose package is not installed."""
        topics, installed = list(self.poses), rospkg.RosPack().list()
        for package, topic in self.optional_poses.items():
            if package in installed:
                topics.append(topic)
            else:
                rospy.logwarn("rospack does not find %s: %s is left out", package, topic)
        return topics


class ExperimentRecorder:
    """Writes a bag of stamped messages, each at the time of its stamp.

    :raises OSError: the bag cannot be written
    """

    def __init__(self, params: ExperimentParams):
        self._params, self._lock = params, threading.Lock()  # rospy has one thread per topic
        self._watch = DriveWatch(params.start_service, params.timeout)
        self._truth = rospy.resolve_name("ground_truth")
        self._poses = [rospy.resolve_name(topic) for topic in params.all_poses()]
        self._bag = rosbag.Bag(params.output + ".bag", "w")
        self._inputs: Dict[str, rospy.Subscriber] = {}
        self._inputs[self._truth] = rospy.Subscriber("ground_truth", Odometry, self._on_message, self._truth)

    def record(self) -> bool:
        """Starts and records the drive; returns whether it has ended, False if the node is shut down before.

        :raises RuntimeError: a topic or the service is not available in time, or the drive stops
        """
        with self._bag:
            try:
                self._watch.start(self._missing)
                return self._watch.wait()
            finally:
                for each in self._inputs.values():
                    each.unregister()
                with self._lock:  # the last message is written
                    self._inputs.clear()

    def _missing(self) -> List[str]:
        """Subscribes to topics that are published now; returns those that are not connected yet."""
        published = dict(rospy.get_published_topics())
        for topic in published.keys() & (set(self._poses) - self._inputs.keys()):
            of_type = get_message_class(published[topic])
            self._inputs[topic] = rospy.Subscriber(topic, of_type, self._on_message, topic)
        connected = {topic for topic, each in self._inputs.items() if each.get_num_connections()}
        return [topic for topic in (self._truth, *self._poses) if topic not in connected]

    def _on_message(self, message, topic: str) -> None:
        with self._lock:
            if topic in self._inputs:
                self._bag.write(topic, message, message.header.stamp)
        if topic == self._truth:
            self._watch.pose_received()

    def evaluate(self) -> int:
        """Runs accuracy_statistics on the bag; returns its exit code."""
        aligned = [rospy.resolve_name(topic) for topic in self._params.align_start]
        options = ["--truth-topic", self._truth, "--pose", ",".join(self._poses), "--force"]
        options += ["--align-start", ",".join(aligned)] if aligned else []
        options += ["--map", self._params.map_file] if self._params.map_file else []
        return accuracy_statistics([self._bag.filename, *options, "--output", self._params.output])


def main() -> None:
    """Runs the node; exits with the status of accuracy_statistics."""
    init_node("experiment_recorder")
    params = read_params(ExperimentParams)
    with fatal(OSError, RuntimeError, ValueError, rospy.ROSException):
        recorder = ExperimentRecorder(params)
        has_ended = recorder.record()
    if has_ended:
        sys.exit(recorder.evaluate())

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node drive_recorder: collects the poses of a simulated drive until it ends, then compares them with the
ground truth."""

import os
import threading
from dataclasses import dataclass
from typing import Dict, List

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry, Path

from sextant.base.strict_params import not_empty, param, within
from sextant.evaluation.drive_plot import plot_drive
from sextant.evaluation.error_table import error_table
from sextant.evaluation.trajectory_metrics import trajectory_errors
from sextant.messages.pose_messages import pose_from_message
from sextant.msg import MarkerMapEntries
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.evaluation.drive_watch import DriveWatch
from sextant.nodes.markers.marker_map_messages import marker_from_entry

TRAIL = 1800  # maximum number of true poses in the published path


@dataclass(frozen=True)
class RecorderParams:
    """Parameters of the node."""

    modes: List[str] = param(
        ["nearest", "average", "joint"],
        "names of the locators; the node subscribes to `MODE/pose` of each",
        not_empty,
    )
    start_service: str = param(
        "", "service of type std_srvs/SetBool that is called when all topics are connected; empty: none"
    )
    timeout: float = param(
        60.0,
        "maximum time to wait for the topics, for the service, and for the next pose",
        within(1.0, 3600.0),
        "s",
    )
    plot: str = param("", "file for the plot of the drive; empty: none")


class DriveRecorder:
    """Collects true and estimated poses by stamp."""

    def __init__(self, params: RecorderParams):
        self._params = params
        self._lock = threading.Lock()  # rospy has one thread per topic
        self._truth: Dict[int, np.ndarray] = {}
        self._poses: Dict[str, Dict[int, np.ndarray]] = {mode: {} for mode in params.modes}
        self._markers: list = []
        self._watch = DriveWatch(params.start_service, params.timeout)
        self._trail = Path()
        self._path = rospy.Publisher("ground_truth/path", Path, queue_size=1)
        rospy.Subscriber("marker_map/entries", MarkerMapEntries, self._on_map)
        self._inputs = [rospy.Subscriber("ground_truth", Odometry, self._on_truth)]
        for mode in params.modes:
            topic = mode + "/pose"
            self._inputs.append(rospy.Subscriber(topic, PoseWithCovarianceStamped, self._on_pose, mode))

    def _on_truth(self, message: Odometry) -> None:
        with self._lock:
            self._truth[message.header.stamp.to_nsec()] = pose_from_message(message.pose.pose)
        self._watch.pose_received()
        self._trail.header = message.header
        self._trail.poses = self._trail.poses[1 - TRAIL :] + [PoseStamped(message.header, message.pose.pose)]
        if len(self._truth) % 6 == 0:
            self._path.publish(self._trail)

    def _on_pose(self, message: PoseWithCovarianceStamped, mode: str) -> None:
        with self._lock:
            self._poses[mode][message.header.stamp.to_nsec()] = pose_from_message(message.pose.pose)
        self._watch.pose_received()

    def _on_map(self, message: MarkerMapEntries) -> None:
        self._markers = [marker_from_entry(entry) for entry in message.markers]

    def record(self) -> None:
        """Starts the drive when all topics are connected, and waits for its end or the node's shutdown.

        :raises RuntimeError: a topic or the service is not available in time, or the drive stops
        """
        self._watch.start(self._missing)
        self._watch.wait()

    def _missing(self) -> List[str]:
        missing = [each.resolved_name for each in self._inputs if not each.get_num_connections()]
        return missing + ([] if self._markers else ["marker_map/entries"])

    def report(self) -> None:
        """Prints the table and writes the plot."""
        with self._lock:
            truth, poses = dict(self._truth), {mode: dict(each) for mode, each in self._poses.items()}
        if not truth:
            print("no pose was received on", rospy.resolve_name("ground_truth"), flush=True)
            return
        last = max(truth)  # an interrupted drive may end between a pose and its ground truth
        poses = {mode: {t: T for t, T in each.items() if t <= last} for mode, each in poses.items()}
        errors = {mode: trajectory_errors(truth, each) for mode, each in poses.items()}
        print("\n" + error_table(errors) + "\n", flush=True)
        if self._params.plot:
            plot_drive(self._params.plot, truth, poses, self._markers)
            print("plot of the drive:", os.path.abspath(self._params.plot), flush=True)


def main() -> None:
    """Runs the node."""
    init_node("drive_recorder")
    recorder = DriveRecorder(read_params(RecorderParams))
    try:
        with fatal(RuntimeError, rospy.ROSException):
            recorder.record()
    finally:
        recorder.report()

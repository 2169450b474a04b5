# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the poses of several locators with the truth of a simulated drive; tells the truth's trail."""

import os
import sys
import threading
import time
from dataclasses import dataclass
from typing import Dict, List

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry, Path
from std_msgs.msg import Bool
from std_srvs.srv import SetBool

from sextant.base.strict_params import not_empty, param, within
from sextant.evaluation.drive_plot import plot_drive
from sextant.evaluation.trajectory import error_table, trajectory_errors
from sextant.msg import MarkerMapEntries
from sextant.nodes.base.conversions import pose_from_message
from sextant.nodes.base.params import read_params
from sextant.nodes.markers.marker_map_messages import marker_from_entry

SETTLE = 1.0  # seconds without another pose after which the last frame is taken as located
TRAIL = 1800  # poses of the truth that are drawn


@dataclass(frozen=True)
class RecorderParams:
    """What is recorded, and where the picture goes."""

    modes: List[str] = param(["nearest", "average", "joint"], not_empty)  # each hears MODE/pose
    start_service: str = param("")  # std_srvs/SetBool, called when all are connected; empty: none
    patience: float = param(
        60.0, within(1.0, 3600.0)
    )  # seconds of waiting for the start, or for another frame
    picture: str = param("")  # file of the picture of the drive; empty: none


class DriveRecorder:
    """Collects truth and poses by stamp."""

    def __init__(self, params: RecorderParams):
        self._params = params
        self._lock = threading.Lock()  # every topic has a thread of its own
        self._truth: Dict[int, np.ndarray] = {}
        self._poses: Dict[str, Dict[int, np.ndarray]] = {mode: {} for mode in params.modes}
        self._markers: list = []
        self._heard = time.monotonic()
        self._trail = Path()
        self._path = rospy.Publisher("ground_truth/path", Path, queue_size=1)
        self._finished = False
        rospy.Subscriber("finished", Bool, self._on_finished)
        rospy.Subscriber("marker_map/entries", MarkerMapEntries, self._on_map)
        self._inputs = [rospy.Subscriber("ground_truth", Odometry, self._on_truth)]
        for mode in params.modes:
            topic = mode + "/pose"
            self._inputs.append(rospy.Subscriber(topic, PoseWithCovarianceStamped, self._on_pose, mode))

    def _on_truth(self, message: Odometry) -> None:
        with self._lock:
            self._truth[message.header.stamp.to_nsec()] = pose_from_message(message.pose.pose)
            self._heard = time.monotonic()
        self._trail.header = message.header
        self._trail.poses = self._trail.poses[-TRAIL:] + [PoseStamped(message.header, message.pose.pose)]
        if len(self._truth) % 6 == 0:
            self._path.publish(self._trail)

    def _on_pose(self, message: PoseWithCovarianceStamped, mode: str) -> None:
        with self._lock:
            self._poses[mode][message.header.stamp.to_nsec()] = pose_from_message(message.pose.pose)
            self._heard = time.monotonic()

    def _on_map(self, message: MarkerMapEntries) -> None:
        self._markers = [marker_from_entry(entry) for entry in message.markers]

    def _on_finished(self, message: Bool) -> None:
        self._finished = message.data

    def start(self) -> None:
        """Lets the drive begin when nothing of it can be missed any more.

        :raises RuntimeError: a topic or the service is not there in time
        """
        end = time.monotonic() + self._params.patience
        while not all(each.get_num_connections() for each in self._inputs) or not self._markers:
            if time.monotonic() > end or rospy.is_shutdown():
                missing = [each.resolved_name for each in self._inputs if not each.get_num_connections()]
                raise RuntimeError("no publisher of " + ", ".join(missing or ["marker_map/entries"]))
            time.sleep(0.1)
        if self._params.start_service:
            time.sleep(SETTLE)  # the locators hear the map from the same publisher
            rospy.wait_for_service(self._params.start_service, self._params.patience)
            rospy.ServiceProxy(self._params.start_service, SetBool)(True)
        self._heard = time.monotonic()

    def wait(self) -> None:
        """Until the drive has ended, or somebody ends it.

        :raises RuntimeError: frames stopped to come before the drive had ended
        """
        while not rospy.is_shutdown():
            silence = time.monotonic() - self._heard
            if self._finished and silence > SETTLE:
                return
            if silence > self._params.patience:
                raise RuntimeError(f"no frame for {silence:.0f} s, and the drive has not ended")
            time.sleep(0.1)

    def report(self) -> None:
        """Prints the table and writes the picture."""
        with self._lock:
            truth, poses = dict(self._truth), {mode: dict(each) for mode, each in self._poses.items()}
        if not truth:
            print("no frame was heard on", rospy.resolve_name("ground_truth"), flush=True)
            return
        last = max(truth)  # a drive that somebody ends may be cut between a pose and its truth
        poses = {mode: {t: T for t, T in each.items() if t <= last} for mode, each in poses.items()}
        errors = {mode: trajectory_errors(truth, each) for mode, each in poses.items()}
        print("\n" + error_table(errors) + "\n", flush=True)
        if self._params.picture:
            plot_drive(self._params.picture, truth, poses, self._markers)
            print("picture of the drive:", os.path.abspath(self._params.picture), flush=True)


def main() -> None:
    rospy.init_node("drive_recorder")
    recorder = DriveRecorder(read_params(RecorderParams))
    try:
        recorder.start()
        recorder.wait()
    except (RuntimeError, rospy.ROSException) as error:
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        sys.exit(1)
    finally:
        recorder.report()

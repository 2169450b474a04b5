# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node accuracy_listener: accuracy of live poses, at measured positions or against ground truth."""

import threading
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Dict, List, Union

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger, TriggerResponse

from sextant.base.strict_params import each, not_empty, one_of, param, within
from sextant.evaluation.accuracy_report import AccuracyFiles, write_accuracy
from sextant.evaluation.drive_accuracy import compare, drive_table
from sextant.evaluation.live_drive import JumpBack, LiveDrive
from sextant.evaluation.pose_series import (
    AXES,
    GroundTruth,
    PoseSeries,
    SeriesStatistics,
    by_distance,
    pose_series,
    series_statistics,
)
from sextant.evaluation.trajectory_metrics import RPE
from sextant.geometry.poses import pose_of_fields
from sextant.messages.pose_messages import pose_from_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.srv import MeasureAccuracy, MeasureAccuracyResponse

TF_TIMEOUT = 5 * 10**9  # nanoseconds after the stamp of a pose until which its true transform may arrive


@dataclass(frozen=True)
class AccuracyListenerParams:
    """What is known of the truth, and where the files go."""

    axis: str = param("z", "measured axis", one_of(*AXES))
    true: Dict[str, float] = param(
        {},
        "true values of axes other than `axis`, metres and radians; axes without a true value have "
        "neither bias nor RMSE",
        each(within(-1000.0, 1000.0)),
    )
    output: str = param("accuracy", "prefix of the files; existing files are overwritten", not_empty)
    truth_frame: str = param("", "tf frame of the base at its true pose; empty: use the topic `ground_truth`")

    def ground_truth(self) -> GroundTruth:
        """Returns the true values of the axes.

        :raises ValueError: `true` contains `axis`, a name that is no axis, or a value that is not finite
        """
        without_truth = dict.fromkeys(axis for axis in AXES if axis != self.axis)
        truth = GroundTruth(self.axis, {**without_truth, **self.true})
        truth.at(0.0)  # raises if an axis or a value is invalid
        return truth


class AccuracyListener:
    """Subscribes to `pose`; provides ~measure, ~write, ~compare and ~reset."""

    def __init__(self, params: AccuracyListenerParams):
        self._params, self._truth = params, params.ground_truth()
        self._truth_frame = params.truth_frame.lstrip("/")
        self._lock, self._measuring = threading.Lock(), threading.Lock()
        self._drive = LiveDrive()
        self._series: List[PoseSeries] = []
        self._tf = tf2_ros.Buffer(cache_time=rospy.Duration(30.0))
        self._inputs: list = [rospy.Subscriber("pose", PoseWithCovarianceStamped, self._on_pose)]
        if self._truth_frame:
            self._inputs.append(tf2_ros.TransformListener(self._tf))
            self._inputs.append(rospy.Timer(rospy.Duration(0.5), self._look_up, reset=True))
        else:
            self._inputs.append(rospy.Subscriber("ground_truth", Odometry, self._on_truth))
        self._services = [
            rospy.Service("~measure", MeasureAccuracy, self._on_measure),
            rospy.Service("~write", Trigger, lambda _: self._answer(self._write)),
            rospy.Service("~compare", Trigger, lambda _: self._answer(self._compare)),
            rospy.Service("~reset", Trigger, self._on_reset),
        ]

    # ---- topics

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        def add(drive: LiveDrive, frame: str, stamp: int, T: np.ndarray) -> None:
            drive.add_pose(frame, stamp, T, np.reshape(message.pose.covariance, (6, 6)))
            if self._truth_frame:
                drive.awaited.append(stamp)

        self._add("pose", message, add)

    def _on_truth(self, message: Odometry) -> None:
        self._add("true pose", message, LiveDrive.add_truth)

    def _add(
        self,
        what: str,
        message: Union[PoseWithCovarianceStamped, Odometry],
        add: Callable[[LiveDrive, str, int, np.ndarray], None],
    ) -> None:
        frame, stamp = message.header.frame_id.lstrip("/"), message.header.stamp.to_nsec()
        try:
            T = pose_from_message(message.pose.pose)
            with self._lock:
                try:
                    add(self._drive, frame, stamp, T)
                except JumpBack:
                    rospy.logwarn("%s: the clock was set back: earlier poses are dropped", rospy.get_name())
                    self._drive = LiveDrive()
                    self._tf.clear()
                    add(self._drive, frame, stamp, T)
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: a %s is ignored: %s", rospy.get_name(), what, error)

    def _look_up(self, _event) -> None:
        """Looks up in tf the true poses that are still missing."""
        with self._lock:
            drive = self._drive
            awaited, drive.awaited = drive.awaited, deque()
        late = [stamp for stamp in awaited if not self._found(drive, stamp)]
        with self._lock:
            drive.awaited.extendleft(reversed(late))

    def _found(self, drive: LiveDrive, stamp: int) -> bool:
        """Adds the true pose of a stamp; returns False if tf may still arrive."""
        at = rospy.Time(*divmod(stamp, 10**9))
        try:
            found = self._tf.lookup_transform(drive.frame, self._truth_frame, at).transform
        except tf2_ros.TransformException as error:
            if rospy.Time.now().to_nsec() - stamp < TF_TIMEOUT:
                return False
            rospy.logwarn_throttle(10.0, "%s: a pose has no ground truth: %s", rospy.get_name(), error)
            return True
        with self._lock:
            drive.add_truth_of_pose(stamp, pose_of_fields(found.translation, found.rotation))
        return True

    # ---- services

    def _on_measure(self, request) -> MeasureAccuracyResponse:
        if not (np.isfinite(request.value) and 0.0 < request.seconds <= 3600.0):
            return _refusal("value must be finite, seconds within (0, 3600]")
        if not self._measuring.acquire(blocking=False):
            return _refusal("a measurement is running: try again when it has finished")
        try:
            series = self._measured(request.value, request.seconds)
        except ValueError as error:
            return _refusal(str(error))
        finally:
            self._measuring.release()
        with self._lock:
            self._series.append(series)
        return _response(series_statistics(series, self._truth))

    def _measured(self, value: float, seconds: float) -> PoseSeries:
        """Returns the poses stamped from now on, after a time in wall clock seconds: a simulation may pause.

        :raises ValueError: no pose was received
        """
        begin = rospy.Time.now().to_nsec()
        time.sleep(seconds)
        with self._lock:
            frame, received = self._drive.frame, self._drive.since(begin)
        if not received:
            raise ValueError(self._describe_missing(begin, seconds))
        stamps, poses, covariances = zip(*received)
        name = f"measured at {begin / 1e9:.1f} s"
        return pose_series(value, name, stamps, np.array(poses), np.array(covariances), frame=frame)

    def _describe_missing(self, begin: int, seconds: float) -> str:
        topic = rospy.resolve_name("pose")
        with self._lock:
            newest = max((stamp for stamp, _, _ in self._drive.poses), default=None)
        if newest is None:
            return f"no pose was received on {topic}"
        age = f"the newest stamp is {(begin - newest) / 1e9:.1f} s before the call"
        return f"no pose received on {topic} in {seconds:g} s has a stamp after the call; {age}"

    def _on_reset(self, _request) -> TriggerResponse:
        if self._measuring.locked():
            return TriggerResponse(False, "a measurement is running: try again when it has finished")
        with self._lock:
            self._drive, self._series = LiveDrive(), []
        return TriggerResponse(True, "all poses and measurements are dropped")

    @staticmethod
    def _answer(work) -> TriggerResponse:
        try:
            return TriggerResponse(True, "\n".join(work()))
        except (OSError, ValueError) as error:
            return TriggerResponse(False, str(error))

    def _write(self) -> List[str]:
        with self._lock:
            series = by_distance(self._series)
        if not series:
            raise ValueError("there is no measurement yet: call ~measure first")
        statistics = [series_statistics(each, self._truth) for each in series]
        files = AccuracyFiles.named(Path(self._params.output).resolve())
        return write_accuracy(files, series, statistics, None)

    def _compare(self) -> List[str]:
        with self._lock:
            poses, truth = list(self._drive.poses), dict(self._drive.truth)
        if not poses or not truth:
            raise ValueError(f"{len(poses)} poses and {len(truth)} true poses were received: both are needed")
        stamps, T, P = zip(*poses)
        return drive_table({"the last hour": compare(truth, stamps, np.array(T), np.array(P), RPE)}, RPE)


def _refusal(message: str) -> MeasureAccuracyResponse:
    none, no_covariance = [np.nan] * 6, [np.nan] * 36
    return MeasureAccuracyResponse(False, message, 0, none, none, none, none, none, no_covariance)


def _response(of: SeriesStatistics) -> MeasureAccuracyResponse:
    position = zip(AXES, 100.0 * of.bias[:3], 100.0 * of.std[:3])
    text = ", ".join(f"{axis} {'?' if np.isnan(b) else f'{b:+.1f}'} +- {s:.1f}" for axis, b, s in position)
    return MeasureAccuracyResponse(
        True, f"{of.count} poses at {of.axis} = {of.label}; bias and deviation, cm: {text}", of.count,
        of.mean, of.std, of.bias, of.rmse, of.published, of.covariance.ravel(),
    )  # fmt: skip


def main() -> None:
    """Runs the node."""
    init_node("accuracy_listener")
    params = read_params(AccuracyListenerParams)
    with fatal(ValueError):
        listener = AccuracyListener(params)
    rospy.spin()
    del listener

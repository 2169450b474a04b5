# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells how exact the poses of a running system are: at measured places, or against a truth that is heard."""

import threading
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Deque, Dict, List, Tuple

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from std_srvs.srv import Trigger, TriggerResponse

from sextant.nodes.conversions import pose_from_message
from sextant.nodes.params import each, not_empty, one_of, param, read_params, within
from sextant.poses import pose_of_fields
from sextant.srv import MeasureAccuracy, MeasureAccuracyResponse
from sextant.statistics.accuracy_report import AccuracyFiles, write_accuracy
from sextant.statistics.drive_accuracy import compare, drive_table
from sextant.statistics.pose_series import (
    AXES,
    PoseSeries,
    SeriesStatistics,
    Truths,
    by_distance,
    pose_series,
    series_statistics,
)

KEPT = 200_000  # poses and truths, of the last two hours at 30 Hz
RPE = (1.0, "metres")
TF_PATIENCE = 5.0  # seconds that tf may come later than the pose


@dataclass(frozen=True)
class AccuracyParams:
    """What is known of the truth, and where the files go."""

    axis: str = param("z", one_of(*AXES))  # which the measured places are values of
    true: Dict[str, float] = param({}, each(within(-1000.0, 1000.0)))  # of other axes, m and rad; else 0
    unknown: List[str] = param([], each(one_of(*AXES)))  # axes whose truth nobody knows
    output: str = param("accuracy", not_empty)  # the files' names begin with it
    truth_frame: str = param("")  # of the robot's true base in tf; empty: the topic ground_truth tells it

    def truths(self) -> Truths:
        """:raises ValueError: an axis that there is not, or the measured one among the others"""
        truths = Truths(self.axis, {**self.true, **dict.fromkeys(self.unknown)})
        truths.at(0.0)
        return truths


class AccuracyListener:
    """Hears `pose`, answers ~measure, ~write, ~compare and ~reset."""

    def __init__(self, params: AccuracyParams):
        self._params, self._truths = params, params.truths()
        self._lock = threading.Lock()
        self._forget()
        self._tf = tf2_ros.Buffer(cache_time=rospy.Duration(30.0))
        self._inputs: list = [rospy.Subscriber("pose", PoseWithCovarianceStamped, self._on_pose)]
        if params.truth_frame:
            self._inputs.append(tf2_ros.TransformListener(self._tf))
            self._inputs.append(rospy.Timer(rospy.Duration(0.5), self._look))
        else:
            self._inputs.append(rospy.Subscriber("ground_truth", Odometry, self._on_truth))
        self._services = [
            rospy.Service("~measure", MeasureAccuracy, self._on_measure),
            rospy.Service("~write", Trigger, lambda _: self._answer(self._write)),
            rospy.Service("~compare", Trigger, lambda _: self._answer(self._compare)),
            rospy.Service("~reset", Trigger, self._on_reset),
        ]

    def _forget(self) -> None:
        self._series: List[PoseSeries] = []
        self._poses: Deque[Tuple[int, np.ndarray, np.ndarray]] = deque(maxlen=KEPT)
        self._truth: Deque[Tuple[int, np.ndarray]] = deque(maxlen=KEPT)
        self._pending: Deque[Tuple[int, str]] = deque(maxlen=KEPT)  # stamps and frames that tf is asked for

    # ---- what is heard

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        try:
            T = pose_from_message(message.pose.pose)
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: a pose is left out: %s", rospy.get_name(), error)
            return
        stamp = message.header.stamp.to_nsec()
        with self._lock:
            self._poses.append((stamp, T, np.reshape(message.pose.covariance, (6, 6))))
            if self._params.truth_frame:
                self._pending.append((stamp, message.header.frame_id))

    def _on_truth(self, message: Odometry) -> None:
        try:
            T = pose_from_message(message.pose.pose)
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: a truth is left out: %s", rospy.get_name(), error)
            return
        with self._lock:
            self._truth.append((message.header.stamp.to_nsec(), T))

    def _look(self, _event) -> None:
        """Asks tf for the truth of the poses that have none yet."""
        with self._lock:
            pending, self._pending = list(self._pending), deque(maxlen=KEPT)
        late: List[Tuple[int, str]] = []
        for stamp, frame in pending:
            time = rospy.Time(*divmod(stamp, 10**9))
            try:
                found = self._tf.lookup_transform(frame, self._params.truth_frame, time).transform
            except tf2_ros.TransformException as error:
                if rospy.Time.now() - time < rospy.Duration(TF_PATIENCE):
                    late.append((stamp, frame))
                else:
                    rospy.logwarn_throttle(10.0, "%s: a pose has no truth: %s", rospy.get_name(), error)
                continue
            with self._lock:
                self._truth.append((stamp, pose_of_fields(found.translation, found.rotation)))
        with self._lock:
            self._pending.extendleft(reversed(late))

    # ---- what is asked

    def _on_measure(self, request) -> MeasureAccuracyResponse:
        if not (np.isfinite(request.value) and 0.0 < request.seconds <= 3600.0):
            return _refusal("value must be finite, seconds within (0, 3600]")
        begin = rospy.Time.now()
        rospy.sleep(request.seconds)
        end = rospy.Time.now()
        with self._lock:
            heard = [pose for pose in self._poses if begin.to_nsec() <= pose[0] <= end.to_nsec()]
        if not heard:
            return _refusal(f"no pose on {rospy.resolve_name('pose')} in {request.seconds:g} s")
        name = f"measured at {begin.to_sec():.1f} s"
        stamps, poses, covariances = zip(*heard)
        series = pose_series(request.value, name, stamps, np.array(poses), np.array(covariances))
        with self._lock:
            self._series.append(series)
        return _response(series_statistics(series, self._truths))

    def _on_reset(self, _request) -> TriggerResponse:
        with self._lock:
            self._forget()
        return TriggerResponse(True, "everything is forgotten")

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
            raise ValueError("nothing was measured yet: ~measure does it")
        statistics = [series_statistics(each, self._truths) for each in series]
        files = AccuracyFiles.named(Path(self._params.output).resolve())
        return write_accuracy(files, series, statistics, None)

    def _compare(self) -> List[str]:
        with self._lock:
            poses, truth = list(self._poses), dict(self._truth)
        if not poses or not truth:
            raise ValueError(f"{len(poses)} poses and {len(truth)} truths were heard: both are needed")
        stamps, T, P = zip(*poses)
        return drive_table({"since the start": compare(truth, stamps, np.array(T), np.array(P), RPE)}, RPE)


def _refusal(message: str) -> MeasureAccuracyResponse:
    return MeasureAccuracyResponse(success=False, message=message)


def _response(of: SeriesStatistics) -> MeasureAccuracyResponse:
    position = zip(AXES, 100.0 * of.bias[:3], 100.0 * of.std[:3])
    told = ", ".join(f"{axis} {bias:+.1f} +- {std:.1f}" for axis, bias, std in position)
    return MeasureAccuracyResponse(
        True, f"{of.count} poses at {of.axis} = {of.label}; bias and deviation, cm: {told}", of.count,
        of.mean, of.std, of.bias, of.rmse, of.published, of.covariance.ravel(),
    )  # fmt: skip


def main() -> None:
    rospy.init_node("accuracy_listener")
    params = read_params(AccuracyParams)
    try:
        listener = AccuracyListener(params)
    except ValueError as error:
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        raise SystemExit(1) from None
    rospy.spin()
    del listener

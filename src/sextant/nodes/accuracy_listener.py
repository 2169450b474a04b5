# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells how exact the poses of a running system are: at measured places, or against a truth that is heard."""

import threading
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Deque, Dict, List, Optional, Tuple

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
    SeriesStatistics,
    Truths,
    by_distance,
    pose_series,
    series_statistics,
)

KEPT = 3600 * 10**9  # nanoseconds of poses and truths that are remembered
JUMP = 10**9  # nanoseconds: stamps that are older than the newest by more come of a clock that was set back
RPE = (1.0, "metres")
TF_PATIENCE = 5 * 10**9  # nanoseconds that tf may come later than the pose

TimedPose = Tuple[int, np.ndarray, np.ndarray]  # stamp, T (4, 4), covariance (6, 6)


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


class Recording:
    """Poses and their truth of the last hour; guarded by its owner."""

    def __init__(self) -> None:
        self.frame = ""  # that all of it is in
        self.poses: Deque[TimedPose] = deque()
        self.truth: Dict[int, np.ndarray] = {}
        self.pending: Deque[int] = deque()  # stamps of poses whose truth tf has not told yet

    def goes_back(self, stamp: int) -> bool:
        """Whether the clock was set back."""
        return bool(self.poses) and stamp < self.poses[-1][0] - JUMP

    def add_pose(self, stamp: int, T: np.ndarray, covariance: np.ndarray) -> None:
        self.poses.append((stamp, T, covariance))
        while self.poses[0][0] < stamp - KEPT:
            self.poses.popleft()

    def add_truth(self, stamp: int, T: np.ndarray) -> None:
        self.truth[stamp] = T
        while next(iter(self.truth)) < stamp - KEPT:
            del self.truth[next(iter(self.truth))]


class AccuracyListener:
    """Hears `pose`, answers ~measure, ~write, ~compare and ~reset."""

    def __init__(self, params: AccuracyParams):
        self._params, self._truths = params, params.truths()
        self._lock, self._measuring = threading.Lock(), threading.Lock()
        self._recording, self._series = Recording(), []
        self._heard: Optional[List[TimedPose]] = None  # while it measures
        self._tf = tf2_ros.Buffer(cache_time=rospy.Duration(30.0))
        self._inputs: list = [rospy.Subscriber("pose", PoseWithCovarianceStamped, self._on_pose)]
        if params.truth_frame:
            self._inputs.append(tf2_ros.TransformListener(self._tf))
            self._inputs.append(rospy.Timer(rospy.Duration(0.5), self._look, reset=True))
        else:
            self._inputs.append(rospy.Subscriber("ground_truth", Odometry, self._on_truth))
        self._services = [
            rospy.Service("~measure", MeasureAccuracy, self._on_measure),
            rospy.Service("~write", Trigger, lambda _: self._answer(self._write)),
            rospy.Service("~compare", Trigger, lambda _: self._answer(self._compare)),
            rospy.Service("~reset", Trigger, self._on_reset),
        ]

    # ---- what is heard

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        try:
            stamp, T = self._checked(message.header, message.pose.pose, first=True)
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: a pose is left out: %s", rospy.get_name(), error)
            return
        timed = stamp, T, np.reshape(message.pose.covariance, (6, 6))
        with self._lock:
            self._recording.add_pose(*timed)
            if self._heard is not None:
                self._heard.append(timed)
            if self._params.truth_frame:
                self._recording.pending.append(stamp)

    def _on_truth(self, message: Odometry) -> None:
        try:
            stamp, T = self._checked(message.header, message.pose.pose, first=False)
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: a truth is left out: %s", rospy.get_name(), error)
            return
        with self._lock:
            self._recording.add_truth(stamp, T)

    def _checked(self, header, pose, first: bool) -> Tuple[int, np.ndarray]:
        """:param first: whether its frame is that of all others, if it is the first
        :raises ValueError: no stamp, no pose, or another frame than that of the others
        """
        stamp, frame = header.stamp.to_nsec(), header.frame_id.lstrip("/")
        if stamp == 0:
            raise ValueError("its stamp is zero")
        T = pose_from_message(pose)
        with self._lock:
            if self._recording.goes_back(stamp):
                rospy.logwarn("%s: the clock was set back: what was heard is forgotten", rospy.get_name())
                self._recording = Recording()
                self._tf.clear()
            if first and not self._recording.poses:
                self._recording.frame = frame
            if frame != self._recording.frame:
                raise ValueError(f"its frame is '{frame}', that of the poses '{self._recording.frame}'")
        return stamp, T

    def _look(self, _event) -> None:
        """Asks tf for the truth of the poses that have none yet."""
        with self._lock:
            recording = self._recording
            pending, recording.pending = recording.pending, deque()
        late = deque(stamp for stamp in pending if not self._found(recording, stamp))
        with self._lock:
            recording.pending.extendleft(reversed(late))

    def _found(self, recording: Recording, stamp: int) -> bool:
        """False: it may still come."""
        at = rospy.Time(*divmod(stamp, 10**9))
        try:
            found = self._tf.lookup_transform(recording.frame, self._params.truth_frame, at).transform
        except tf2_ros.TransformException as error:
            if rospy.Time.now().to_nsec() - stamp < TF_PATIENCE:
                return False
            rospy.logwarn_throttle(10.0, "%s: a pose has no truth: %s", rospy.get_name(), error)
            return True
        with self._lock:
            recording.add_truth(stamp, pose_of_fields(found.translation, found.rotation))
        return True

    # ---- what is asked

    def _on_measure(self, request) -> MeasureAccuracyResponse:
        if not (np.isfinite(request.value) and 0.0 < request.seconds <= 3600.0):
            return _refusal("value must be finite, seconds within (0, 3600]")
        if not self._measuring.acquire(blocking=False):
            return _refusal("it is measuring already: ask again when that is done")
        try:
            begin, heard = self._listen(request.seconds)
        finally:
            self._measuring.release()
        fresh = [pose for pose in heard if pose[0] >= begin]
        if not fresh:
            told = f"{len(heard)} poses on {rospy.resolve_name('pose')} in {request.seconds:g} s"
            reason = ", none stamped after you asked: are the clocks the same?" if heard else ""
            return _refusal(told + reason)
        stamps, poses, covariances = zip(*fresh)
        name = f"measured at {begin / 1e9:.1f} s"
        series = pose_series(request.value, name, stamps, np.array(poses), np.array(covariances))
        with self._lock:
            self._series.append(series)
        return _response(series_statistics(series, self._truths))

    def _listen(self, seconds: float) -> Tuple[int, List[TimedPose]]:
        """When it began (nanoseconds), and what was heard. By the wall's clock: a simulation may pause."""
        heard: List[TimedPose] = []
        begin = rospy.Time.now().to_nsec()
        with self._lock:
            self._heard = heard
        time.sleep(seconds)
        with self._lock:
            self._heard = None
        return begin, heard

    def _on_reset(self, _request) -> TriggerResponse:
        if self._measuring.locked():
            return TriggerResponse(False, "it is measuring: ask again when that is done")
        with self._lock:
            self._recording, self._series = Recording(), []
        return TriggerResponse(True, "everything is forgotten")

    @staticmethod
    def _answer(work) -> TriggerResponse:
        try:
            return TriggerResponse(True, "\n".join(work()))
        except (OSError, ValueError) as error:
            return TriggerResponse(False, str(error))

    def _write(self) -> List[str]:
        with self._lock:
            series, frame = by_distance(self._series), self._recording.frame
        if not series:
            raise ValueError("nothing was measured yet: ~measure does it")
        statistics = [series_statistics(each, self._truths) for each in series]
        files = AccuracyFiles.named(Path(self._params.output).resolve())
        return write_accuracy(files, series, statistics, None, frame)

    def _compare(self) -> List[str]:
        with self._lock:
            poses, truth = list(self._recording.poses), dict(self._recording.truth)
        if not poses or not truth:
            raise ValueError(f"{len(poses)} poses and {len(truth)} truths were heard: both are needed")
        stamps, T, P = zip(*poses)
        return drive_table({"the last hour": compare(truth, stamps, np.array(T), np.array(P), RPE)}, RPE)


def _refusal(message: str) -> MeasureAccuracyResponse:
    none, no_covariance = [np.nan] * 6, [np.nan] * 36
    return MeasureAccuracyResponse(False, message, 0, none, none, none, none, none, no_covariance)


def _response(of: SeriesStatistics) -> MeasureAccuracyResponse:
    position = zip(AXES, 100.0 * of.bias[:3], 100.0 * of.std[:3])
    told = ", ".join(f"{axis} {'?' if np.isnan(b) else f'{b:+.1f}'} +- {s:.1f}" for axis, b, s in position)
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

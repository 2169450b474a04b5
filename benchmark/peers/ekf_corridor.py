# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""robot_localization's EKF and landmark_slam in the corridor of the benchmark of landmark fusion.

Both nodes run with the configuration that Sextant ships, on the same odometry and the same markers; the EKF
gets the pose of marker_locator.
"""

import time
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional

import numpy as np
import rospkg
import rospy
import yaml
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from ros_session import launched, ros_node, wait_for
from rosgraph_msgs.msg import Clock
from simulated_observations import T_BASE_CAMERA, SimulatedCamera
from std_msgs.msg import Header
from tables import Table, Value
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

import sextant
from landmarks.landmark_fusion import CORRIDOR, EVERY, RATE, ROOM, Drive, drive, noise_params
from peers.shown_drive import BASE, CAMERA
from sextant.geometry.plane_poses import planar, relative
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.pose_messages import pose_from_message, pose_to_message, pose_to_transform
from sextant.msg import Marker, MarkerArray
from sextant.simulation.room_markers import default_map

PACKAGE = "robot_localization"
FILTERS = {"robot_localization": "odometry/filtered_map", "landmark_slam": "odometry/filtered"}
NOISE = ["translation_from_translation", "translation_from_rotation", "lateral_from_translation"]
NOISE += [
    "rotation_from_translation",
    "rotation_from_rotation",
]  # of odometry; the EKF gets them as covariances
RUNS, SPEED, START, AFTER = 6, 2.0, 60.0, 1.0  # SPEED: simulated seconds a second
SLIP_TIME = 0.5  # seconds; a jump within one reading of odometry would be no motion of wheels
DISTANCE = 10.0  # metres without markers
SMALL = 1e-6  # m^2, rad^2: variance of what wheels do not measure
COLUMNS = ["error after 10 m, m", "before the first marker, m", "1 s after it, m"]


class Errors(NamedTuple):
    """Position errors of one run, metres."""

    after_distance: float
    before: float
    after: float


def corridor_tables(quick: bool) -> List[Table]:
    """One table, on a master of its own. :raises OSError: not installed, or it could not be started"""
    if PACKAGE not in rospkg.RosPack().list():
        raise OSError(f"rospack does not find {PACKAGE}")
    found: Dict[str, List[Errors]] = {name: [] for name in FILTERS}
    with ros_node(use_sim_time=True) as folder:
        for seed in range(1 if quick else RUNS):
            for name, errors in _run(seed, folder).items():
                found[name].append(errors)
    return [_table(found, quick)]


def _table(found: Dict[str, List[Errors]], quick: bool) -> Table:
    means = {name: np.mean(errors, axis=0) for name, errors in found.items()}
    rows = []
    for name, figures in means.items():
        bars = [None] * 3 if quick or name == PACKAGE else means[PACKAGE]
        rows.append((name, [Value(value, 3, at_most=bar) for value, bar in zip(figures, bars)]))
    title = f"{CORRIDOR:g} s in a corridor without markers, wheel slip, mean of {len(found[PACKAGE])} runs"
    return Table(title, COLUMNS, rows)


def _run(seed: int, folder: Path) -> Dict[str, Errors]:
    robot = CorridorRobot(seed)
    marker_map, params = folder / "map.yaml", folder / "landmark_slam.yaml"
    sextant.write_marker_map(default_map(), str(marker_map))
    noise = noise_params()
    params.write_text(yaml.safe_dump({name: float(getattr(noise, name)) for name in NOISE}))
    poses: Dict[str, Dict[int, np.ndarray]] = {name: {} for name in FILTERS}
    subscribers = [_subscriber(topic, poses[name]) for name, topic in FILTERS.items()]
    try:
        with launched(
            Path(__file__).with_name("corridor.launch"), {"map": str(marker_map), "params": str(params)}
        ):
            robot.wait()
            robot.drive()
    finally:
        for each in subscribers:
            each.unregister()
        robot.close()
    return {name: robot.errors(poses[name]) for name in FILTERS}


def _subscriber(topic: str, poses: Dict[int, np.ndarray]) -> rospy.Subscriber:
    def on_odometry(message: Odometry) -> None:
        poses[message.header.stamp.to_nsec()] = planar(pose_from_message(message.pose.pose))

    return rospy.Subscriber(topic, Odometry, on_odometry, queue_size=1000)


class CorridorRobot:
    """Publishes the clock, odometry with tf, and markers of a drive."""

    def __init__(self, seed: int):
        self._run: Drive = drive(seed, round(SLIP_TIME * RATE))
        self._camera = SimulatedCamera("plumb_bob 0", seed=seed)
        self._map = default_map()
        self._first_marker: Optional[int] = None  # step with the first marker after the corridor
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=100)
        self._markers = rospy.Publisher("markers", MarkerArray, queue_size=100)
        self._tf, self._static = TransformBroadcaster(), StaticTransformBroadcaster()

    def close(self) -> None:
        """Unregister the publishers."""
        for each in (self._clock, self._odometry, self._markers):
            each.unregister()

    def wait(self) -> None:
        """Wait for the nodes. :raises TimeoutError: they do not start"""
        wait_for("the subscribers of odometry", lambda: self._odometry.get_num_connections() >= 2, START)
        wait_for("the subscribers of markers", lambda: self._markers.get_num_connections() >= 2, START)
        mount = pose_to_transform(T_BASE_CAMERA, Header(frame_id=BASE), CAMERA)
        self._static.sendTransform(mount)
        time.sleep(2.0)  # the map arrives

    def drive(self) -> None:
        """Publish the whole drive."""
        began = time.monotonic()
        for step in range(len(self._run.truth)):
            time.sleep(max(0.0, began + step / RATE / SPEED - time.monotonic()))
            stamp = rospy.Time(nsecs=_stamp(step))
            self._clock.publish(Clock(stamp))
            self._publish_odometry(step, stamp)
            if step % EVERY == 0 and not ROOM <= step / RATE < ROOM + CORRIDOR:
                self._publish_markers(step, stamp)
        time.sleep(AFTER)

    def _publish_odometry(self, step: int, stamp: rospy.Time) -> None:
        pose, last = self._run.odometry[step], self._run.odometry[max(0, step - 1)]
        step_made = relative(last, pose)
        x, y, turn = step_made
        message = Odometry(header=Header(stamp=stamp, frame_id="odom"), child_frame_id=BASE)
        T_odom_base = sextant.pose_from_xyz_rpy([*pose[:2], 0.0], [0.0, 0.0, pose[2]])
        message.pose.pose = pose_to_message(T_odom_base)
        message.twist.twist = Twist(Vector3(x * RATE, y * RATE, 0.0), Vector3(0.0, 0.0, turn * RATE))
        message.twist.covariance = _twist_covariance(step_made)
        self._odometry.publish(message)
        self._tf.sendTransform(pose_to_transform(T_odom_base, message.header, BASE))

    def _publish_markers(self, step: int, stamp: rospy.Time) -> None:
        x, y, heading = self._run.truth[step]
        T_map_base = sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, heading])
        visible = self._camera.visible(T_map_base, self._map)
        if visible and self._first_marker is None and step / RATE >= ROOM + CORRIDOR:
            self._first_marker = step
        header, camera = Header(stamp=stamp, frame_id=CAMERA), self._camera
        markers = [
            _marker(each, camera, self._map.markers[0].size)
            for each in camera.view(T_map_base, visible).detections
        ]
        info = calibration_to_message(camera.calibration, header)
        self._markers.publish(MarkerArray(header, info, False, [each for each in markers if each]))

    def errors(self, poses: Dict[int, np.ndarray]) -> Errors:
        """Errors of estimated poses (x, y, heading), by stamp."""
        travelled = np.cumsum(
            np.hypot(*np.diff(self._run.truth[:, :2], axis=0, prepend=self._run.truth[:1, :2]).T)
        )
        enters = round(ROOM * RATE)
        at_distance = int(np.searchsorted(travelled, travelled[enters] + DISTANCE))
        first = self._first_marker
        return Errors(
            *(self._error(poses, step) for step in (at_distance, first - 1, first + round(AFTER * RATE)))
        )

    def _error(self, poses: Dict[int, np.ndarray], step: int) -> float:
        """Of the last pose until a step; the robot stands still between two steps."""
        stamps = [stamp for stamp in poses if stamp <= _stamp(step)]
        if not stamps:
            return np.nan
        stamp = max(stamps)
        truth = self._run.truth[round((stamp - _stamp(0)) * 1e-9 * RATE)]
        return float(np.hypot(*(poses[stamp] - truth)[:2]))


def _stamp(step: int) -> int:
    return 100_000_000_000 + round(1e9 * step / RATE)


def _twist_covariance(step: np.ndarray) -> List[float]:
    """Covariance of the velocities, from the noise of a step (3,) of odometry."""
    along, across, about = np.diag(sextant.odometry_step_noise(step, noise_params()))
    variances = np.array([along, across, 0.0, 0.0, 0.0, about]) * RATE**2 + SMALL
    return list(np.ravel(np.diag(variances)))


def _marker(detection, camera: SimulatedCamera, size: float) -> Optional[Marker]:
    """As marker_detector publishes it; None: no pose."""
    poses = sextant.solve_marker_pose(camera.model, detection.corners, size)
    if poses is None:
        return None
    marker = Marker(family=detection.family, id=detection.id, size=size, corners=np.ravel(detection.corners))
    marker.corner_sigmas, marker.hamming = [camera.sigma] * 4, 0
    covariance = sextant.marker_pose_covariance(camera.model, poses.best.T_camera_marker, size, camera.sigma)
    marker.pose.pose, marker.pose.covariance = (
        pose_to_message(poses.best.T_camera_marker),
        np.ravel(covariance),
    )
    marker.reprojection_error, marker.alternative_reprojection_error = poses.best.reprojection_error, -1.0
    marker.alternative_pose.orientation.w = 1.0
    if poses.alternative is not None:
        marker.alternative_pose = pose_to_message(poses.alternative.T_camera_marker)
        marker.alternative_reprojection_error = poses.alternative.reprojection_error
    return marker

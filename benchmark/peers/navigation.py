# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""move_base drives a simulated robot to goals among pillars, on map -> odom of landmark_slam."""

from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import cv2
import numpy as np
import rospkg
import rospy
import yaml
from geometry_msgs.msg import PoseStamped, Twist, Vector3
from nav_msgs.msg import Odometry
from ros_session import launched, ros_node, wait_for
from roslib.message import get_message_class
from std_srvs.srv import Trigger
from tables import Table, Value

import sextant
from sextant.geometry.plane_poses import in_frame, planar, relative
from sextant.messages.pose_messages import pose_from_message, pose_to_message
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

REQUIRED = {"move_base", "map_server"}
GOALS, QUICK_GOALS, WITHIN = 20, 2, 0.1  # metres from the goal
HALL = {"seed": 5, "landmarks": 24, "half_side": 5.0, "min_separation": 1.6, "max_range": 6.0}
SPEED, START, PATIENCE = 4.0, 60.0, 60.0  # simulated seconds a second; seconds until the start, and to a goal
ATTEMPTS, TURN_RATE = 5, 0.8  # rad/s
SUCCEEDED = 3  # actionlib_msgs/GoalStatus
CELL, MARGIN, PILLAR, STUCK, CLEARANCE = 0.05, 1.5, 0.08, 0.35, 0.6  # metres
EXACT = 1e-6  # m^2: variance of what is known
COLUMNS = ["goals", "reached within 10 cm", "distance from the goal, cm: mean", "worst"]


class Hall(NamedTuple):
    """Pillars in the map frame, whose origin is the robot's start."""

    pillars: np.ndarray  # (n, 2) metres
    classes: List[str]
    corners: np.ndarray  # (4, 2) of the walls, metres

    @property
    def low(self) -> np.ndarray:
        """(2,) smallest coordinates of the floor plan, metres."""
        return self.corners.min(axis=0) - MARGIN

    def distance(self, pose: np.ndarray) -> float:
        """Of a pose (3,) from the next pillar, metres."""
        return float(np.hypot(*(self.pillars - pose[:2]).T).min())


def navigation_tables(quick: bool) -> List[Table]:
    """One table, on a master of its own. :raises OSError: not installed, or it could not be started"""
    lacking = REQUIRED - set(rospkg.RosPack().list())
    if lacking:
        raise OSError(f"rospack does not find {', '.join(sorted(lacking))}")
    world = LandmarkWorld(LandmarkWorldParams(**HALL))
    side = HALL["half_side"]
    walls = np.array([[-side, -side], [side, -side], [side, side], [-side, side]])
    hall = Hall(in_frame(world.start, world.positions), world.classes, in_frame(world.start, walls))
    count = QUICK_GOALS if quick else GOALS
    launch_file = Path(__file__).with_name("navigation.launch")
    with ros_node(use_sim_time=True) as folder, launched(launch_file, _arguments(hall, folder)):
        rows = _drive(hall, world, count)
    return [Table("move_base among pillars, on landmark_slam's map -> odom", COLUMNS, rows)]


def _arguments(hall: Hall, folder: Path) -> Dict[str, str]:
    """Writes the files of navigation.launch."""
    labels = [sextant.LandmarkLabel(name) for name in hall.classes]
    landmarks = [sextant.Landmark2D(position) for position in hall.pillars]
    covariance = EXACT * np.eye(3 + 2 * len(landmarks))
    sextant.write_landmark_map(
        sextant.LandmarkMap("map", np.zeros(3), landmarks, labels, covariance), str(folder / "landmarks.yaml")
    )
    simulator = {**HALL, "real_time_factor": SPEED, "wait_for_subscriber": START}
    (folder / "hall.yaml").write_text(yaml.safe_dump(simulator))
    cv2.imwrite(str(folder / "floor.png"), _floor_plan(hall))
    plan = {"image": "floor.png", "resolution": CELL, "origin": [*map(float, hall.low), 0.0], "negate": 0}
    plan.update(occupied_thresh=0.65, free_thresh=0.2)
    (folder / "floor.yaml").write_text(yaml.safe_dump(plan))
    return {
        "floor": str(folder / "floor.yaml"),
        "map": str(folder / "landmarks.yaml"),
        "hall": str(folder / "hall.yaml"),
        "move_base": str(Path(__file__).with_name("move_base.yaml")),
        "max_range": str(HALL["max_range"]),
        "field_of_view": str(LandmarkWorldParams.field_of_view),
    }


def _floor_plan(hall: Hall) -> np.ndarray:
    """Grey image: walls and pillars are black. The last row has the smallest y."""
    width, height = np.ceil((np.ptp(hall.corners, axis=0) + 2 * MARGIN) / CELL).astype(int)
    image = np.full((height, width), 255, np.uint8)

    def cell(point: np.ndarray) -> Tuple[int, int]:
        column, row = np.round((point - hall.low) / CELL).astype(int)
        return int(column), int(height - 1 - row)

    cv2.polylines(image, [np.array([cell(corner) for corner in _outside(hall)])], True, 0, 2)
    for pillar in hall.pillars:
        cv2.circle(image, cell(pillar), max(1, round(PILLAR / CELL)), 0, -1)
    return image


def _outside(hall: Hall) -> np.ndarray:
    """Corners (4, 2) of walls that are 1 m outside of the pillars."""
    centre = hall.corners.mean(axis=0)
    return centre + (hall.corners - centre) * (1.0 + 1.0 / HALL["half_side"])


def _goals(hall: Hall, world: LandmarkWorld, count: int) -> List[np.ndarray]:
    """Poses (3,) in the map, away from pillars."""
    rng, goals = np.random.default_rng(7), []
    while len(goals) < count:
        pose = relative(world.start, world.random_pose(rng))
        if hall.distance(pose) > CLEARANCE:
            goals.append(pose)
    return goals


class Robot:
    """The robot's true pose, and move_base."""

    def __init__(self) -> None:
        self._truth, self._results = np.zeros(3), []  # type: Tuple[np.ndarray, List[int]]
        self._is_ready = False
        result = get_message_class("move_base_msgs/MoveBaseActionResult")
        rospy.Subscriber("ground_truth", Odometry, self._on_truth, queue_size=10)
        status = get_message_class("actionlib_msgs/GoalStatusArray")
        rospy.Subscriber("move_base/result", result, self._on_result, queue_size=10)
        rospy.Subscriber("move_base/status", status, self._on_status, queue_size=10)
        self._command = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self._goals = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        self._goal_id = get_message_class("actionlib_msgs/GoalID")
        self._cancel = rospy.Publisher("move_base/cancel", self._goal_id, queue_size=1)

    def _on_truth(self, message: Odometry) -> None:
        self._truth = planar(pose_from_message(message.pose.pose))

    def _on_result(self, message) -> None:
        self._results.append(message.status.status)

    def _on_status(self, _message) -> None:
        self._is_ready = True

    def wait(self) -> None:
        """Wait for the nodes, and stop the simulator's random motion."""
        for publisher in (self._command, self._goals, self._cancel):
            wait_for(publisher.name, publisher.get_num_connections, START)
        self._command.publish(Twist())
        wait_for("move_base", lambda: self._is_ready, START)

    def kidnap(self, hall: Hall) -> None:
        """Carries the robot to where it can drive; move_base does not notice."""
        self._carry()
        while hall.distance(self._truth) < CLEARANCE:
            self._carry()

    def _carry(self) -> None:
        before = self._truth
        rospy.ServiceProxy("landmark_simulator/kidnap", Trigger)()
        wait_for("the true pose", lambda: np.hypot(*(self._truth - before)[:2]) > WITHIN, START)

    def is_stuck(self, hall: Hall) -> bool:
        """Whether it stands in a pillar: while it is lost it drives on, and nothing stops it there."""
        return hall.distance(self._truth) < STUCK

    def turn(self) -> None:
        """Turns on the spot once, as a lost robot does to look around."""
        end = rospy.Time.now() + rospy.Duration(2 * np.pi / TURN_RATE)
        while rospy.Time.now() < end:
            self._command.publish(Twist(angular=Vector3(0.0, 0.0, TURN_RATE)))
            rospy.sleep(0.1)

    def distance_after(self, goal: np.ndarray) -> float:
        """Drives to a pose (3,); returns the true distance from it, metres; NaN if move_base gives up."""
        message = PoseStamped()
        message.header.frame_id = "map"
        T = sextant.pose_from_xyz_rpy([*goal[:2], 0.0], [0.0, 0.0, goal[2]])
        message.pose = pose_to_message(T)
        self._results.clear()
        self._goals.publish(message)
        try:
            wait_for("the goal", lambda: self._results, PATIENCE)
        except TimeoutError:
            # Its result must not be taken for that of the next goal.
            self._cancel.publish(self._goal_id())
            wait_for("the end of a goal", lambda: self._results, PATIENCE)
            return np.nan
        return float(np.hypot(*(self._truth - goal)[:2])) if self._results[0] == SUCCEEDED else np.nan


def _drive(hall: Hall, world: LandmarkWorld, count: int) -> List[Tuple[str, list]]:
    robot, goals = Robot(), _goals(hall, world, 2 * count)
    robot.wait()
    rows = [("in a known map", [robot.distance_after(goal) for goal in goals[:count]])]
    distances = []
    for goal in goals[count:]:
        robot.kidnap(hall)
        distances.append(_distance_at_last(robot, hall, goal))
    rows.append(("kidnapped before each goal", distances))
    return [(name, _cells(np.array(distances), count)) for name, distances in rows]


def _distance_at_last(robot: Robot, hall: Hall, goal: np.ndarray) -> float:
    """While the robot is lost, move_base gives up: then the robot looks around, and gets the goal again."""
    for _ in range(ATTEMPTS):
        distance = robot.distance_after(goal)
        if np.isfinite(distance):
            break
        if robot.is_stuck(hall):
            robot.kidnap(hall)
        robot.turn()
    return distance


def _cells(distances: np.ndarray, count: int) -> List[Value]:
    reached = int((distances <= WITHIN).sum())
    worst = np.nanmax(distances) if np.isfinite(distances).any() else np.nan
    figures = Value(100.0 * np.nanmean(distances), 1), Value(100.0 * worst, 1)
    return [Value(count, 0), Value(reached, 0, at_least=count), *figures]

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node street_simulator: a simulated walk along a street: images, odometry, ground truth and a place map."""

import threading
from dataclasses import dataclass
from pathlib import Path
from typing import List

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse

from sextant.base.jobs import JobError
from sextant.base.strict_params import not_empty, param, within
from sextant.messages.image_messages import image_to_message
from sextant.nodes.base.exits import fatal, until_shutdown
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber
from sextant.nodes.simulation.simulator_messages import motion_to_message, reading_to_message
from sextant.streets.street_map import FRAME, StreetMap, has_street_map, write_street_map
from sextant.streets.street_walk import StreetWalk, WalkFrame, WalkParams, known_conditions


@dataclass(frozen=True)
class StreetParams(WalkParams):
    """Private parameters of the node: those of the walk, the map and the frames."""

    map_folder: str = param(
        "",
        "folder of photos, overview, `map.txt` and `clusters.txt`, which are written if there is no "
        "`map.txt`; a map of another `seed`, size, `map_seasons`, `spacing` or `parts` is refused; "
        "empty: no map",
    )
    map_seasons: List[str] = param(
        ["summer"],
        "seasons of the map's photos; one photo of each place per season",
        known_conditions,
    )
    spacing: float = param(3.0, "distance between places", within(0.5, 100.0), "m")
    parts: int = param(12, "number of places in `clusters.txt`", within(1, 100))
    wait_for_subscriber: float = param(
        0.0, "maximum time to wait for a subscriber before the walk starts", within(0.0, 3600.0), "s"
    )
    odom_frame: str = param("odom", "odometry frame", not_empty)
    base_frame: str = param("base_link", "base frame", not_empty)
    camera_frame: str = param("camera_optical_frame", "frame of the images", not_empty)

    def street_map(self) -> StreetMap:
        """Parameters of the map."""
        size = (self.width, self.height)
        return StreetMap(self.seed, self.map_seasons, self.spacing, size, self.parts)


class StreetSimulator:
    """Walks in real time, or slower if rendering takes longer."""

    def __init__(self, params: StreetParams):
        self._params, self._walk = params, StreetWalk(params)
        self._lock, self._stop = threading.Lock(), threading.Event()
        rospy.on_shutdown(self._stop.set)
        self._image = rospy.Publisher("camera/image_raw", Image, queue_size=10)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=10)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=10)
        rospy.Service("~kidnap", Trigger, self._kidnap)

    def run(self) -> None:
        """Publishes frames until the node is shut down."""
        wait_for_subscriber(self._image, self._params.wait_for_subscriber, self._stop)
        pace, conditions = rospy.Rate(self._params.rate, reset=True), ""
        while not self._stop.is_set():
            with self._lock:
                frame = self._walk.frame()
            if frame.conditions != conditions:
                conditions = frame.conditions
                rospy.loginfo("season: %s", conditions)
            self._publish(frame, rospy.Time.now())
            pace.sleep()

    def _publish(self, frame: WalkFrame, stamp: rospy.Time) -> None:
        """Publishes odometry before the image, so that subscribers have it when the image arrives."""
        base = self._params.base_frame
        odom = Header(stamp=stamp, frame_id=self._params.odom_frame)
        self._odometry.publish(reading_to_message(frame.odometry, odom, base))
        self._truth.publish(motion_to_message(frame.truth, Header(stamp=stamp, frame_id=FRAME), base))
        camera = Header(stamp=stamp, frame_id=self._params.camera_frame)
        self._image.publish(image_to_message(frame.image, camera))

    def _kidnap(self, _request) -> TriggerResponse:
        with self._lock:
            distance = self._walk.carry()
        return TriggerResponse(True, f"kidnapped by {distance:.0f} m along the street")


def main() -> None:
    """Runs the node; exits with status 1 and the reason if the map cannot be used or written."""
    init_node("street_simulator")
    params = read_params(StreetParams)
    with fatal(OSError, ValueError, JobError):
        simulator = StreetSimulator(params)
        folder, wanted = Path(params.map_folder), params.street_map()
        if params.map_folder and not has_street_map(folder, wanted):
            rospy.loginfo("%s: rendering the map's photos, at the first start only", folder)
            write_street_map(folder, wanted)
    with until_shutdown():
        simulator.run()

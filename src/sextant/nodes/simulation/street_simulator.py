# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated walk along a street: pictures, odometry, the truth; and a map of the street."""

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
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal, until_shutdown
from sextant.nodes.base.listeners import wait_for_listener
from sextant.nodes.base.params import read_params
from sextant.nodes.simulation.simulator_messages import reading_to_message, truth_to_message
from sextant.simulation.street_map import FRAME, StreetMap, has_street_map, write_street_map
from sextant.simulation.street_walk import StreetWalk, WalkFrame, WalkParams, check_seasons


@dataclass(frozen=True)
class StreetParams(WalkParams):
    """What WalkParams has, the map, and how it is told to ROS."""

    map_folder: str = param("")  # where the map is, or is written; empty: nowhere
    map_seasons: List[str] = param(["summer"])  # a photo of every place in each
    spacing: float = param(3.0, within(0.5, 100.0))  # metres from place to place
    parts: int = param(12, within(1, 100))  # of the walk, in the map of clusters
    wait_for_listener: float = param(0.0, within(0.0, 3600.0))  # seconds that the walk waits for a listener
    odom_frame: str = param("odom", not_empty)
    base_frame: str = param("base_link", not_empty)
    camera_frame: str = param("camera_optical_frame", not_empty)

    def __post_init__(self) -> None:
        super().__post_init__()
        check_seasons("map_seasons", self.map_seasons)

    def street_map(self) -> StreetMap:
        """What is photographed for the map."""
        size = (self.width, self.height)
        return StreetMap(self.seed, self.map_seasons, self.spacing, size, self.parts)


class StreetSimulator:
    """Walks in real time; where the computer is late, so is the walk."""

    def __init__(self, params: StreetParams):
        self._params, self._walk = params, StreetWalk(params)
        self._lock, self._stop = threading.Lock(), threading.Event()
        rospy.on_shutdown(self._stop.set)
        self._image = rospy.Publisher("camera/image_raw", Image, queue_size=10)
        self._odometry = rospy.Publisher("odom", Odometry, queue_size=10)
        self._truth = rospy.Publisher("ground_truth", Odometry, queue_size=10)
        rospy.Service("~kidnap", Trigger, self._kidnap)

    def run(self) -> None:
        """Until the node ends."""
        wait_for_listener(self._image, self._params.wait_for_listener, self._stop)
        pace, season = rospy.Rate(self._params.rate, reset=True), ""
        while not self._stop.is_set():
            with self._lock:
                frame = self._walk.frame()
            if frame.season != season:
                season = frame.season
                rospy.loginfo("the street as it is: %s", season)
            self._tell(frame, rospy.Time.now())
            pace.sleep()

    def _tell(self, frame: WalkFrame, stamp: rospy.Time) -> None:
        """Odometry before the image: whoever hears the image knows how far the walker came."""
        base = self._params.base_frame
        odom = Header(stamp=stamp, frame_id=self._params.odom_frame)
        self._odometry.publish(reading_to_message(frame.odometry, odom, base))
        self._truth.publish(truth_to_message(frame.truth, Header(stamp=stamp, frame_id=FRAME), base))
        camera = Header(stamp=stamp, frame_id=self._params.camera_frame)
        self._image.publish(image_to_message(frame.image, camera))

    def _kidnap(self, _request) -> TriggerResponse:
        with self._lock:
            distance = self._walk.carry()
        return TriggerResponse(True, f"carried {distance:.0f} m on, the wheels do not know")


def main() -> None:
    """Runs the node; what cannot be taken or written ends it with status 1 and the reason."""
    rospy.init_node("street_simulator")
    params = read_params(StreetParams)
    with fatal(OSError, ValueError, JobError):
        simulator = StreetSimulator(params)
        folder, wanted = Path(params.map_folder), params.street_map()
        if params.map_folder and not has_street_map(folder, wanted):
            rospy.loginfo("%s: photographing the street, this is done once", folder)
            write_street_map(folder, wanted)
    with until_shutdown():
        simulator.run()

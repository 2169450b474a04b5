# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node building_simulator: a simulated robot with a camera and a sensor of pillars in a building."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

from sextant.base.strict_params import not_empty, param, within
from sextant.buildings.building_drive import BuildingDrive, BuildingDriveParams, BuildingStep
from sextant.buildings.building_maps import FRAME, has_building_map, write_building_map
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.messages.landmark_messages import observations_to_messages
from sextant.msg import LandmarkObservations
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import ends_on_signal
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber
from sextant.nodes.simulation.landmark_simulator import outlines
from sextant.nodes.simulation.simulated_clock import simulated_time
from sextant.nodes.simulation.simulated_robot import SimulatedRobot, SimulatedRobotParams
from sextant.simulation.building import Building

START = 10_000_000_000  # first stamp, nanoseconds
QUEUE = 30  # messages that a subscriber may be late before it loses one


@dataclass(frozen=True)
class BuildingSimulatorParams(BuildingDriveParams, SimulatedRobotParams):
    """Parameters of the drive, the robot and the maps."""

    map_folder: str = param(
        "",
        "folder of the place map: photos of an earlier day, `map.txt` and a floor plan (`plan.yaml`, for "
        "map_server), which are written if there is no `map.txt`; empty: none",
    )
    spacing: float = param(2.0, "distance between the photos", within(0.5, 20.0), "m")
    camera_frame: str = param("camera_optical_frame", "frame of the images", not_empty)


class BuildingSimulator(SimulatedRobot):
    """Publishes a drive step by step: the clock first, then odometry, then what the sensors observe."""

    def __init__(self, params: BuildingSimulatorParams, building: Building):
        super().__init__(params, START, QUEUE)
        self._camera, self._drive = params.camera(), BuildingDrive(params, building)
        self._calibration = self._camera.calibration()
        self._image = rospy.Publisher("camera/image_raw", Image, queue_size=QUEUE)
        self._camera_info = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=QUEUE)
        self._pillars = rospy.Publisher("landmarks", LandmarkObservations, queue_size=QUEUE)
        self._outlines = rospy.Publisher("ground_truth/landmarks", MarkerArray, queue_size=1, latch=True)
        self._outlines.publish(outlines(building.pillars, FRAME))
        self._publish_mounts({params.camera_frame: self._camera.T_base_camera})
        rospy.Subscriber("cmd_vel", Twist, self._on_command, queue_size=1)
        rospy.Service("~kidnap", Trigger, self._kidnap)

    def run(self) -> None:
        """Drives until the node is shut down."""
        # other nodes may wait for the clock before they subscribe
        wait_for_subscriber(self._image, self._params.wait_for_subscriber, self._stop, self._clock.publish)
        while not self._stop.is_set():
            with self._lock:
                step = self._drive.step(self._commanded() if self._command else None)
                is_seen = step.pillars is not None and self._image.get_num_connections() > 0
                image = self._drive.image() if is_seen else None
            stamp = START + round(1e9 * step.time)
            self._clock.advance(stamp)
            if not self._stop.is_set():
                self._publish(step, image, rospy.Time(nsecs=stamp))

    def _publish(self, step: BuildingStep, image: np.ndarray, stamp: rospy.Time) -> None:
        """Odometry before observations, so that a subscriber knows the pose of the robot at their stamp."""
        self._publish_motion(stamp, step.odometry, step.truth, FRAME)
        if step.pillars is None:
            return
        base = Header(stamp=stamp, frame_id=self._params.base_frame)
        self._pillars.publish(LandmarkObservations(base, observations_to_messages(step.pillars)))
        camera = Header(stamp=stamp, frame_id=self._params.camera_frame)
        self._camera_info.publish(calibration_to_message(self._calibration, camera))
        if image is not None:
            self._image.publish(image_to_message(image, camera))

    def _kidnap(self, _request) -> TriggerResponse:
        with self._lock:
            distance = self._drive.carry()
        return TriggerResponse(True, f"carried {distance:.0f} m away, without odometry")


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter or the map's folder is invalid."""
    with simulated_time("building_simulator"):
        params, building = read_params(BuildingSimulatorParams), Building()
        folder = Path(params.map_folder)
        with fatal(OSError), ends_on_signal():
            if params.map_folder and not has_building_map(folder):
                rospy.loginfo("%s: rendering photos of an earlier day, at the first start only", folder)
                write_building_map(folder, building, params.camera(), params.spacing)
        BuildingSimulator(params, building).run()

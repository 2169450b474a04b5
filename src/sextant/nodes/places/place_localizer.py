# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node place_localizer: localizes a robot in a map of remembered places."""

import threading
import time
from typing import Optional

import rospy
from diagnostic_updater import Updater
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CompressedImage, Image, NavSatFix
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse

from sextant.base.jobs import JobError, SchedulerError
from sextant.base.stamp_jump import jumps_back
from sextant.images.photo_file import read_rgb
from sextant.localization.odometry_track import OdometryTrack
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.image_messages import colour_compressed, colour_image
from sextant.msg import PlaceHypotheses, Places
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.file_wait import wait_for_file
from sextant.nodes.base.init_node import ends_on_signal, init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.images.image_publisher import ImagePublisher
from sextant.nodes.images.latest_image import LatestImage
from sextant.nodes.places.place_localizer_node_params import PlaceLocalizerNodeParams
from sextant.nodes.places.place_messages import fix_message, hypotheses_message, places_message, pose_message
from sextant.nodes.places.place_report import PlaceReport
from sextant.nodes.places.query_camera import QueryCamera
from sextant.nodes.places.rough_pose_input import RoughPoseInput
from sextant.place_maps.place_map import GeoCorners, MetricFrame
from sextant.place_points.place_points_file import points_of_map
from sextant.places.match_image import match_image
from sextant.places.place_localizer import Localization, PlaceLocalizer, Status

WARN_EVERY = 10.0  # seconds
MATCH_SIDE = 640  # of the map's photo in the match image, pixels

_DECODE = {Image: colour_image, CompressedImage: colour_compressed}


class LoadedMap:
    """The map with its index and localizer.

    :raises OSError, ValueError, JobError, SchedulerError: map, photos or parameters cannot be used
    """

    def __init__(self, params: PlaceLocalizerNodeParams):
        begin = time.monotonic()
        indexer = params.place_indexer(rospy.loginfo)
        self.place_map, index = indexer.place_map, indexer.index()
        points = points_of_map(indexer.map_path, self.place_map, params.jobs, rospy.loginfo)
        given = params.method.localization, points, params.same_camera
        self.localizer = PlaceLocalizer(self.place_map, index, *given)
        known = f"{len(points.xyz)} points for metric poses, " if points else ""
        self.text = (
            f"{len(self.place_map.photos)} photos of {len(self.place_map.places())} places, {known}"
            f"{index.bytes / 1e6:.1f} MB, ready after {time.monotonic() - begin:.1f} s"
        )


class PlaceLocalizerNode:
    """Node that processes the newest image in the main thread."""

    def __init__(self, params: PlaceLocalizerNodeParams, loaded: LoadedMap):
        self._params, self._loaded = params, loaded
        self._lock = threading.Lock()
        self._input = ("image/compressed", CompressedImage) if params.compressed else ("image", Image)
        self._last: Optional[rospy.Time] = None  # stamp of the last image
        self._pose: Optional[PoseWithCovarianceStamped] = None  # last published pose
        self._track, self.report = OdometryTrack(), PlaceReport()
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("places", self.report.fill_diagnostics)
        self._advertise()
        self._camera = QueryCamera(self._input[0])
        if params.use_odometry:
            rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=100)
        self._rough = RoughPoseInput() if params.use_rough_pose else None
        rospy.Service("~reload", Trigger, self._reload)
        rospy.Service("~reset", Trigger, self._reset)
        rospy.Service("~publish_initialpose", Trigger, self._on_initialpose)
        rospy.loginfo("%s: %s", params.map_file, loaded.text)

    def _advertise(self) -> None:
        self._places = rospy.Publisher("places", Places, queue_size=10)
        self._hypotheses = rospy.Publisher("hypotheses", PlaceHypotheses, queue_size=10)
        self._matches = ImagePublisher("matches/image")
        self._poses = rospy.Publisher("pose", PoseWithCovarianceStamped, queue_size=10)
        self._fixes = rospy.Publisher("fix", NavSatFix, queue_size=10)
        self._initialpose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)

    # ---- subscribers

    def _is_wanted(self) -> bool:
        outputs = (self._places, self._hypotheses, self._matches, self._poses, self._fixes)
        return self._params.initialpose != "never" or any(each.get_num_connections() for each in outputs)

    def _on_odometry(self, message: Odometry) -> None:
        position = message.pose.pose.position
        with self._lock:
            self._track.add(message.header.stamp.to_nsec(), position.x, position.y)
            self.report.odometry += 1

    # ---- processing

    def run(self) -> None:
        """Processes images until the node is shut down."""
        LatestImage(*self._input, self._is_wanted, self._work, self._params.rate).run(self._updater)

    def _work(self, message) -> None:
        try:
            image = _DECODE[type(message)](message)
            with self._lock:
                if not self._is_late(message.header.stamp):
                    self._localize(image, message.header)
        except (DamagedMessage, ValueError) as error:  # ValueError: a network's output is not finite
            self.report.damaged += 1
            topic = rospy.resolve_name(self._input[0])
            rospy.logwarn_throttle(WARN_EVERY, "image on %s is skipped: %s", topic, error)

    def _is_late(self, stamp: rospy.Time) -> bool:
        """Whether a newer image was processed already; resets the localizer if the clock was set back."""
        if self._last is None or stamp >= self._last:
            return False
        if not jumps_back(stamp.to_nsec(), self._last.to_nsec()):
            self.report.late += 1
            return True
        rospy.logwarn("the images' clock was set back: the belief is reset")
        self._loaded.localizer.reset()
        self._last = None
        return False

    def _localize(self, image, header: Header) -> None:
        begin, stamp, distance = time.perf_counter(), header.stamp, None
        if self._last is not None:
            distance = self._track.distance(self._last.to_nsec(), stamp.to_nsec())
        rough = self._rough.at(self._loaded.place_map, stamp) if self._rough else None
        found = self._loaded.localizer.localize(image, distance, self._camera.of(image), rough)
        self._last = stamp
        self.report.rough += rough is not None
        self.report.add(found, distance, time.perf_counter() - begin)
        self._publish(image, found, header)

    def _publish(self, image, found: Localization, header: Header) -> None:
        place_map = self._loaded.place_map
        self._places.publish(places_message(found, header))
        self._hypotheses.publish(hypotheses_message(place_map, found, header))
        if found.estimate and isinstance(place_map.georeference, MetricFrame):
            self._publish_pose(pose_message(place_map, found, header.stamp), found.relocalized)
        if found.estimate and isinstance(place_map.georeference, GeoCorners):
            self._fixes.publish(fix_message(place_map, found.estimate, header))
        if self._matches.get_num_connections():
            self._publish_matches(image, found, header)

    def _publish_pose(self, pose: PoseWithCovarianceStamped, relocalized: bool) -> None:
        self._pose = pose
        self._poses.publish(pose)
        if relocalized and self._params.initialpose == "relocalized":
            self._initialpose.publish(pose)

    def _publish_matches(self, image, found: Localization, header: Header) -> None:
        photo = found.match.photo
        try:
            map_photo = read_rgb(self._loaded.place_map.path(photo), MATCH_SIDE)
        except (OSError, ValueError) as error:
            rospy.logwarn_throttle(WARN_EVERY, "no match image: %s", error)
            return
        status = found.status.name.lower().replace("_", " ")
        caption = f"{photo.image} ({photo.id}): {len(found.match.weights)} matches, {status}"
        rgb = image if image.ndim == 2 else image[:, :, ::-1]
        self._matches.publish(match_image(rgb, map_photo, found.match, caption), header)

    # ---- services

    def _reload(self, _request) -> TriggerResponse:
        try:
            loaded = LoadedMap(self._params)
        except (OSError, ValueError, JobError, SchedulerError) as error:
            rospy.logerr("the map is not reloaded, the old one is kept: %s", error)
            return TriggerResponse(False, str(error))
        with self._lock:
            self._loaded, self._last, self._pose = loaded, None, None
        rospy.loginfo("%s: %s", self._params.map_file, loaded.text)
        return TriggerResponse(True, loaded.text)

    def _reset(self, _request) -> TriggerResponse:
        with self._lock:
            self._loaded.localizer.reset()
            self._last = self._pose = None
        return TriggerResponse(True, "the belief is reset")

    def _on_initialpose(self, _request) -> TriggerResponse:
        with self._lock:
            if self._pose is None or self.report.status != Status.LOCALIZED:
                return TriggerResponse(
                    False, "there is no pose: the robot is not localized, or the map has no metric frame"
                )
            self._initialpose.publish(self._pose)
        return TriggerResponse(True, f"published on {self._initialpose.resolved_name}")


def main() -> None:
    """Runs the node; exits with status 1 and the reason if the map cannot be used."""
    init_node("place_localizer")
    params = read_params(PlaceLocalizerNodeParams)
    with fatal(OSError, ValueError, JobError, SchedulerError), ends_on_signal():
        wait_for_file(params.map_file, params.wait_for_map)
        loaded = LoadedMap(params)
    PlaceLocalizerNode(params, loaded).run()

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells where in a map of remembered places a robot is."""

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

from sextant.bags.bag_file import DamagedMessage
from sextant.bags.pictures import colour_compressed, colour_image
from sextant.base.jobs import JobError, SchedulerError
from sextant.msg import PlaceHypotheses, Places
from sextant.nodes.base.awaited_file import wait_for_file
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.params import read_params
from sextant.nodes.images.newest_picture import NewestPicture
from sextant.nodes.places.place_localizer_params import PlaceLocalizerParams
from sextant.nodes.places.place_messages import fix_message, hypotheses_message, places_message, pose_message
from sextant.nodes.places.place_report import PlaceReport
from sextant.place_maps.photo_file import read_rgb
from sextant.place_maps.place_map import GeoCorners, MetricFrame
from sextant.places.match_picture import match_picture
from sextant.places.odometry_track import OdometryTrack
from sextant.places.place_localization import Localization, PlaceLocalizer, Status

WARN_EVERY = 10.0  # seconds
LATE = rospy.Duration(1.0)  # that a picture may come late; one from longer ago: its clock was set back
MATCH_SIDE = 640  # pixels of the map's photo, in the picture of matches

_DECODE = {Image: colour_image, CompressedImage: colour_compressed}


class LoadedMap:
    """One reading of the map and its photos.

    :raises OSError, ValueError, JobError, SchedulerError: map, photos or parameters that cannot be used
    """

    def __init__(self, params: PlaceLocalizerParams):
        begin = time.monotonic()
        library = params.photo_library(rospy.loginfo)
        self.place_map, index = library.place_map, library.index()
        self.localizer = PlaceLocalizer(self.place_map, index, params.localization)
        self.text = (
            f"{len(self.place_map.photos)} photos of {len(self.place_map.places())} places, "
            f"{index.bytes / 1e6:.1f} MB, ready after {time.monotonic() - begin:.1f} s"
        )


class PlaceLocalizerNode:
    """Works in the main thread; of pictures that come faster than it works, the newest wins."""

    def __init__(self, params: PlaceLocalizerParams, loaded: LoadedMap):
        self._params, self._loaded = params, loaded
        self._lock = threading.Lock()
        self._input = ("image/compressed", CompressedImage) if params.compressed else ("image", Image)
        self._last: Optional[rospy.Time] = None  # stamp of the last picture
        self._pose: Optional[PoseWithCovarianceStamped] = None  # the last one
        self._track, self.report = OdometryTrack(), PlaceReport()
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("places", self.report.tell)
        self._advertise()
        if params.use_odometry:
            rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=100)
        for name, answer in (("reload", self._reload), ("reset", self._reset)):
            rospy.Service(name, Trigger, answer)
        rospy.Service("~tell_initialpose", Trigger, self._on_initialpose)
        rospy.loginfo("%s: %s", params.map_file, loaded.text)

    def _advertise(self) -> None:
        self._places = rospy.Publisher("places", Places, queue_size=10)
        self._hypotheses = rospy.Publisher("hypotheses", PlaceHypotheses, queue_size=10)
        self._matches = rospy.Publisher("matches/image", Image, queue_size=1)
        self._poses = rospy.Publisher("pose", PoseWithCovarianceStamped, queue_size=10)
        self._fixes = rospy.Publisher("fix", NavSatFix, queue_size=10)
        self._initialpose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)

    # ---- listening

    def _is_wanted(self) -> bool:
        outputs = (self._places, self._hypotheses, self._matches, self._poses, self._fixes)
        return self._params.initialpose != "never" or any(each.get_num_connections() for each in outputs)

    def _on_odometry(self, message: Odometry) -> None:
        position = message.pose.pose.position
        with self._lock:
            self._track.add(message.header.stamp.to_nsec(), position.x, position.y)
            self.report.odometry += 1

    # ---- working

    def run(self) -> None:
        """Until the node ends."""
        NewestPicture(*self._input, self._is_wanted, self._work).run(self._updater)

    def _work(self, message) -> None:
        try:
            image = _DECODE[type(message)](message)
            with self._lock:
                if not self._is_late(message.header.stamp):
                    self._localize(image, message.header)
        except (DamagedMessage, ValueError) as error:  # a network that cannot make anything of it
            self.report.damaged += 1
            topic = rospy.resolve_name(self._input[0])
            rospy.logwarn_throttle(WARN_EVERY, "a picture of %s is left out: %s", topic, error)

    def _is_late(self, stamp: rospy.Time) -> bool:
        """Whether a newer picture was taken already; if one of long after was, forgets what was seen."""
        if self._last is None or stamp >= self._last:
            return False
        if self._last - stamp < LATE:
            self.report.late += 1
            return True
        rospy.logwarn("the pictures' clock was set back: what was seen is forgotten")
        self._loaded.localizer.reset()
        self._last = None
        return False

    def _localize(self, image, header: Header) -> None:
        begin, stamp, gone = time.perf_counter(), header.stamp, None
        if self._last is not None:
            gone = self._track.distance(self._last.to_nsec(), stamp.to_nsec())
        found = self._loaded.localizer.localize(image, gone)
        self._last = stamp
        self.report.add(found, gone, time.perf_counter() - begin)
        self._tell(image, found, header)

    def _tell(self, image, found: Localization, header: Header) -> None:
        place_map = self._loaded.place_map
        self._places.publish(places_message(found, header))
        self._hypotheses.publish(hypotheses_message(place_map, found, header))
        if found.estimate and isinstance(place_map.georeference, MetricFrame):
            self._tell_pose(pose_message(place_map, found.estimate, header.stamp), found.found_again)
        if found.estimate and isinstance(place_map.georeference, GeoCorners):
            self._fixes.publish(fix_message(place_map, found.estimate, header))
        if self._matches.get_num_connections():
            self._tell_matches(image, found, header)

    def _tell_pose(self, pose: PoseWithCovarianceStamped, found_again: bool) -> None:
        self._pose = pose
        self._poses.publish(pose)
        if found_again and self._params.initialpose == "found_again":
            self._initialpose.publish(pose)

    def _tell_matches(self, image, found: Localization, header: Header) -> None:
        photo = found.match.photo
        try:
            of_map = read_rgb(self._loaded.place_map.path(photo), MATCH_SIDE)
        except (OSError, ValueError) as error:
            rospy.logwarn_throttle(WARN_EVERY, "no picture of matches: %s", error)
            return
        words = f"{photo.image} ({photo.id}): {len(found.match.weights)} matches, {found.status.name.lower()}"
        seen = image if image.ndim == 2 else image[:, :, ::-1]
        self._matches.publish(image_to_message(match_picture(seen, of_map, found.match, words), header))

    # ---- services

    def _reload(self, _request) -> TriggerResponse:
        try:
            loaded = LoadedMap(self._params)
        except (OSError, ValueError, JobError, SchedulerError) as error:
            rospy.logerr("map not reloaded, the old one stays: %s", error)
            return TriggerResponse(False, str(error))
        with self._lock:
            self._loaded, self._last, self._pose = loaded, None, None
        rospy.loginfo("%s: %s", self._params.map_file, loaded.text)
        return TriggerResponse(True, loaded.text)

    def _reset(self, _request) -> TriggerResponse:
        with self._lock:
            self._loaded.localizer.reset()
            self._last = self._pose = None
        return TriggerResponse(True, "what was seen is forgotten")

    def _on_initialpose(self, _request) -> TriggerResponse:
        with self._lock:
            if self._pose is None or self.report.status != Status.LOCALIZED:
                return TriggerResponse(False, "there is no pose: the robot is not localized in a metric map")
            self._initialpose.publish(self._pose)
        return TriggerResponse(True, f"told {self._initialpose.resolved_name}")


def main() -> None:
    """Runs the node; a map that cannot be used ends it with status 1 and the reason."""
    rospy.init_node("place_localizer")
    params = read_params(PlaceLocalizerParams)
    wait_for_file(params.map_file, params.wait_for_map)
    with fatal(OSError, ValueError, JobError, SchedulerError):
        node = PlaceLocalizerNode(params, LoadedMap(params))
    node.run()

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows the answers of a place_localizer on the overview of a map: as picture, in a window, and in rviz."""

import tempfile
import threading
from collections import deque
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Deque, List, Optional, Sequence

import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

from sextant.base.strict_params import not_empty, param, required, within
from sextant.msg import Places
from sextant.nodes.base.awaited_file import wait_for_file
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.params import read_params
from sextant.nodes.images.picture_window import PictureWindow
from sextant.nodes.places.place_map_messages import PlaceMarkers, answer_from_message, nothing
from sextant.place_maps.overview_mesh import write_overview_mesh
from sextant.place_maps.place_map import MetricFrame
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.place_picture import Hypothesis, PlacePicture

WARN_EVERY = 60.0  # seconds


@dataclass(frozen=True)
class VisualizerParams:
    """What is shown, and how large."""

    map_file: str = required(not_empty)
    wait_for_map: float = param(0.0, within(0.0, 3600.0))  # seconds that the map may not be there yet
    window: bool = param(False)
    trail: int = param(20, within(1, 1000))  # best places that are shown, the last one's included
    max_side: int = param(1600, within(100, 8192))  # pixels of the overview
    rate: float = param(10.0, within(0.1, 100.0))  # pictures a second at most
    mesh_folder: str = param("")  # for rviz's picture of the overview; empty: a temporary one


class ShownMap:
    """One reading of the map file: its picture and, if it lies in a metric frame, its markers.

    :raises OSError: it, the overview or the mesh cannot be read or written
    :raises ValueError: "file:line: reason"
    """

    def __init__(self, params: VisualizerParams, mesh_folder: Path):
        place_map = read_place_map(params.map_file)
        self.picture = PlacePicture(place_map, params.max_side)
        self.count = len(place_map.photos)
        self.frame, self.markers, self.of_map = "", None, MarkerArray([nothing()])
        frame, overview = place_map.georeference, place_map.overview
        if isinstance(frame, MetricFrame):
            size = (overview.width * frame.resolution, overview.height * frame.resolution)
            mesh = write_overview_mesh(mesh_folder, self.picture.backdrop, *size)
            self.markers = PlaceMarkers(place_map, frame, self.picture.radii)
            self.frame, self.of_map = frame.frame, self.markers.of_map(mesh)

    def of_answer(self, answer: Sequence[Hypothesis], trail: Sequence[int]) -> MarkerArray:
        """Without a metric frame: what was drawn before goes."""
        if self.markers is None:
            return MarkerArray([nothing()])
        known = [number for number in trail if self.picture.has(number)]
        return self.markers.of_answer(self.picture.likely(answer), known)


class PlaceVisualizer(rospy.SubscribeListener):
    """Draws in the main thread; of answers that come faster than it draws, the newest wins.

    :raises OSError, ValueError: as ShownMap; or there is no display for the window
    """

    def __init__(self, params: VisualizerParams):
        self._params = params
        self._temporary = tempfile.TemporaryDirectory(prefix="sextant_places_")
        self._mesh_folder = Path(params.mesh_folder or self._temporary.name).absolute()
        self._window = PictureWindow(rospy.get_name()) if params.window else None
        self._lock, self._news, self._stop = threading.Lock(), threading.Event(), threading.Event()
        self._answer: Optional[List[Hypothesis]] = None
        self._header: Optional[Header] = None
        self._trail: Deque[int] = deque(maxlen=params.trail)
        shown = ShownMap(params, self._mesh_folder)
        self._image = rospy.Publisher(
            "places/image", Image, subscriber_listener=self, queue_size=1, latch=True
        )
        self._map_markers = rospy.Publisher("places/map", MarkerArray, queue_size=1, latch=True)
        self._answer_markers = rospy.Publisher("places/visualization", MarkerArray, queue_size=1, latch=True)
        self._take(shown)
        rospy.on_shutdown(self._stop.set)
        rospy.Service("~reload", Trigger, self._reload)
        rospy.Subscriber("places", Places, self._on_places, queue_size=1)

    def peer_subscribe(self, *_args) -> None:
        """Whoever begins to listen gets a picture at once; without listeners none is drawn."""
        self._news.set()

    def run(self) -> None:
        """Until the node or its window is closed."""
        while self._rest(0.05) and not rospy.is_shutdown():
            if self._news.is_set():
                self._news.clear()
                self._show()
                self._rest(1.0 / self._params.rate)

    def _rest(self, seconds: float) -> bool:
        """Meanwhile the window answers the user. False: it was closed."""
        if self._window is None:
            self._stop.wait(seconds)
            return True
        return all(self._window.live(0.05) for _ in range(ceil(seconds / 0.05)) if not self._stop.is_set())

    def _take(self, shown: ShownMap) -> None:
        self._shown = shown
        self._map_markers.publish(shown.of_map)
        self._news.set()
        rospy.loginfo("%s: %d photos", self._params.map_file, shown.count)
        if shown.markers is None:
            rospy.loginfo(
                "the map has no metric frame: there is places/image, but nothing for rviz's 3-D view"
            )

    def _reload(self, _request) -> TriggerResponse:
        try:
            shown = ShownMap(self._params, self._mesh_folder)
        except (OSError, ValueError) as error:
            rospy.logerr("map not reloaded, the old one stays: %s", error)
            return TriggerResponse(False, str(error))
        with self._lock:
            self._take(shown)
        return TriggerResponse(True, f"{shown.count} photos")

    def _on_places(self, message: Places) -> None:
        try:
            answer = answer_from_message(message)
        except ValueError as error:
            rospy.logwarn_throttle(
                WARN_EVERY, "%s is not understood: %s", rospy.resolve_name("places"), error
            )
            return
        with self._lock:
            self._warn_of_unknown(answer)
            likely = self._shown.picture.likely(answer)
            if self._header and message.header.stamp < self._header.stamp:  # a bag began anew
                self._trail.clear()
            self._trail.extend(each.id for each in likely[:1])
            self._answer, self._header = answer, message.header
        self._news.set()

    def _warn_of_unknown(self, answer: List[Hypothesis]) -> None:
        has = self._shown.picture.has
        unknown = [str(each.id) for each in answer if each.probability > 0 and not has(each.id)]
        if unknown:
            places, path = rospy.resolve_name("places"), self._params.map_file
            text = "%s has places that %s does not have, they are not shown: %s"
            rospy.logwarn_throttle(WARN_EVERY, text, places, path, ", ".join(unknown))

    def _show(self) -> None:
        with self._lock:
            shown, answer, trail = self._shown, self._answer, list(self._trail)
            header = self._header or Header(stamp=rospy.Time.now(), frame_id=shown.frame)
        self._answer_markers.publish(shown.of_answer(answer or (), trail))
        if self._window or self._image.get_num_connections():
            picture = shown.picture.draw(answer, trail)
            self._image.publish(image_to_message(picture, header))
            if self._window:
                self._window.show(picture)


def main() -> None:
    """Runs the node; what cannot be read or shown ends it with status 1 and the reason."""
    rospy.init_node("place_visualizer")
    params = read_params(VisualizerParams)
    wait_for_file(params.map_file, params.wait_for_map)
    with fatal(OSError, ValueError):
        visualizer = PlaceVisualizer(params)
    visualizer.run()

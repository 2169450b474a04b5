# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node place_visualizer: shows place_localizer's hypotheses on the overview, in a window and in rviz."""

import threading
from collections import deque
from dataclasses import dataclass
from math import ceil
from typing import Deque, List, Optional, Sequence

import rospy
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import Header
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

from sextant.base.strict_params import not_empty, param, required, within
from sextant.msg import Places
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.file_wait import wait_for_file
from sextant.nodes.base.init_node import ends_on_signal, init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.images.image_publisher import ImagePublisher
from sextant.nodes.images.image_window import ImageWindow
from sextant.nodes.places.place_messages import hypotheses_from_message
from sextant.nodes.places.place_visualization import PlaceVisualization, delete_all, overview_grid
from sextant.place_maps.overview_renderer import Hypothesis, OverviewRenderer
from sextant.place_maps.place_map import MetricFrame
from sextant.place_maps.place_map_file import read_place_map

WARN_EVERY = 60.0  # seconds


@dataclass(frozen=True)
class VisualizerParams:
    """Private parameters of the node."""

    map_file: str = required("place map", not_empty)
    wait_for_map: float = param(
        0.0, "maximum time to wait for the map file, if another node writes it", within(0.0, 3600.0), "s"
    )
    window: bool = param(False, "also show `places/image` in a window; closing it stops the node")
    trail: int = param(20, "length of the trail of best places, including the last one", within(1, 1000))
    max_side: int = param(1600, "maximum length of the overview's longer side", within(100, 8192), "px")
    rate: float = param(10.0, "maximum rate of the images", within(0.1, 100.0), "Hz")


class ShownMap:
    """A map with its renderer and, if it has a metric frame, what rviz displays.

    :raises OSError: the map or the overview cannot be read
    :raises ValueError: "file:line: reason"
    """

    def __init__(self, params: VisualizerParams):
        place_map = read_place_map(params.map_file)
        self.renderer = OverviewRenderer(place_map, params.max_side)
        self.count = len(place_map.photos)
        self.frame, self.visualization, self.map_markers = "", None, MarkerArray([delete_all()])
        self.overview: Optional[OccupancyGrid] = None
        frame = place_map.georeference
        if isinstance(frame, MetricFrame):
            self.overview = overview_grid(self.renderer.backdrop, place_map.overview, frame)
            self.visualization = PlaceVisualization(place_map, frame, self.renderer.radii)
            self.frame, self.map_markers = frame.frame, self.visualization.map_markers()

    def hypothesis_markers(self, hypotheses: Sequence[Hypothesis], trail: Sequence[int]) -> MarkerArray:
        """Markers of hypotheses; without a metric frame, those that delete all previous ones."""
        if self.visualization is None:
            return MarkerArray([delete_all()])
        known = [number for number in trail if number in self.renderer.at]
        return self.visualization.hypothesis_markers(self.renderer.likely(hypotheses), known)


class PlaceVisualizer:
    """Node that draws the newest hypotheses in the main thread.

    :raises OSError, ValueError: as ShownMap, or there is no display for the window
    """

    def __init__(self, params: VisualizerParams):
        self._params = params
        self._window = ImageWindow(rospy.get_name()) if params.window else None
        self._lock, self._changed, self._stop = threading.Lock(), threading.Event(), threading.Event()
        self._hypotheses: Optional[List[Hypothesis]] = None
        self._header: Optional[Header] = None
        self._trail: Deque[int] = deque(maxlen=params.trail)
        shown = ShownMap(params)
        self._image = ImagePublisher(
            "places/image", True, self._changed.set
        )  # none is drawn without subscribers
        self._overview = rospy.Publisher("places/overview", OccupancyGrid, queue_size=1, latch=True)
        self._map_markers = rospy.Publisher("places/map", MarkerArray, queue_size=1, latch=True)
        self._hypothesis_markers = rospy.Publisher(
            "places/visualization", MarkerArray, queue_size=1, latch=True
        )
        self._set_map(shown)
        rospy.on_shutdown(self._stop.set)
        rospy.Service("~reload", Trigger, self._reload)
        rospy.Subscriber("places", Places, self._on_places, queue_size=1)

    def run(self) -> None:
        """Draws until the node is shut down or its window is closed."""
        while self._wait(0.05) and not rospy.is_shutdown():
            if self._changed.is_set():
                self._changed.clear()
                self._show()
                self._wait(1.0 / self._params.rate)

    def _wait(self, seconds: float) -> bool:
        """Waits while the window handles events. Returns False if it was closed."""
        if self._window is None:
            self._stop.wait(seconds)
            return True
        return all(self._window.live(0.05) for _ in range(ceil(seconds / 0.05)) if not self._stop.is_set())

    def _set_map(self, shown: ShownMap) -> None:
        self._shown = shown
        self._map_markers.publish(shown.map_markers)
        if shown.overview:
            self._overview.publish(shown.overview)
        self._changed.set()
        rospy.loginfo("%s: %d photos", self._params.map_file, shown.count)
        if shown.visualization is None:
            rospy.loginfo(
                "the map has no metric frame: places/image is published, but nothing for rviz's 3-D view"
            )

    def _reload(self, _request) -> TriggerResponse:
        try:
            shown = ShownMap(self._params)
        except (OSError, ValueError) as error:
            rospy.logerr("the map is not reloaded, the old one is kept: %s", error)
            return TriggerResponse(False, str(error))
        with self._lock:
            self._set_map(shown)
        return TriggerResponse(True, f"{shown.count} photos")

    def _on_places(self, message: Places) -> None:
        try:
            hypotheses = hypotheses_from_message(message)
        except ValueError as error:
            topic = rospy.resolve_name("places")
            rospy.logwarn_throttle(WARN_EVERY, "invalid message on %s: %s", topic, error)
            return
        with self._lock:
            self._warn_about_unknown(hypotheses)
            likely = self._shown.renderer.likely(hypotheses)
            if self._header and message.header.stamp < self._header.stamp:  # a bag was restarted
                self._trail.clear()
            self._trail.extend(each.id for each in likely[:1])
            self._hypotheses, self._header = hypotheses, message.header
        self._changed.set()

    def _warn_about_unknown(self, hypotheses: List[Hypothesis]) -> None:
        known = self._shown.renderer.at
        unknown = [str(each.id) for each in hypotheses if each.probability > 0 and each.id not in known]
        if unknown:
            places, path = rospy.resolve_name("places"), self._params.map_file
            text = "places on %s that are not in %s are not shown: %s"
            rospy.logwarn_throttle(WARN_EVERY, text, places, path, ", ".join(unknown))

    def _show(self) -> None:
        with self._lock:
            shown, hypotheses, trail = self._shown, self._hypotheses, list(self._trail)
            header = self._header or Header(stamp=rospy.Time.now(), frame_id=shown.frame)
        self._hypothesis_markers.publish(shown.hypothesis_markers(hypotheses or (), trail))
        if self._window or self._image.get_num_connections():
            image = shown.renderer.draw(hypotheses, trail)
            self._image.publish(image, header)
            if self._window:
                self._window.show(image)


def main() -> None:
    """Runs the node; exits with status 1 and the reason if the map cannot be read or shown."""
    init_node("place_visualizer")
    params = read_params(VisualizerParams)
    with ends_on_signal():
        wait_for_file(params.map_file, params.wait_for_map)
    with fatal(OSError, ValueError):
        visualizer = PlaceVisualizer(params)
    visualizer.run()

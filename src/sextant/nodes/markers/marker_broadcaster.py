# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node marker_broadcaster: publishes a marker map to tf, to the locators and to rviz."""

import threading
from dataclasses import dataclass
from typing import Dict

import rospy
from std_srvs.srv import Trigger, TriggerResponse
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

import sextant
from sextant.base.strict_params import not_empty, required, struct_param
from sextant.msg import MarkerMapEntries
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.markers.marker_map_messages import (
    map_to_message,
    map_to_transforms,
    map_to_visualization,
    marker_from_entry,
)
from sextant.srv import AddMarker, AddMarkerResponse


def _ids(sizes: Dict[str, float]) -> str:
    return "" if all(key.isdecimal() for key in sizes) else "must have marker ids as keys"


_TEXT = sextant.TextMapParams()


@dataclass(frozen=True)
class BroadcasterParams:
    """Parameters of the node. All but map_file apply to the plain text format only."""

    map_file: str = required("path of the [marker map](marker_map.md)", not_empty)
    frame: str = struct_param(sextant.TextMapParams, "frame")
    family: str = struct_param(sextant.TextMapParams, "family")
    size: float = struct_param(sextant.TextMapParams, "size")
    sizes: Dict[str, float] = struct_param(sextant.TextMapParams, "sizes", _ids)
    parents: Dict[str, str] = struct_param(sextant.TextMapParams, "parents")

    def text(self) -> sextant.TextMapParams:
        """Returns the parameters of the plain text format.

        :raises ValueError: a value is out of range
        """
        text = sextant.TextMapParams()
        text.frame, text.family, text.size = self.frame, self.family, self.size
        text.sizes = {int(id): size for id, size in self.sizes.items()}
        text.parents = self.parents
        text.validate()
        return text


class MarkerBroadcaster:
    """Publishes the map on latched topics, and changes it by services."""

    def __init__(self, params: BroadcasterParams):
        """
        :raises ValueError: a parameter is out of range
        :raises RuntimeError: the map file cannot be read: "file:line: reason"
        """
        self._path, self._text = params.map_file, params.text()
        self._lock = threading.Lock()  # rospy handles every service call in its own thread
        marker_map = sextant.read_marker_map(self._path, self._text)
        # not tf2_ros.StaticTransformBroadcaster, which never drops the frames of removed markers
        self._tf = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        self._entries = rospy.Publisher("marker_map/entries", MarkerMapEntries, queue_size=1, latch=True)
        self._boards = rospy.Publisher("marker_map", MarkerArray, queue_size=1, latch=True)
        self._publish(marker_map)
        rospy.Service("~reload", Trigger, self._reload)
        rospy.Service("~add_marker", AddMarker, self._add_marker)

    def _publish(self, marker_map: sextant.MarkerMap) -> None:
        stamp = rospy.Time.now()
        self._map = marker_map
        self._tf.publish(map_to_transforms(marker_map, stamp))
        self._entries.publish(map_to_message(marker_map, stamp))
        self._boards.publish(map_to_visualization(marker_map))
        rospy.loginfo("%s: %d markers in frame '%s'", self._path, len(marker_map.markers), marker_map.frame)

    def _reload(self, _request) -> TriggerResponse:
        with self._lock:
            try:
                self._publish(sextant.read_marker_map(self._path, self._text))
            except RuntimeError as error:
                rospy.logerr("map not reloaded, the old one stays: %s", error)
                return TriggerResponse(False, str(error))
            return TriggerResponse(True, f"{len(self._map.markers)} markers")

    def _add_marker(self, request) -> AddMarkerResponse:
        with self._lock:
            try:
                added = sextant.MarkerMap(self._map)
                added.set(marker_from_entry(request.marker))
                if request.save:
                    sextant.write_marker_map(added, self._path, self._text)
            except (ValueError, RuntimeError) as error:
                return AddMarkerResponse(False, str(error))
            self._publish(added)
            return AddMarkerResponse(True, f"{len(added.markers)} markers" + ", saved" * request.save)


def main() -> None:
    """Runs the node."""
    init_node("marker_broadcaster")
    with fatal(ValueError, RuntimeError):
        broadcaster = MarkerBroadcaster(read_params(BroadcasterParams))
    rospy.spin()
    del broadcaster

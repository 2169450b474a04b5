# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node marker_adapter: converts the detections of apriltag_ros, aruco_ros or fiducials.

The definition of their messages comes with the connection: none of these packages has to be installed.
"""

from dataclasses import dataclass
from typing import Any, Dict, List, Optional

import numpy as np
import rospy
from genpy.dynamic import generate_dynamic
from sensor_msgs.msg import CameraInfo

import sextant
from sextant.base.strict_params import Check, StrictParams, each, one_of, param, within
from sextant.messages.camera_messages import camera_from_info
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.foreign_detections import (
    AXES,
    ForeignMarker,
    Projection,
    convention_of,
    foreign_markers,
)
from sextant.msg import Marker, MarkerArray
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params

_SIZE = within(0.001, 100.0)


def _family_reason(name: str) -> str:
    return (
        "" if name in sextant.marker_families() else "must be a marker family, e.g. tag36h11 or DICT_4X4_50"
    )


@dataclass(frozen=True)
class AdapterParams(StrictParams):
    """Parameters of the node."""

    family: str = param("tag36h11", "family of all markers", Check("a marker family", _family_reason))
    marker_size: float = param(
        0.2,
        "edge length that the other detector is set to; not used for apriltag_ros and for corners",
        _SIZE,
        "m",
    )
    marker_sizes: Dict[str, float] = param(
        {}, "edge lengths of individual markers, by 'ID', e.g. {'7': 0.1}", each(_SIZE), "m"
    )
    searched_image: str = param(
        "auto",
        "the image that is searched: raw, rectified, or auto: rectified for apriltag_ros and aruco_ros, "
        "raw for fiducials",
        one_of("auto", "raw", "rectified"),
    )
    axes: str = param(
        "as_sextant",
        "marker frame of the poses; aruco_library_1 for aruco_ros with library 1 or 2 "
        "([differences](../how_to/migrating.md#converting-poses))",
        one_of(*AXES),
    )
    pose_sigma: float = param(
        1.0,
        "standard deviation of a corner coordinate that is computed from a pose: "
        "nothing is published about it",
        within(0.01, 100.0),
        "px",
    )

    def size_of(self, marker: int) -> float:
        """Edge length of a marker, metres."""
        return self.marker_sizes.get(str(marker), self.marker_size)

    def is_rectified(self, message_type: str) -> bool:
        """Whether the detector searches the rectified image."""
        if self.searched_image == "auto":
            return convention_of(message_type).rectified
        return self.searched_image == "rectified"


class MessageReader:
    """Deserializes messages of a type that is known only at run time."""

    def __init__(self):
        self._classes: Dict[str, type] = {}  # by the checksum of the definition

    def read(self, message: rospy.AnyMsg) -> Any:
        """
        :raises DamagedMessage: the type is not supported, or the data do not fit its definition
        """
        header = message._connection_header
        convention_of(header["type"])
        try:
            if header["md5sum"] not in self._classes:
                classes = generate_dynamic(header["type"], header["message_definition"])
                self._classes[header["md5sum"]] = classes[header["type"]]
            return self._classes[header["md5sum"]]().deserialize(message._buff)
        except Exception as error:  # genpy raises whatever its generated code runs into
            raise DamagedMessage(f"{header['type']}: {error}") from error


class MarkerAdapter:
    """Subscribes to `detections` and `camera_info`, and publishes `markers`."""

    def __init__(self, params: AdapterParams):
        self._params = params
        self._family = sextant.canonical_family(params.family)
        self._reader = MessageReader()
        self._camera_info: Optional[CameraInfo] = None
        self._publisher = rospy.Publisher("markers", MarkerArray, queue_size=1)
        rospy.Subscriber("camera_info", CameraInfo, self._on_camera_info, queue_size=1)
        rospy.Subscriber("detections", rospy.AnyMsg, self._on_detections, queue_size=1, buff_size=2**20)

    def _on_camera_info(self, info: CameraInfo) -> None:
        self._camera_info = info

    def _on_detections(self, raw: rospy.AnyMsg) -> None:
        if self._publisher.get_num_connections() == 0:
            return
        try:
            self._publisher.publish(self._converted(self._reader.read(raw)))
        except ValueError as error:
            rospy.logwarn_throttle(10.0, "%s: %s", rospy.resolve_name("detections"), error)

    def _converted(self, message: Any) -> MarkerArray:
        """
        :raises ValueError: there is no calibration, or the message cannot be used
        """
        info = self._camera_info
        if info is None:
            raise ValueError(f"no calibration yet on {rospy.resolve_name('camera_info')}")
        if message.header.frame_id != info.header.frame_id:
            raise ValueError(
                f"poses in frame '{message.header.frame_id}', but that of the camera is "
                f"'{info.header.frame_id}': set the detector to publish in the frame of the camera"
            )
        rectified = self._params.is_rectified(message._type)
        camera = camera_from_info(info, rectified).model()
        projection = Projection(camera, self._family, self._params.size_of, AXES[self._params.axes])
        markers = [self._marker(each) for each in foreign_markers(message, projection)]
        return MarkerArray(message.header, info, rectified, markers)

    def _marker(self, found: ForeignMarker) -> Marker:
        sigmas: List[float] = [self._params.pose_sigma if found.from_pose else 0.0] * 4
        marker = Marker(
            family=self._family, id=found.id, corners=np.ravel(found.corners), corner_sigmas=sigmas
        )
        marker.hamming, marker.decision_margin = -1, -1.0
        marker.pose.pose.orientation.w = marker.alternative_pose.orientation.w = 1.0
        marker.alternative_reprojection_error = -1.0
        return marker


def main() -> None:
    """Runs the node."""
    init_node("marker_adapter")
    with fatal(ValueError):
        adapter = MarkerAdapter(read_params(AdapterParams))
    rospy.spin()
    del adapter

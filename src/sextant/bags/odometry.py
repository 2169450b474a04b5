# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the odometry of a bag as poses of the base."""

from typing import Any, List, NamedTuple, Optional

import numpy as np

from sextant.bags.bag_file import BagError, BagFile, listed
from sextant.bags.bag_params import NO_ODOMETRY, BagParams
from sextant.bags.stamped_values import stamped_values
from sextant.bags.transforms import TransformTree
from sextant.geometry.poses import pose_of_fields
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name

ODOMETRY = "nav_msgs/Odometry"


class OdometryPoses(NamedTuple):
    """Poses of the base by odometry."""

    stamps: np.ndarray  # (N,) int64 nanoseconds, increasing
    poses: np.ndarray  # (N, 4, 4) T_odom_base, metres
    notes: List[str]  # warnings


def no_odometry(*notes: str) -> OdometryPoses:
    """No poses, with the reason as notes."""
    return OdometryPoses(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 4)), list(notes))


def read_odometry(
    bag: BagFile, params: BagParams, tree: TransformTree, camera_is_base: bool
) -> OdometryPoses:
    """Poses of the base. Odometry of another frame needs a static transform between it and the base: without
    one, the topic is left out with a note, unless it was named.

    :raises BagError: the named topic does not exist or is unusable, or none is named and there are several
    """
    if camera_is_base and not params.odometry:
        return no_odometry()
    topic = odometry_topic(bag, params.odometry)
    if not topic:
        return no_odometry()
    if camera_is_base:
        raise bag.error(
            f"{topic} cannot be used: the pose of the camera on the robot is unknown",
            "set the pose of the camera on the robot by --mounts",
        )
    read = stamped_values(bag, topic, _pose)
    try:
        child = _frames(read.first)[1]
        T_child_base, notes = _T_child_base(bag, topic, child, frame_name(params.base_frame), tree)
    except BagError as error:  # not connected with the base
        if params.odometry:
            raise
        return no_odometry(f"{topic} is not used: {error.what}")
    poses = np.array(list(read.values.values())) @ T_child_base
    return OdometryPoses(np.array(list(read.values), dtype=np.int64), poses, read.notes + notes)


def odometry_topic(bag: BagFile, wanted: str) -> Optional[str]:
    """The wanted topic, by default the only one; None: there is none, or wanted is NO_ODOMETRY.

    :raises BagError: it does not exist, or there are several
    """
    topics = bag.topics(ODOMETRY)
    if wanted == NO_ODOMETRY or (not wanted and not topics):
        return None
    if wanted:
        return bag.named(wanted, ODOMETRY, ODOMETRY)
    if len(topics) > 1:
        raise bag.error(f"there are several topics of {ODOMETRY}: {listed(topics)}", "name one by --odometry")
    return topics[0]


def _frames(message: Any) -> List[str]:
    return [frame_name(message.header.frame_id), frame_name(message.child_frame_id)]


def _pose(message: Any, first: Any) -> np.ndarray:
    if _frames(message) != _frames(first):
        names = " and ".join(f"'{frame}'" for frame in _frames(first))
        raise DamagedMessage(f"its frames are not {names} like those of the first")
    pose = message.pose.pose
    return pose_of_fields(pose.position, pose.orientation)


def _T_child_base(bag: BagFile, topic: str, child: str, base: str, tree: TransformTree):
    if child == base:
        return np.eye(4), []
    if not child:
        return np.eye(4), [f"{topic} does not name its child_frame_id: it is taken as {base}"]
    try:
        chain = tree.chain(child, base)
    except ValueError as error:
        raise bag.error(str(error), "set --base-frame to a frame of tf") from None
    if chain is None or not chain.is_static:
        what = f"its child_frame_id is '{child}', and no static transform connects it with '{base}'"
        raise bag.error(f"{topic}: {what}", f"set --base-frame {child}, or --odometry none")
    return chain.at(0), []

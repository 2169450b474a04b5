# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Odometry of a bag, as the poses of the robot's base."""

from typing import Any, List, NamedTuple, Optional

import numpy as np

from sextant.bags.bag_file import BagError, BagFile, DamagedMessage
from sextant.bags.bag_params import NO_ODOMETRY, BagParams
from sextant.bags.stamped_values import stamped_values
from sextant.bags.transforms import TransformTree, frame_name
from sextant.geometry.poses import pose_of_fields

ODOMETRY = "nav_msgs/Odometry"


class OdometryPoses(NamedTuple):
    """Where the wheels had the base."""

    stamps: np.ndarray  # (N,) int64 nanoseconds, growing
    poses: np.ndarray  # (N, 4, 4) T_odom_base, metres
    notes: List[str]


def no_odometry(*notes: str) -> OdometryPoses:
    """None, and why."""
    return OdometryPoses(np.zeros(0, dtype=np.int64), np.zeros((0, 4, 4)), list(notes))


def read_odometry(
    bag: BagFile, params: BagParams, tree: TransformTree, camera_is_base: bool
) -> OdometryPoses:
    """Poses of the base. Odometry of another frame is moved to the base, if a static transform connects them.

    :raises BagError: the topic that was named is not there or of no use, or there are several
    """
    if camera_is_base and not params.odometry:
        return no_odometry()
    topic = odometry_topic(bag, params.odometry)
    if not topic:
        return no_odometry()
    if camera_is_base:
        raise bag.error(f"{topic} is of no use: nothing tells where the camera sits", "name its mount")
    try:
        return _poses(bag, topic, frame_name(params.base_frame), tree)
    except _Unrelated as error:
        if params.odometry:
            raise
        return no_odometry(f"{topic} is not used: {error.what}")


class _Unrelated(BagError):
    """Odometry of a frame that nothing connects with the base."""


def odometry_topic(bag: BagFile, wanted: str) -> Optional[str]:
    """The topic that is wanted, by default the only one; None: there is none, or none is wanted.

    :raises BagError: it is not there, or there are several
    """
    topics = bag.topics(ODOMETRY)
    there = ", ".join(topics) or "none"
    if wanted == NO_ODOMETRY or (not wanted and not topics):
        return None
    if wanted:
        found = bag.find(wanted)
        if found not in topics:
            raise bag.error(f"there is no odometry on {wanted}", f"topics of {ODOMETRY} in it: {there}")
        return found
    if len(topics) > 1:
        raise bag.error(f"there are several topics of {ODOMETRY}: {there}", "name one by --odometry")
    return topics[0]


def _poses(bag: BagFile, topic: str, base: str, tree: TransformTree) -> OdometryPoses:
    read = stamped_values(bag, topic, _pose)
    T_child_base, notes = _T_child_base(bag, topic, _frames(read.first)[1], base, tree)
    poses = np.array(list(read.values.values())) @ T_child_base
    return OdometryPoses(np.array(list(read.values), dtype=np.int64), poses, read.notes + notes)


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
        raise _Unrelated(bag.path, str(error), "name the base_frame that tf has") from None
    if chain is None or not chain.is_static:
        what = f"its child_frame_id is '{child}', and no static transform connects it with '{base}'"
        raise _Unrelated(bag.path, f"{topic}: {what}", f"name '{child}' as base_frame, or no odometry")
    return chain.at(0), []

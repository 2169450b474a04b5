# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses that a robot published while it was recorded, and where tf had a frame."""

from dataclasses import dataclass
from typing import Any, Dict, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_file import BagFile, DamagedMessage
from sextant.bags.stamps import Losses, StampOrder
from sextant.bags.transforms import frame_name, read_transforms
from sextant.poses import pose_of_fields

WITH_COVARIANCE = ("geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Odometry")
TYPES = (*WITH_COVARIANCE, "geometry_msgs/PoseStamped")


@dataclass(frozen=True)
class RecordedPoses:
    """Poses of one topic of one bag, in order of their stamps."""

    bag: str
    frame: str  # that they are in
    stamps: np.ndarray  # (N,) int64, nanoseconds
    poses: np.ndarray  # (N, 4, 4) metres
    covariances: np.ndarray  # (N, 6, 6) as published, NaN where the message has none
    start: int  # nanoseconds, reception of the bag's first message
    warnings: Tuple[str, ...] = ()


def read_poses(path: str, topic: str) -> RecordedPoses:
    """The poses on a topic of TYPES. Messages that cannot be used are left out, and counted in the warnings.

    :raises BagError: the bag cannot be read, or there is nothing on the topic that can be used
    """
    with BagFile(path) as bag:
        found = _topic(bag, topic)
        order, losses, read = StampOrder(bag), Losses(), {}
        frame: Optional[str] = None
        for recorded in bag.messages([found]):
            try:
                message = recorded.message()
                frame = frame_name(message.header.frame_id) if frame is None else frame
                stamp, pose = _stamped(message, frame)
                order.check(recorded, stamp)
            except ValueError as error:
                losses.lost(found, str(error))
                continue
            losses.used(found)
            read[stamp] = pose
        losses.check(bag, found)
    stamps = sorted(read)
    return RecordedPoses(
        str(path),
        frame or "",
        np.array(stamps, dtype=np.int64),
        np.array([read[stamp][0] for stamp in stamps]),
        np.array([read[stamp][1] for stamp in stamps]),
        bag.first_received,
        tuple(losses.notes()),
    )


def _topic(bag: BagFile, topic: str) -> str:
    found = bag.find(topic)
    if found not in bag.topics(*TYPES):
        there = ", ".join(bag.topics(*TYPES)) or "none"
        raise bag.error(f"there are no poses on {topic}", f"topics of poses in it: {there}")
    return found


def _stamped(message: Any, frame: str) -> Tuple[int, Tuple[np.ndarray, np.ndarray]]:
    """:raises ValueError: it is no pose, or one in another frame."""
    if frame_name(message.header.frame_id) != frame:
        raise DamagedMessage(f"its frame is '{message.header.frame_id}', that of the first '{frame}'")
    pose, covariance = message.pose, np.full((6, 6), np.nan)
    if message._type in WITH_COVARIANCE:
        pose, covariance = message.pose.pose, np.reshape(message.pose.covariance, (6, 6))
    return message.header.stamp.to_nsec(), (pose_of_fields(pose.position, pose.orientation), covariance)


def read_frame(path: str, parent: str, frame: str, stamps: Sequence[int]) -> Dict[int, np.ndarray]:
    """T_parent_frame (4, 4) that tf had at these stamps (nanoseconds); fewer where it was not recorded.

    :raises BagError: the bag cannot be read, or tf does not connect the two
    """
    with BagFile(path) as bag:
        tree = read_transforms(bag)
        try:
            chain = tree.chain(frame_name(parent), frame_name(frame))
        except ValueError as error:
            raise bag.error(str(error), "name another frame") from None
        if chain is None:
            there = ", ".join(tree.frames) or "none"
            what = f"tf does not connect '{parent}' with '{frame}'; its frames are: {there}"
            raise bag.error(what, "name frames that it has")
    found = {int(stamp): chain.at(int(stamp)) for stamp in stamps}
    return {stamp: T for stamp, T in found.items() if T is not None}

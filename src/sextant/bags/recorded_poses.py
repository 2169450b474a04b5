# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses that a robot published while it was recorded, and where tf had a frame."""

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_file import BagFile, DamagedMessage
from sextant.bags.stamped_values import stamped_values
from sextant.bags.transforms import frame_name, read_transforms
from sextant.geometry.poses import LONGEST_GAP, pose_of_fields

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
    start: Optional[int] = None  # nanoseconds, when the bag began; None: located, so of nothing earlier
    warnings: Tuple[str, ...] = ()


def read_poses(path: str, topic: str) -> RecordedPoses:
    """The poses on a topic of TYPES. Messages that cannot be used are left out, and counted in the warnings.

    :raises BagError: the bag cannot be read, or there is nothing on the topic that can be used
    """
    with BagFile(path) as bag:
        read = stamped_values(bag, _topic(bag, topic), _pose)
        start = bag.first_received()
    poses, covariances = zip(*read.values.values())
    return RecordedPoses(
        str(path), frame_name(read.first.header.frame_id), np.array(list(read.values), dtype=np.int64),
        np.array(poses), np.array(covariances), start, tuple(read.notes),
    )  # fmt: skip


def _topic(bag: BagFile, topic: str) -> str:
    found = bag.find(topic)
    if found not in bag.topics(*TYPES):
        there = ", ".join(bag.topics(*TYPES)) or "none"
        raise bag.error(f"there are no poses on {topic}", f"topics of poses in it: {there}")
    return found


def _pose(message: Any, first: Any) -> Tuple[np.ndarray, np.ndarray]:
    """T (4, 4) and covariance. :raises ValueError: it is no pose, or one in another frame than the first."""
    frame, expected = frame_name(message.header.frame_id), frame_name(first.header.frame_id)
    if frame != expected:
        raise DamagedMessage(f"its frame is '{frame}', that of the first '{expected}'")
    pose, covariance = message.pose, np.full((6, 6), np.nan)
    if message._type in WITH_COVARIANCE:
        pose, covariance = message.pose.pose, np.reshape(message.pose.covariance, (6, 6))
    return pose_of_fields(pose.position, pose.orientation), covariance


def read_frame(
    path: str, parent: str, frame: str, stamps: Sequence[int], longest_gap: float = LONGEST_GAP
) -> Tuple[Dict[int, np.ndarray], List[str]]:
    """T_parent_frame (4, 4) that tf had at these stamps (nanoseconds); fewer where it was not recorded.

    :param longest_gap: seconds between two transforms that are interpolated
    :returns: them, and what is odd about the tf
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
    found = {int(stamp): chain.at(int(stamp), longest_gap) for stamp in stamps}
    return {stamp: T for stamp, T in found.items() if T is not None}, tree.notes

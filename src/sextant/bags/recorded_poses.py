# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads recorded poses from topics and from tf."""

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from sextant.bags.bag_file import BagFile, listed
from sextant.bags.stamped_values import stamped_values
from sextant.bags.transforms import read_transforms
from sextant.geometry.poses import MAX_GAP, pose_of_fields
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name

WITH_COVARIANCE = ("geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Odometry")
TYPES = (*WITH_COVARIANCE, "geometry_msgs/PoseStamped")


@dataclass(frozen=True)
class RecordedPoses:
    """Poses of one topic of one bag, in order of their stamps."""

    bag: str  # path
    frame: str  # frame_id of the poses
    stamps: np.ndarray  # (N,) int64, nanoseconds
    poses: np.ndarray  # (N, 4, 4) metres
    covariances: np.ndarray  # (N, 6, 6) as published, NaN where the message has none
    start: Optional[int] = None  # of the bag, nanoseconds; None: the poses are computed from its images
    warnings: Tuple[str, ...] = ()  # notes on the reading
    images: Optional[int] = None  # number of images, with and without a pose; None: unknown


def read_poses(path: str, topic: str) -> RecordedPoses:
    """Reads the poses on a topic of TYPES. Unusable messages are skipped and counted in the warnings.

    :raises BagError: the bag cannot be read, or no message of the topic is usable
    """
    with BagFile(path) as bag:
        read = stamped_values(bag, bag.named(topic, "pose", *TYPES), _pose)
        start = bag.first_received()
    poses, covariances = zip(*read.values.values())
    return RecordedPoses(
        str(path), frame_name(read.first.header.frame_id), np.array(list(read.values), dtype=np.int64),
        np.array(poses), np.array(covariances), start, tuple(read.notes),
    )  # fmt: skip


def _pose(message: Any, first: Any) -> Tuple[np.ndarray, np.ndarray]:
    """T (4, 4) and covariance. :raises ValueError: it is not valid, or not in the frame of the first."""
    frame, expected = frame_name(message.header.frame_id), frame_name(first.header.frame_id)
    if frame != expected:
        raise DamagedMessage(f"its frame is '{frame}', that of the first '{expected}'")
    pose, covariance = message.pose, np.full((6, 6), np.nan)
    if message._type in WITH_COVARIANCE:
        pose, covariance = message.pose.pose, np.reshape(message.pose.covariance, (6, 6))
    return pose_of_fields(pose.position, pose.orientation), covariance


def read_frame(
    path: str, parent: str, frame: str, stamps: Sequence[int], max_gap: float = MAX_GAP
) -> Tuple[Dict[int, np.ndarray], List[str]]:
    """T_parent_frame (4, 4) of tf by stamp (nanoseconds), without stamps at which tf was not recorded.

    :param max_gap: maximum time between two interpolated transforms, seconds
    :returns: the transforms, and warnings on the tf
    :raises BagError: the bag cannot be read, or tf does not connect the two
    """
    with BagFile(path) as bag:
        tree = read_transforms(bag)
        try:
            chain = tree.chain(frame_name(parent), frame_name(frame))
        except ValueError as error:
            raise bag.error(str(error), "name another frame") from None
        if chain is None:
            what = f"tf does not connect '{parent}' with '{frame}'; its frames are: {listed(tree.frames)}"
            raise bag.error(what, "name frames that it has")
    found = {int(stamp): chain.at(int(stamp), max_gap) for stamp in stamps}
    return {stamp: T for stamp, T in found.items() if T is not None}, tree.notes

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distance in the middle of depth images."""

from typing import List

import numpy as np

from sextant.bags.bag_file import BagFile, listed
from sextant.bags.camera_topics import IMAGE
from sextant.bags.stamps import Losses
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.image_messages import DEPTH_ENCODINGS, depth_image

MIN_PIXELS = 20  # with depth in the middle of an image


def middle_depth(path: str, topic: str = "", share: float = 0.1) -> float:
    """Median distance over a recording, metres.

    :param topic: depth images; empty: the only one
    :param share: (0, 1] of the image's width and height, about its middle
    :raises BagError: the bag is unusable, lacks the topic or has several, or no image is usable
    :raises ValueError: the share is out of range
    """
    if not 0.0 < share <= 1.0:
        raise ValueError(f"the share of the image is {share}, allowed is (0, 1]")
    with BagFile(path) as bag:
        topic, losses = _topic(bag, topic), Losses()
        medians: List[float] = []
        for recorded in bag.messages([topic]):
            try:
                medians.append(_middle(depth_image(recorded.message()), share))
                losses.used(topic)
            except DamagedMessage as error:
                losses.lost(topic, str(error))
        losses.check(bag, topic)
    return float(np.median(medians))


def _middle(depth: np.ndarray, share: float) -> float:
    height, width = depth.shape
    aside, above = (int(0.5 * (1.0 - share) * side) for side in (width, height))
    inside = depth[above : height - above, aside : width - aside]
    found = inside[inside > 0]
    if len(found) < MIN_PIXELS:
        raise DamagedMessage(f"only {len(found)} of {inside.size} pixels in its middle have a depth")
    return float(np.median(found))


def _topic(bag: BagFile, wanted: str) -> str:
    if wanted:
        return bag.named(wanted, "image", IMAGE)
    firsts = {topic: bag.first(topic) for topic in bag.topics(IMAGE)}
    depths = [
        topic for topic, first in firsts.items() if first is not None and first.encoding in DEPTH_ENCODINGS
    ]
    if len(depths) != 1:
        what = f"there must be one topic of depth images, there are: {listed(depths)}"
        raise bag.error(what, "name the topic")
    return depths[0]

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far away a depth camera has what is in the middle of its image."""

from typing import List

import numpy as np

from sextant.bags.bag_file import BagFile, DamagedMessage
from sextant.bags.pictures import DEPTHS, depth_image
from sextant.bags.stamps import Losses

FEWEST = 20  # depths, in the middle of an image


def middle_depth(path: str, topic: str = "", share: float = 0.1) -> float:
    """Median over a recording, metres.

    :param topic: of depth images; empty: the only one
    :param share: (0, 1] of the image's width and height, about its middle
    :raises BagError: the bag cannot be used, has not that topic or several, or none of its images can be used
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
    if len(found) < FEWEST:
        raise DamagedMessage(f"only {len(found)} of {inside.size} pixels in its middle have a depth")
    return float(np.median(found))


def _topic(bag: BagFile, wanted: str) -> str:
    images = bag.topics("sensor_msgs/Image")
    if wanted:
        found = bag.find(wanted)
        if found not in images:
            raise bag.error(
                f"there are no images on {wanted}", f"there are on {', '.join(images) or 'no topic'}"
            )
        return found
    firsts = {topic: bag.first(topic) for topic in images}
    depths = [topic for topic, first in firsts.items() if first is not None and first.encoding in DEPTHS]
    if len(depths) != 1:
        told = ", ".join(depths) or "none"
        raise bag.error(f"there must be one topic of depth images, there are: {told}", "name the topic")
    return depths[0]

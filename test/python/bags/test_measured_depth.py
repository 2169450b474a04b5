# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from written_bags import WrittenBag

from sextant.bags.bag_file import BagError
from sextant.bags.measured_depth import middle_depth

TOPIC = "/camera/depth/image_rect_raw"


def written(path, images, encoding="32FC1", topics=(TOPIC,)):
    with WrittenBag(path) as bag:
        for topic in topics:
            for i, image in enumerate(images):
                bag.encoded(topic, image, encoding, 0.1 * i)
    return str(path)


def wall(middle, around=5.0):
    """A nearer board in the middle tenth of the image, with holes in it."""
    image = np.full((60, 80), around, np.float32)
    image[27:33, 36:44] = middle
    image[27, 36:44:2] = 0.0
    return image


def test_the_median_of_the_middle_is_returned(tmp_path):
    path = written(tmp_path / "wall.bag", [wall(1.48), wall(1.5), wall(1.51)])
    assert middle_depth(path, TOPIC) == pytest.approx(1.5)
    assert middle_depth(path) == pytest.approx(1.5)
    assert middle_depth(path, TOPIC, 1.0) == pytest.approx(5.0)


def test_millimetres_are_metres(tmp_path):
    path = written(tmp_path / "wall.bag", [(1000 * wall(1.5)).astype(np.uint16)], "16UC1")
    assert middle_depth(path, TOPIC) == pytest.approx(1.5)


def test_images_that_are_of_no_use_are_passed_over(tmp_path):
    images = [wall(1.5), np.zeros((60, 80), np.float32), np.full((60, 80), np.nan, np.float32)]
    assert middle_depth(written(tmp_path / "wall.bag", images), TOPIC) == pytest.approx(1.5)
    with pytest.raises(BagError, match="only 0 of 48 pixels in its middle have a depth"):
        middle_depth(written(tmp_path / "none.bag", images[1:]), TOPIC)


def test_a_topic_that_cannot_be_is_named(tmp_path):
    path = written(tmp_path / "two.bag", [wall(1.5)], topics=(TOPIC, "/other"))
    with pytest.raises(
        BagError, match="one topic of depth images, there are: /camera/.*, /other; name the topic"
    ):
        middle_depth(path)
    with pytest.raises(BagError, match="there is no image on /nothing; topics with this type: /camera"):
        middle_depth(path, "/nothing")
    grey = written(tmp_path / "grey.bag", [np.zeros((60, 80), np.uint8)], "mono8")
    with pytest.raises(BagError, match="the encoding 'mono8' is not depth"):
        middle_depth(grey, TOPIC)
    with pytest.raises(ValueError, match="the share of the image is 0"):
        middle_depth(path, TOPIC, 0.0)

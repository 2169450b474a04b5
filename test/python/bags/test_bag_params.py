# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.bags.bag_params import BagParams


@pytest.mark.parametrize(
    "options, reason",
    [
        ({"images": "/cam/image_raw"}, "images is '/cam/image_raw', allowed is a list of names"),
        ({"images": ["/a", "/a"]}, "images contains /a more than once"),
        ({"families": []}, "families is empty"),
        ({"families": ["tag99"]}, "tag99"),
        ({"every": 0}, "every is 0"),
        ({"start": 3.0, "end": 2.0}, "start is 3.0 and end 2.0"),
        ({"start": float("nan")}, "start is nan"),
        ({"base_frame": ""}, "base_frame is empty"),
        ({"mounts": {"camera": np.zeros((4, 4))}}, "mounts[camera] is not a pose"),
        ({"mounts": {"camera": np.eye(3)}}, "mounts[camera] is not a pose"),
    ],
)
def test_options_that_cannot_be(options, reason):
    with pytest.raises(ValueError) as caught:
        BagParams(**options)
    assert reason in str(caught.value)


def test_defaults_are_valid():
    BagParams()

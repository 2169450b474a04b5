# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""World files beside pictures."""

import numpy as np
import pytest
from PIL import Image

from sextant.place_maps.world_file import corners_beside

# 200 x 100 pixels of 1e-5 x 2e-5 degrees whose upper left corner is 13.0 east, 55.6 north
LINES = ["1e-5", "0", "0", "-2e-5", "13.000005", "55.59999"]


@pytest.fixture
def park(tmp_path):
    Image.fromarray(np.zeros((100, 200), np.uint8)).save(tmp_path / "park.png")
    return tmp_path / "park.png"


@pytest.mark.parametrize("name", ["park.pgw", "park.pngw", "park.wld"])
def test_corners_are_those_of_the_outer_pixels(park, name):
    park.with_name(name).write_text("\n".join(LINES))
    corners = corners_beside(park)
    assert corners.north_west == pytest.approx((55.6, 13.0), abs=1e-9)
    assert corners.south_east == pytest.approx((55.598, 13.002), abs=1e-9)


def test_no_world_file_no_corners(park):
    assert corners_beside(park) is None


@pytest.mark.parametrize(
    "lines, reason",
    [
        (LINES[:5], "not a world file of six numbers"),
        ([*LINES, "1"], "not a world file of six numbers"),
        (["a", *LINES[1:]], "not a world file of six numbers"),
        (["1e-5", "1e-6", *LINES[2:]], "is rotated"),
        (["0.5", "0", "0", "-0.5", "386123", "6171234"], "must be in degrees of WGS 84"),
        (["1e-5", "0", "0", "2e-5", *LINES[4:]], "north_west must be north"),
        (["nan", *LINES[1:]], "not a latitude and longitude"),
    ],
)
def test_what_cannot_be_is_refused(park, lines, reason):
    path = park.with_suffix(".pgw")
    path.write_text("\n".join(lines))
    with pytest.raises(ValueError, match=reason) as refused:
        corners_beside(park)
    assert str(path) in str(refused.value)

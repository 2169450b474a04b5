# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, RegionOfInterest

from sextant.messages.camera_messages import camera_from_info

FX, CX, CY = 500.0, 320.0, 240.0


def camera_info(**fields):
    K = [FX, 0.0, CX, 0.0, FX, CY, 0.0, 0.0, 1.0]
    P = [FX, 0.0, CX, 0.0, 0.0, FX, CY, 0.0, 0.0, 0.0, 1.0, 0.0]
    usual = dict(
        width=640, height=480, distortion_model="plumb_bob", D=[0.0] * 5, K=K, R=np.eye(3).ravel(), P=P
    )
    return CameraInfo(**{**usual, **fields})


def test_binning_and_region_are_applied():
    region = RegionOfInterest(x_offset=100, y_offset=40, width=400, height=300)
    calibration = camera_from_info(
        camera_info(binning_x=2, binning_y=2, roi=region), rectified=False
    ).calibration
    assert (calibration.width, calibration.height) == (200, 150)
    # The centre of pixel 320 is 320.5 pixels from the border of the image, 220.5 from that of the region.
    expected = [[FX / 2, 0, 220.5 / 2 - 0.5], [0, FX / 2, 200.5 / 2 - 0.5], [0, 0, 1]]
    np.testing.assert_allclose(calibration.K, expected)


@pytest.mark.parametrize("field", ["width", "height"])
def test_a_size_that_no_image_has_is_refused(field):
    with pytest.raises(ValueError, match="image size is .*4294967295"):
        camera_from_info(camera_info(**{field: 2**32 - 1}), rectified=False)
    region = RegionOfInterest(**{"width": 10, "height": 10, field: 2**32 - 1})
    with pytest.raises(ValueError, match="image size is .*4294967295"):
        camera_from_info(camera_info(roi=region), rectified=False)

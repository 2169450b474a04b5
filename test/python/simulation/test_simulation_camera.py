# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.simulation.camera import camera_calibration, camera_mount, resized_calibration


@pytest.mark.parametrize("size", [(640, 480), (1280, 720), (1920, 1080)])
@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "equidistant"])
def test_half_the_field_of_view_lies_on_either_side(size, model):
    camera = sextant.CameraModel(camera_calibration(*size, np.deg2rad(62.0), model))
    for side, border in ((-1.0, -0.5), (1.0, size[0] - 0.5)):  # outer edges of the first and the last pixel
        ray = [side * np.sin(np.deg2rad(31.0)), 0.0, np.cos(np.deg2rad(31.0))]
        assert camera.project(ray) == pytest.approx([border, 0.5 * (size[1] - 1)])


def test_fisheye_sees_more_than_half_of_the_world():
    camera = sextant.CameraModel(camera_calibration(640, 480, np.deg2rad(200.0), "equidistant"))
    assert camera.unproject([0.0, 239.5])[2] < 0.0


@pytest.mark.parametrize(
    "arguments",
    [
        (640, 480, 0.0),
        (640, 480, np.pi),
        (640, 480, 7.0, "equidistant"),
        (640, 480, 1.0, "no_such_model"),
        (640, 480, 1.0, "plumb_bob", [0.1, 0.2]),
        (640, 480, 1.0, "plumb_bob", [np.nan] * 5),
    ],
)
def test_what_no_camera_has_is_refused(arguments):
    with pytest.raises(ValueError):
        camera_calibration(*arguments)


@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "equidistant"])
def test_resized_images_show_a_point_at_the_same_fraction_of_the_image(model):
    count = {"plumb_bob": 5, "rational_polynomial": 8, "equidistant": 4}[model]
    whole = camera_calibration(
        640, 480, 1.1, model, [0.02, -0.01, 0.001, 0.002, 0.003, 0.0, 0.0, 0.0][:count]
    )
    whole.R = np.eye(3)
    large = resized_calibration(whole, 1600, 1200)
    for point in ([0.0, 0.0, 1.0], [0.3, -0.2, 1.0], [-1.0, 0.7, 2.0]):
        small_pixel = sextant.CameraModel(whole).project(point)
        large_pixel = sextant.CameraModel(large).project(point)
        np.testing.assert_allclose((large_pixel + 0.5) / 2.5, small_pixel + 0.5)
        u, v, w = large.P @ [*point, 1.0]
        x, y, z = whole.P @ [*point, 1.0]
        np.testing.assert_allclose([(u / w + 0.5) / 2.5, (v / w + 0.5) / 2.5], [x / z + 0.5, y / z + 0.5])
    np.testing.assert_array_equal(large.R, whole.R)


def test_an_image_of_another_shape_is_of_another_camera():
    with pytest.raises(ValueError, match="1280 x 720 is not the aspect ratio of the calibration, 640 x 480"):
        resized_calibration(camera_calibration(640, 480), 1280, 720)
    assert resized_calibration(camera_calibration(1366, 768), 683, 384).width == 683


def test_mounted_camera_looks_ahead_or_where_it_is_turned():
    T = camera_mount([0.1, 0.0, 1.0], [0.0, 0.0, 0.0])
    ahead_and_right = np.transpose([[0.0, 0.0, 2.0, 1.0], [1.0, 0.0, 0.0, 1.0]])  # as the image has them
    np.testing.assert_allclose(
        T @ ahead_and_right, np.transpose([[2.1, 0.0, 1.0, 1.0], [0.1, -1.0, 1.0, 1.0]])
    )
    T = camera_mount([0.0, 0.0, 0.0], [0.0, 0.0, 0.5 * np.pi])
    np.testing.assert_allclose(T @ [0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0], atol=1e-12)  # to the left

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""File of the poses of a map's photos."""

from pathlib import Path

import numpy as np
import pytest
import yaml

import sextant
from sextant.place_maps.photo_poses import (
    PhotoCamera,
    PhotoPoses,
    PosedPhoto,
    poses_path,
    read_photo_poses,
    write_photo_poses,
)


def camera(width=640, rectified=False):
    lens = sextant.CameraCalibration()
    lens.width, lens.height, lens.distortion_model = width, 480, "plumb_bob"
    K = np.array([[500.0, 0.0, 319.5], [0.0, 510.0, 239.5], [0.0, 0.0, 1.0]])
    lens.D, lens.K, lens.R, lens.P = [-0.2, 0.1, 1e-3, -1e-3, 0.0], K, np.eye(3), np.c_[K, np.zeros(3)]
    return PhotoCamera(lens, rectified)


def poses():
    T = [sextant.pose_from_xyz_rpy([i, -2.0, 1e-5], [-1.6, 0.1, i]) for i in range(3)]
    cameras = [camera(), camera(), camera(800, True)]
    return PhotoPoses("map", {f"fußweg {i}.jpg": PosedPhoto(*each) for i, each in enumerate(zip(cameras, T))})


def written(tmp_path):
    path = poses_path(tmp_path / "map.txt")
    write_photo_poses(path, poses())
    return path


def test_what_is_written_is_read(tmp_path):
    path, expected = written(tmp_path), poses()
    read = read_photo_poses(path)
    assert path.name == "map.txt.poses" and read.frame == "map" and list(read.photos) == list(expected.photos)
    for image, photo in read.photos.items():
        np.testing.assert_allclose(photo.T_map_camera, expected.photos[image].T_map_camera, atol=1e-12)
        lens, other = photo.camera.calibration, expected.photos[image].camera.calibration
        assert photo.camera.rectified == expected.photos[image].camera.rectified
        for name in ("width", "height", "distortion_model", "D", "K", "R", "P"):
            np.testing.assert_array_equal(getattr(lens, name), getattr(other, name))


def test_equal_cameras_are_written_once(tmp_path):
    assert len(yaml.safe_load(written(tmp_path).read_text())["cameras"]) == 2


def spoilt(tmp_path, where, value):
    """The file with another value; None: without it."""
    path = written(tmp_path)
    table = yaml.safe_load(path.read_text())
    *folders, name = where
    part = table
    for folder in folders:
        part = part[folder]
    if value is None:
        del part[name]
    else:
        part[name] = value
    path.write_text(yaml.safe_dump(table, allow_unicode=True), encoding="utf-8")
    return path


PHOTO = ("photos", "fußweg 0.jpg")


@pytest.mark.parametrize(
    ("where", "value", "reason"),
    [
        (("frame",), None, "the file must have the fields frame, cameras, photos"),
        (("frame",), 5, "frame is 5"),
        (("more",), 1, "no others"),
        (("cameras",), [], "there is no camera 0"),
        (("cameras", 0, "width"), "640", "camera 0: width"),
        (("cameras", 0, "width"), -1, "camera 0: "),
        (("cameras", 0, "K"), [1.0], "K must be 9 finite numbers"),
        (("cameras", 0, "K", 0), float("nan"), "K must be 9 finite numbers"),
        (("cameras", 1, "D", 0), "x", "camera 1: D must be 5 finite numbers"),
        (("cameras", 0, "distortion_model"), "fish", "camera 0: "),
        ((*PHOTO, "camera"), -1, "there is no camera -1"),
        ((*PHOTO, "camera"), True, "camera is True"),
        ((*PHOTO, "position"), [1, 2], "position must be 3 finite numbers"),
        ((*PHOTO, "orientation"), [0, 0, 0, 0.5], "photo fußweg 0.jpg: "),
        ((*PHOTO, "orientation"), None, "photo fußweg 0.jpg must have the fields"),
    ],
)
def test_a_wrong_value_is_refused(tmp_path, where, value, reason):
    path = spoilt(tmp_path, where, value)
    with pytest.raises(ValueError, match=reason) as refused:
        read_photo_poses(path)
    assert str(refused.value).startswith(f"{path}: ")


@pytest.mark.parametrize(
    ("content", "reason"), [(b"\xff\xfe\x00", "UTF-8"), (b"{", "YAML"), (b"", "fields"), (b"a: [1", "YAML")]
)
def test_a_damaged_file_is_refused(tmp_path, content, reason):
    path = Path(tmp_path / "map.txt.poses")
    path.write_bytes(content)
    with pytest.raises(ValueError, match=reason):
        read_photo_poses(path)

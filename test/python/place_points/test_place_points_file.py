# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cache of the points of a map."""

import numpy as np
import pytest
from posed_street import write_street

from sextant.base.jobs import JobError
from sextant.place_maps.photo_poses import poses_path
from sextant.place_points.place_points_file import points_of_map, points_path


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Path and content of a map, its points, and the content of their cache."""
    path, place_map = write_street(tmp_path_factory.mktemp("street"))
    return path, place_map, points_of_map(path, place_map), points_path(path).read_bytes()


def again(made):
    """The points of another start, and whether they were triangulated again, with the reports."""
    lines = []
    return points_of_map(made[0], made[1], report=lines.append), lines


def test_a_second_start_reads_the_cache(made):
    points, lines = again(made)
    assert lines == [] and len(points.xyz) > 300
    for name in ("images", "poses", "xyz", "covariances", "point", "photo", "descriptors", "sigma_factor"):
        np.testing.assert_array_equal(getattr(points, name), getattr(made[2], name))
    assert points.covariance_factor == made[2].covariance_factor


@pytest.mark.parametrize("damage", ["", "flipped", "truncated", "other"])
def test_a_damaged_cache_is_replaced(made, damage):
    content = made[3]
    middle = len(content) // 2
    wrong = {
        "": b"",
        "flipped": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        "truncated": content[:middle],
        "other": b"not a cache",
    }[damage]
    points_path(made[0]).write_bytes(wrong)
    points, lines = again(made)
    assert "triangulated again" in lines[0] and "triangulating the points of 6 photos" in lines[1]
    np.testing.assert_array_equal(points.xyz, made[2].xyz)
    assert points_path(made[0]).read_bytes() != wrong and again(made)[1] == []


def test_changed_poses_are_triangulated_again(made):
    path = poses_path(made[0])
    content = path.read_text()
    path.write_text(content + "\n")
    assert "of other photos or poses" in again(made)[1][0]
    path.write_text(content)
    again(made)


def test_a_map_without_poses_has_no_points(tmp_path):
    path, place_map = write_street(tmp_path)
    poses_path(path).unlink()
    assert points_of_map(path, place_map) is None


def test_poses_in_another_frame_are_refused(tmp_path):
    path, place_map = write_street(tmp_path, frame="odom")
    with pytest.raises(ValueError, match="'odom', which is not the map's frame"):
        points_of_map(path, place_map)


def test_a_photo_of_another_size_is_refused(tmp_path):
    path, place_map = write_street(tmp_path)
    poses_path(path).write_text(poses_path(path).read_text().replace("width: 480", "width: 482"))
    with pytest.raises(JobError, match="0.png: the image has 480 x 360 pixels, its camera 482 x 360"):
        points_of_map(path, place_map)


def test_photos_without_a_pose_have_no_points(made, tmp_path):
    path, place_map = write_street(tmp_path)
    photos = [photo._replace(image=f"other {photo.image}") for photo in place_map.photos]
    lines = []
    points = points_of_map(path, place_map._replace(photos=tuple(photos)), report=lines.append)
    assert not len(points.xyz) and "no metric poses" in lines[-1]

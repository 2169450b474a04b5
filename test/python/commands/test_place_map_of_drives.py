# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Place maps of drives whose poses are known."""

import numpy as np
import pytest
from known_drives import MOUNT, SIZE, pose, write_depth_drive, write_drive
from made_photos import picture
from PIL import Image
from place_map_command import floor_yaml, printed, refused

from sextant.images.photo_depth import read_photo_depth
from sextant.images.photo_file import read_grey
from sextant.place_maps.photo_poses import read_photo_poses
from sextant.place_maps.place_map import MetricFrame, Overview
from sextant.place_maps.place_map_file import read_place_map
from sextant.simulation.camera import camera_calibration

PICK = ["--distance", "0.999"]  # so that rounding does not decide


def metric(place_map):
    """x, y, yaw of the photos in the map's frame."""
    frame, overview = place_map.georeference, place_map.overview
    return np.array([[*frame.position(overview, p.x, p.y), frame.yaw(p.yaw)] for p in place_map.photos])


def test_a_drive_is_a_map_of_its_photos(tmp_path, capsys):
    bag = write_drive(tmp_path / "hall.bag")
    (summary,) = printed(capsys, "drive", bag, "-o", tmp_path / "map.txt", *PICK)
    assert summary == f"{tmp_path}/map.txt: 5 photos of 5 places"
    made = read_place_map(tmp_path / "map.txt")
    np.testing.assert_allclose(metric(made), [(x + 0.25, 2, 0) for x in range(5)], atol=1e-4)
    for number, each in enumerate(made.photos):
        assert np.abs(read_grey(made.path(each)).astype(int) - picture(4 * number, SIZE)).mean() < 2
    assert Image.open(tmp_path / "map.png").size == (made.overview.width, made.overview.height)


def test_photos_of_a_calibrated_camera_have_poses(tmp_path, capsys):
    path, poses = tmp_path / "map.txt", tmp_path / "map.txt.poses"
    day = write_drive(tmp_path / "day.bag", calibration=camera_calibration(*SIZE))
    (summary,) = printed(capsys, "drive", day, "-o", path, *PICK)
    assert summary.endswith("5 photos of 5 places; 5 with poses")
    read = read_photo_poses(poses)
    assert read.frame == "map" and list(read.photos) == [photo.image for photo in read_place_map(path).photos]
    for number, photo in enumerate(read.photos.values()):
        np.testing.assert_allclose(photo.T_map_camera, pose(number) @ MOUNT, atol=1e-6)
        assert (photo.camera.calibration.width, photo.camera.rectified) == (SIZE[0], False)
    night = write_drive(tmp_path / "night.bag", 2.0)  # of another, uncalibrated camera
    summary = printed(capsys, "drive", night, "-o", path, "--add", *PICK)[-1]
    assert summary.endswith("8 photos of 5 places; 5 with poses")
    for each in (path, tmp_path / "map.png"):
        each.unlink()
    assert "map.txt.poses" in refused(capsys, tmp_path, "drive", night, "-o", path, *PICK)
    printed(capsys, "drive", night, "-o", path, "--force", *PICK)
    assert not poses.exists()


def test_depth_images_are_beside_their_photos(tmp_path, capsys):
    bag = write_depth_drive(tmp_path / "hall.bag")
    depth = ["--image", "/front/image_raw", "--depth", "/depth/image_raw", "--depth-scale", "1.05"]
    printed(capsys, "drive", bag, "-o", tmp_path / "map.txt", *depth)
    for photo in read_place_map(tmp_path / "map.txt").photos:
        found = read_photo_depth(tmp_path / photo.image)
        np.testing.assert_allclose(found[found > 0], 2.1, atol=1e-3)
        assert (found > 0).mean() > 0.8


@pytest.mark.slow
def test_two_drives_in_two_processes_share_their_places(tmp_path, capsys):
    bags = [write_drive(tmp_path / f"{name}.bag") for name in ("day", "night")]
    arguments = ["drive", *bags, "-o", tmp_path / "map.txt", *PICK]
    assert printed(capsys, *arguments, "--jobs", "2")[-1].endswith("10 photos of 5 places")
    made = read_place_map(tmp_path / "map.txt")
    assert [[p.image.partition("_")[0] for p in place] for place in made.places()] == 5 * [["day", "night"]]
    assert printed(capsys, *arguments, "--force", "--distance", "0.499", "--merge", "0.9")[-1].endswith(
        "18 photos of 5 places"
    )


def test_a_drive_on_the_map_of_map_server(tmp_path, capsys):
    bag, yaml = write_drive(tmp_path / "hall.bag", 7.0), floor_yaml(tmp_path / "floor")
    printed(capsys, "drive", bag, "-o", tmp_path / "map.txt", "--map-yaml", yaml, "--turn", "29.9", *PICK)
    made = read_place_map(tmp_path / "map.txt")
    assert made.overview == Overview("floor.png", 240, 200)
    assert made.georeference == MetricFrame("map", 0.05, (-1.0, -3.0, 0.3))
    turned = [(4 + 0.25 * np.cos(t), 2 + 0.25 * np.sin(t), t) for t in np.radians((30, 60, 90))]
    merged = [(4.25, 2, each[2]) for each in turned]  # a camera that turns on the spot is at one place
    np.testing.assert_allclose(metric(made), [*((x + 0.25, 2, 0) for x in range(5)), *merged], atol=1e-3)


def test_another_drive_is_added(tmp_path, capsys):
    day, night = (write_drive(tmp_path / f"{name}.bag") for name in ("day", "night"))
    output = ["-o", tmp_path / "map.txt", *PICK]
    printed(capsys, "drive", day, *output)
    before = read_place_map(tmp_path / "map.txt")
    assert printed(capsys, "drive", night, "--add", *output)[-1].endswith("10 photos of 5 places")
    after = read_place_map(tmp_path / "map.txt")
    assert after.photos[:5] == before.photos and [p.id for p in after.photos] == list(range(10))
    note, summary = printed(capsys, "drive", night, "--add", *output)
    assert note == "5 photos of these drives are already in the map"
    assert summary.endswith(": 10 photos of 5 places")
    assert read_place_map(tmp_path / "map.txt") == after


def test_a_drive_beyond_the_overview_is_left_out_there(tmp_path, capsys):
    output = ["-o", tmp_path / "map.txt", *PICK]
    printed(capsys, "drive", write_drive(tmp_path / "short.bag", 1.0), *output, "--margin", "1.5")
    *reasons, summary = printed(capsys, "drive", write_drive(tmp_path / "long.bag"), "--add", *output)
    assert summary.endswith("5 photos of 3 places; 2 left out")
    assert len(reasons) == 2 and all("outside the overview" in each for each in reasons)


def test_a_bag_that_cannot_be_read_leaves_no_map(tmp_path, capsys):
    good, bad = write_drive(tmp_path / "good.bag"), tmp_path / "bad.bag"
    bad.write_bytes(b"#ROSBAG V2.0\n" + b"x" * 50)
    arguments = ["drive", good, bad, "-o", tmp_path / "map.txt"]
    assert "bad.bag" in refused(capsys, tmp_path, *arguments)
    assert printed(capsys, *arguments, "--skip")[0].startswith(f"skipped: {bad}")


def test_drives_and_maps_of_other_frames_are_refused(tmp_path, capsys):
    bag = write_drive(tmp_path / "hall.bag")
    printed(capsys, "image", floor_yaml(tmp_path / "f"), "-o", tmp_path / "floor.txt", "--frame", "cellar")
    lines = refused(capsys, tmp_path, "drive", bag, "--add", "-o", tmp_path / "floor.txt")
    assert "floor.txt: is in 'cellar', the poses of the drive are in 'map'" in lines
    printed(capsys, "image", tmp_path / "floor.png", "-o", tmp_path / "plan.txt")
    lines = refused(capsys, tmp_path, "drive", bag, "--add", "-o", tmp_path / "plan.txt")
    assert "plan.txt: has no tf frame" in lines

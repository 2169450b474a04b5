# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What read_drive() cannot read, and its error messages."""

import pickle
from pathlib import Path

import numpy as np
import pytest
import rosbag
from std_msgs.msg import String
from written_bags import SMALL, WrittenBag, calibration_file, flat, small_drive

from sextant.bags.bag_file import BagError
from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive
from sextant.simulation.camera import camera_calibration


def refusal(path, **options):
    with pytest.raises(BagError) as caught:
        read_drive(path, BagParams(**options))
    error = pickle.loads(pickle.dumps(caught.value))
    assert str(error) == str(caught.value)
    assert error.advice
    return f"{error.what}; {error.advice}"


@pytest.fixture
def small(tmp_path):
    return small_drive(tmp_path / "small.bag", 40, compression="bz2", chunk_threshold=4000)


def test_files_that_are_no_bags(tmp_path):
    (tmp_path / "text.bag").write_text("hello\n" * 100)
    (tmp_path / "empty.bag").write_text("")
    assert refusal(tmp_path / "absent.bag").startswith("there is no such file")
    assert refusal(tmp_path).startswith("is a folder")
    assert refusal(tmp_path / "empty.bag").startswith("the file is empty")
    assert refusal(tmp_path / "text.bag").startswith("is no bag of ROS 1")


def test_a_bag_whose_recording_did_not_end(small, tmp_path):
    content = Path(small).read_bytes()
    (tmp_path / "cut.bag").write_bytes(content[: len(content) // 2])
    assert "no index" in refusal(tmp_path / "cut.bag") and "rosbag reindex" in refusal(tmp_path / "cut.bag")
    (tmp_path / "head.bag").write_bytes(content[:30])
    assert "rosbag reindex" in refusal(tmp_path / "head.bag")


def test_a_bag_that_is_damaged_in_the_middle_can_be_read_up_to_there(small, tmp_path):
    content = bytearray(Path(small).read_bytes())
    blocks = [i for i in range(len(content)) if content[i : i + 4] == b"BZh9"]
    middle = blocks[len(blocks) // 2]
    content[middle + 10 : middle + 40] = bytes(30)
    (tmp_path / "damaged.bag").write_bytes(content)
    reason = refusal(tmp_path / "damaged.bag")
    assert reason.startswith("is damaged from ")
    end = float(reason.split("`end` at ")[1].split(" ")[0])
    assert 3.0 < end < 17.0
    assert len(read_drive(tmp_path / "damaged.bag", BagParams(end=end)).images) == round(2 * end) + 1


def test_a_bag_with_nothing_in_it(tmp_path):
    rosbag.Bag(str(tmp_path / "a.bag"), "w").close()
    assert "there is no message in it" in refusal(tmp_path / "a.bag")
    with WrittenBag(tmp_path / "b.bag") as bag:
        bag.write("/chatter", String("hello"), 0.0)
    assert refusal(tmp_path / "b.bag").startswith("there are neither images nor recorded markers in it")
    assert "/chatter" in refusal(tmp_path / "b.bag")


def test_a_part_with_nothing_in_it(small):
    assert "there is no message on /cam/image_raw in the part" in refusal(small, start=100.0)


def written(tmp_path, write, image=True, info=True):
    with WrittenBag(tmp_path / "a.bag") as bag:
        if info:
            bag.info("/cam/camera_info", SMALL)
        if image:
            bag.image("/cam/image_raw", flat(), 0.0)
        write(bag)
    return tmp_path / "a.bag"


def test_images_without_a_calibration(tmp_path):
    path = written(tmp_path, lambda bag: None, info=False)
    assert refusal(path).startswith(
        "of its topics of images (/cam/image_raw) none has images and a camera_info"
    )
    named = refusal(path, images=["/cam/image_raw"])
    assert named.startswith("/cam/image_raw has no camera_info beside it (/cam/camera_info)")
    assert "calibration file" in named


UNCALIBRATED = {"K": [0.0] * 9, "P": [0.0] * 12}


def images(bag, **fields):
    for seconds in (0.0, 0.5):
        bag.image("/cam/image_raw", flat(), seconds, **fields)


@pytest.mark.parametrize(
    "write, reason",
    [
        (
            lambda bag: bag.info("/cam/camera_info", SMALL, **UNCALIBRATED),
            "K fx is 0, which is too short",
        ),
        (lambda bag: bag.info("/cam/camera_info", SMALL, distortion_model=""), "distortion_model is ''"),
        (
            lambda bag: bag.info("/cam/camera_info", camera_calibration(640, 480)),
            "64 x 48 pixels, its calibration is for 640 x 480",
        ),
        (lambda bag: bag.write("/cam/camera_info", String(), 0.0), "no camera_info but std_msgs/String"),
        (
            lambda bag: [bag.info("/cam/camera_info", SMALL, t, D=[0.1 * t] * 5) for t in (0.0, 0.5)],
            "/cam/camera_info changes after 0.50 s; name a calibration file for the camera",
        ),
    ],
)
def test_calibrations_that_cannot_be(tmp_path, write, reason):
    def both(bag):
        write(bag)
        images(bag)

    assert reason in refusal(written(tmp_path, both, image=False, info=False))


@pytest.mark.parametrize(
    "fields, reason",
    [
        ({"encoding": "32FC1"}, "the encoding '32FC1' is not an image of a camera"),
        ({"encoding": "nonsense"}, "the encoding 'nonsense' is not an image of a camera"),
        ({"data": b""}, "the image is cut short: 0 bytes of 3072 (2 times)"),
        ({"width": 0}, "the image is empty (0 x 48)"),
    ],
)
def test_images_none_of_which_can_be_used(tmp_path, fields, reason):
    path = written(tmp_path, lambda bag: images(bag, **fields), image=False)
    assert reason in refusal(path, images=["/cam/image_raw"])


def test_compressed_images_that_are_none(tmp_path):
    path = written(
        tmp_path, lambda bag: bag.compressed("/cam/image_raw/compressed", b"\xff\xd8", 0.0), image=False
    )
    assert "the compressed image (png) cannot be decoded" in refusal(path)


def test_stamps_of_zero(tmp_path):
    path = written(tmp_path, lambda bag: bag.image("/cam/image_raw", flat(), None, received=0.0), image=False)
    assert "nothing on /cam/image_raw can be used: the stamp is zero" in refusal(path)


def test_a_clock_that_jumps_back(tmp_path):
    def again(bag):
        for index in range(6):
            bag.image("/cam/image_raw", flat(), 1.0 + index % 3, received=5.0 + index)

    path = written(tmp_path, again)
    reason = refusal(path)
    assert reason.startswith("the clock of /cam/image_raw jumps back by 2.000 s at 8.000 s")
    assert len(read_drive(path, BagParams(start=8.0)).images) == 3
    assert len(read_drive(path, BagParams(end=7.5)).images) == 4


@pytest.mark.parametrize(
    "options, reason",
    [
        (
            {"images": ["/other/image"]},
            "there are no images on /other/image; topics of images in it: /cam/image_raw",
        ),
        ({"markers": ["/markers"]}, "there are no markers on /markers; topics of markers in it: none"),
        ({"calibrations": {"/other": "a.yaml"}}, "/other, named in calibrations, is not read"),
        (
            {"rectified": ["/other"]},
            "/other, named in rectified, is not read; the topics that are read: /cam/image",
        ),
        (
            {"mounts": {"lens": np.eye(4)}},
            "no camera has the frame 'lens', named in mounts; the frames are: 'camera'",
        ),
        ({"odometry": "/odom"}, "there is no nav_msgs/Odometry on /odom; topics with this type: none"),
        ({"images": ["/cam/image_raw", "cam/image_raw"]}, "the images of /cam/image_raw are named twice"),
    ],
)
def test_options_that_the_bag_cannot_meet(small, options, reason):
    assert reason in refusal(small, **options)


def test_frames_that_tf_does_not_connect(tmp_path):
    path = written(tmp_path, lambda bag: bag.transforms([("base", "lidar", np.eye(4))]))
    reason = refusal(path)
    assert reason.startswith(
        "tf does not connect 'base_link' with 'camera' (/cam/image_raw); its frames are: base, lidar"
    )


def test_two_cameras_without_tf(tmp_path):
    def second(bag):
        bag.info("/b/camera_info", SMALL)
        bag.image("/b/image_raw", flat(), 0.0, "b")

    reason = refusal(written(tmp_path, second))
    assert reason.startswith(
        "tf does not connect 'base_link' with 'b' (/b/image_raw), 'camera' (/cam/image_raw)"
    )


def test_trees_that_are_none(tmp_path):
    edges = [("base_link", "camera", np.eye(4)), ("map", "camera", np.eye(4))]
    reason = refusal(written(tmp_path, lambda bag: bag.transforms(edges)))
    assert "tf has several parents of camera: base_link, map" in reason
    loop = [("a", "camera", np.eye(4)), ("camera", "a", np.eye(4))]
    assert "has a loop" in refusal(written(tmp_path, lambda bag: bag.transforms(loop)))


def test_markers_whose_calibration_changes(tmp_path):
    def write(bag):
        bag.markers("/markers", [], SMALL, 0.0)
        bag.markers("/markers", [], camera_calibration(64, 48, 1.0), 1.0)
        bag.markers("/others", [], SMALL, 0.0)
        bag.markers("/others", [], SMALL, 1.0, rectified=True)

    path = written(tmp_path, write)
    assert refusal(path, markers=["/markers"]).startswith("the calibration on /markers changes")
    assert refusal(path, markers=["/others"]).startswith("/others has markers of raw and of rectified images")


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes, reason",
    [
        ({"image_width": None}, "no image_width"),
        ({"image_width": "wide"}, "image_width is 'wide', it must be a whole number of pixels"),
        ({"camera_matrix": None}, "no camera_matrix"),
        ({"camera_matrix": "{rows: 3, cols: 3}"}, "camera_matrix needs 'data', a list of numbers"),
        ({"camera_matrix": "{rows: 3, cols: 3, data: [1, 2]}"}, "has 2 numbers and the shape 3 x 3"),
        ({"projection_matrix": "{rows: 3, cols: 4, data: [a]}"}, "projection_matrix needs 'data'"),
        ({"distortion_coefficients": "{rows: 1, cols: 1, data: [.nan]}"}, "a list of numbers"),
        ({"distortion_model": "pincushion"}, "distortion_model is 'pincushion'"),
        ({"distortion_model": "[plumb"}, "is not YAML in line 5"),
    ],
)
def test_calibration_files_that_cannot_be_used(small, tmp_path, changes, reason):
    path = calibration_file(tmp_path / "cam.yaml", SMALL, **changes)
    with pytest.raises(BagError) as caught:
        read_drive(small, BagParams(calibrations={"/cam/image_raw": path}))
    assert caught.value.path == path and reason in caught.value.what


def test_calibration_files_that_are_not_there_or_none(small, tmp_path):
    for name, content, reason in (
        ("absent", None, "cannot be read"),
        ("list", "- 1\n", "is not a calibration file"),
    ):
        if content is not None:
            (tmp_path / name).write_text(content)
        assert reason in refusal(small, calibrations={"/cam/image_raw": str(tmp_path / name)})

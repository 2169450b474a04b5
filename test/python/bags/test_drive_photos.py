# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos of bags whose poses are known."""

import cv2
import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from known_drives import LEFT, MOUNT, RATE, SIZE, pose, write_depth_drive, write_drive
from made_photos import picture
from written_bags import SMALL, START, WrittenBag, header

from sextant.bags.bag_file import BagError
from sextant.bags.drive_photos import PhotoParams, read_drive_photos
from sextant.images.photo_depth import decoded_depth
from sextant.messages.pose_messages import pose_to_message

OPTIONS = PhotoParams(distance=0.999)  # so that rounding does not decide


def seed_of(photo):
    """Which picture it is."""
    pixels = cv2.imdecode(np.frombuffer(photo.jpeg, np.uint8), cv2.IMREAD_GRAYSCALE).astype(float)
    return int(np.argmin([np.abs(pixels - picture(i, SIZE)).mean() for i in range(41)]))


def xy(photos):
    return np.array([photo.position for photo in photos])


def test_a_metre_from_photo_to_photo(tmp_path):
    read = read_drive_photos(write_drive(tmp_path / "hall.bag"), OPTIONS)
    assert read.frame == "map" and read.warnings == ()
    np.testing.assert_allclose(xy(read.photos), [(x + 0.25, 2.0) for x in range(5)], atol=1e-6)
    assert [photo.yaw for photo in read.photos] == pytest.approx([0.0] * 5, abs=1e-6)
    assert [seed_of(photo) for photo in read.photos] == [0, 4, 8, 12, 16]
    assert [photo.name for photo in read.photos][:2] == [
        f"hall_front_{START // 10**9 + i}.000.jpg" for i in (0, 1)
    ]
    (path,) = read.paths
    np.testing.assert_allclose(path[[0, -1]], [(0.25, 2.0), (4.25, 2.0)], atol=1e-6)


def test_a_turn_has_photos_too(tmp_path):
    read = read_drive_photos(
        write_drive(tmp_path / "hall.bag", 7.01), PhotoParams(distance=0.999, turn=np.radians(29.9))
    )
    yaws = [photo.yaw for photo in read.photos]
    assert yaws == pytest.approx([0.0] * 5 + [np.radians(each) for each in (30, 60, 90)], abs=1e-6)
    np.testing.assert_allclose(read.photos[-1].position, (4.0, 2.25), atol=1e-6)  # the mount turned with it


def test_the_mount_gives_the_direction_of_the_camera(tmp_path):
    read = read_drive_photos(write_drive(tmp_path / "hall.bag", mount=LEFT), OPTIONS)
    np.testing.assert_allclose(xy(read.photos)[0], (0.0, 2.5), atol=1e-6)
    assert read.photos[0].yaw == pytest.approx(0.5 * np.pi)


def test_a_mount_can_be_named(tmp_path):
    path = tmp_path / "hall.bag"
    with WrittenBag(path) as bag:
        for i in range(9):
            bag.image("/image", picture(i, SIZE), i / RATE)
            bag.transforms([("map", "base_link", pose(i / RATE))], i / RATE, "/tf")
    read = read_drive_photos(str(path), PhotoParams(mounts={"camera": LEFT}))
    np.testing.assert_allclose(xy(read.photos), [(x, 2.5) for x in range(3)], atol=1e-6)
    assert read.photos[0].name == f"hall_{START // 10**9}.000.jpg"
    with pytest.raises(BagError, match="name the mounts"):
        read_drive_photos(str(path), PhotoParams())


def write_poses(path, camera_tf=True):
    """Poses on a topic, half a second apart, in the frame `room`."""
    with WrittenBag(path) as bag:
        if camera_tf:
            bag.transforms([("base_link", "camera", MOUNT)])
        for i in range(17):
            bag.image("/front/image_raw", picture(i, SIZE), i / RATE)
        for t in np.arange(0.0, 3.1, 0.5):
            bag.write("/pose", PoseStamped(header(t, "room"), pose_to_message(pose(t))), t)
    return str(path)


def test_poses_of_a_topic_in_place_of_tf(tmp_path):
    read = read_drive_photos(write_poses(tmp_path / "a.bag"), PhotoParams(pose="pose"))
    assert read.frame == "room"
    np.testing.assert_allclose(xy(read.photos), [(x + 0.25, 2.0) for x in range(4)], atol=1e-6)
    assert read.warnings == ("4 of 17 images have no pose",)


def test_without_any_mount_a_position_is_known_but_no_yaw(tmp_path):
    """Poses of a base, z up: as an optical frame it would look at the ceiling."""
    read = read_drive_photos(write_poses(tmp_path / "a.bag", camera_tf=False), PhotoParams(pose="pose"))
    np.testing.assert_allclose(xy(read.photos), [(x, 2.0) for x in range(4)], atol=1e-6)
    assert {photo.yaw for photo in read.photos} == {None}
    assert any("taken as the base itself" in each for each in read.warnings)


def test_of_pictures_almost_alike_the_sharpest_is_taken(tmp_path):
    """Standing; all but the fourth are blurred."""

    def image(i):
        return picture(3, SIZE) if i == 3 else cv2.GaussianBlur(picture(3, SIZE), (0, 0), 2)

    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.transforms([("map", "camera", MOUNT)])
        for i in range(8):
            bag.image("/image", image(i), i / RATE)
    (photo,) = read_drive_photos(str(tmp_path / "a.bag"), PhotoParams(base_frame="camera")).photos
    assert photo.name == f"a_{START // 10**9}.750.jpg"


def test_poses_that_stop_for_a_while_part_the_path(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.transforms([("base_link", "camera", MOUNT)])
        for i in range(17):
            bag.image("/image", picture(i, SIZE), i / RATE)
            if i < 5 or i > 11:
                bag.transforms([("map", "base_link", pose(i / RATE))], i / RATE, "/tf")
    read = read_drive_photos(str(tmp_path / "a.bag"), PhotoParams())
    assert [len(path) for path in read.paths] == [5, 5]
    assert read.warnings == ("7 of 17 images have no pose",)
    assert len(read.photos) == 4  # at 0, 1, 3 and 4 m


def test_colours_stay_in_both_kinds_of_images(tmp_path):
    red = np.zeros((48, 64, 3), np.uint8)
    red[:, :, 2] = 200
    for name, topic in (("raw", "/a/image"), ("compressed", "/a/image/compressed")):
        with WrittenBag(tmp_path / f"{name}.bag") as bag:
            bag.transforms([("map", "camera", MOUNT)])
            if name == "raw":
                bag.encoded(topic, red[:, :, ::-1], "rgb8", 0.0)
            else:
                bag.compressed(topic, red, 0.0)
        (photo,) = read_drive_photos(str(tmp_path / f"{name}.bag"), PhotoParams(base_frame="camera")).photos
        pixels = cv2.imdecode(np.frombuffer(photo.jpeg, np.uint8), cv2.IMREAD_COLOR)
        assert np.abs(pixels.astype(int) - red).max() < 5


def test_damaged_images_are_counted(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.transforms([("map", "camera", MOUNT)])
        bag.compressed("/a/image/compressed", b"no picture", 0.0)
        bag.compressed("/a/image/compressed", picture(1, SIZE), 0.25)
    read = read_drive_photos(str(tmp_path / "a.bag"), PhotoParams(base_frame="camera"))
    assert len(read.photos) == 1 and "1 of 2 messages were left out" in read.warnings[0]


def test_one_camera_of_several_has_to_be_named(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.transforms([("map", "camera", MOUNT)])
        bag.info("/a/camera_info", SMALL)
        for topic in ("/a/image_raw", "/b/image_raw", "/a/image_color"):
            bag.image(topic, picture(1, SIZE), 0.0)
        bag.encoded("/c/depth", np.ones((48, 64), np.float32), "32FC1", 0.0)
    path, options = str(tmp_path / "a.bag"), PhotoParams(base_frame="camera")
    with pytest.raises(BagError, match="several cameras.*name the topic of one: /a/image_raw, /b/image_raw"):
        read_drive_photos(path, options)
    named = PhotoParams(base_frame="camera", image="b/image_raw")
    assert read_drive_photos(path, named).photos[0].name.startswith("a_b_")
    with pytest.raises(BagError, match="there are no images on /d"):
        read_drive_photos(path, PhotoParams(image="/d"))


def test_what_is_missing_is_named(tmp_path):
    path = write_drive(tmp_path / "a.bag", poses=False)
    with pytest.raises(BagError, match="tf does not connect 'map' with 'base_link'"):
        read_drive_photos(path, PhotoParams())
    with pytest.raises(BagError, match="there is no pose on /pose"):
        read_drive_photos(path, PhotoParams(pose="/pose"))
    with WrittenBag(tmp_path / "b.bag") as bag:
        bag.odometry("/odom", pose(0), 0.0)
    with pytest.raises(BagError, match="there are no images in it; its topics are: /odom"):
        read_drive_photos(str(tmp_path / "b.bag"), PhotoParams())


def test_poses_of_another_time_are_of_no_use(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.transforms([("base_link", "camera", MOUNT)])
        bag.image("/image", picture(1, SIZE), 0.0)
        bag.transforms([("map", "base_link", pose(0))], 9.0, "/tf")
    with pytest.raises(BagError, match="no image of /image has a pose"):
        read_drive_photos(str(tmp_path / "a.bag"), PhotoParams())


@pytest.mark.parametrize("field", ["distance", "turn", "every"])
@pytest.mark.parametrize("value", [0, -1, float("nan")])
def test_what_cannot_be_is_refused(field, value):
    with pytest.raises(ValueError, match=f"{field}(:| is) "):
        PhotoParams(**{field: value})


@pytest.mark.parametrize(("frame", "metres"), [("camera", 2.0), ("depth_camera", 1.9)])
def test_photos_have_the_depth_recorded_with_them(tmp_path, frame, metres):
    path = write_depth_drive(tmp_path / "a.bag", frame)
    read = read_drive_photos(path, PhotoParams(image="/front/image_raw", depth="/depth/image_raw"))
    assert len(read.photos) == 3 and read.warnings == ()
    for photo in read.photos:
        depth = decoded_depth(photo.depth)[5:-5, 5:-5]
        assert (depth > 0).mean() > 0.8
        np.testing.assert_allclose(depth[depth > 0], metres, atol=1e-3)


@pytest.mark.parametrize(
    ("given", "topic", "reason"),
    [
        ({}, "/deep", "no image on /deep"),
        ({"info": False}, "/depth/image_raw", "has no camera_info beside it"),
        ({"depth_frame": "elsewhere"}, "/depth/image_raw", "does not connect 'camera' with 'elsewhere'"),
        ({}, "/front/image_raw", "is not depth"),
    ],
)
def test_depth_that_cannot_be_used_is_refused(tmp_path, given, topic, reason):
    path = write_depth_drive(tmp_path / "a.bag", **given)
    with pytest.raises(BagError, match=reason):
        read_drive_photos(path, PhotoParams(image="/front/image_raw", depth=topic))


def test_photos_without_a_depth_image_are_counted(tmp_path):
    path = write_depth_drive(tmp_path / "a.bag", lag=0.1)
    read = read_drive_photos(path, PhotoParams(image="/front/image_raw", depth="/depth/image_raw"))
    assert read.warnings == ("3 of 3 photos have no depth image",)
    assert {photo.depth for photo in read.photos} == {None}

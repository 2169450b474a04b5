# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of bags and videos."""

import shutil

import cv2
import numpy as np
import pytest
from known_drives import SIZE, write_depth_drive, write_drive
from made_photos import picture
from written_bags import START, WrittenBag, header

from sextant.bags.bag_file import BagError
from sextant.bags.bag_pictures import depth_of_pictures, recorded_pictures
from sextant.images.photo_depth import decoded_depth
from sextant.messages.image_messages import image_to_message


def test_every_second_picture_of_a_bag(tmp_path):
    found = list(recorded_pictures(write_drive(tmp_path / "hall.bag"), notes := [], every=2))
    assert [each.name for each in found[:2]] == [
        f"hall_front_{START // 10**9}.{part}" for part in ("000", "500")
    ]
    assert len(found) == 9 and notes == []
    for number, each in enumerate(found):
        np.testing.assert_array_equal(each.image, cv2.merge([picture(2 * number, SIZE)] * 3))


def test_pictures_of_a_video(tmp_path):
    writer = cv2.VideoWriter(str(tmp_path / "a.avi"), cv2.VideoWriter_fourcc(*"MJPG"), 10, (64, 48))
    for level in (20, 120, 220):
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    found = list(recorded_pictures(str(tmp_path / "a.avi"), [], every=2))
    assert [each.name[0] + each.name[-7:] for each in found] == ["a_000000", "a_000002"]
    assert [round(each.image.mean(), -1) for each in found] == [20, 220]
    (tmp_path / "tuesday").mkdir()
    shutil.copy(tmp_path / "a.avi", tmp_path / "tuesday/a.avi")  # the camera's numbers began again
    others = recorded_pictures(str(tmp_path / "tuesday/a.avi"), [])
    assert not {each.name for each in others} & {each.name for each in found}


@pytest.mark.parametrize("content", [None, b"", b"no video"])
def test_what_is_no_video_is_refused(tmp_path, content):
    if content is not None:
        (tmp_path / "a.mp4").write_bytes(content)
    with pytest.raises(ValueError, match="a.mp4: (there is no such file|no picture can be read)"):
        list(recorded_pictures(str(tmp_path / "a.mp4"), []))


def test_depth_of_some_pictures(tmp_path):
    path = write_depth_drive(tmp_path / "a.bag", "depth_camera")
    stamps = [each.stamp for each in recorded_pictures(path, [], "/front/image_raw")][:2]
    found, notes = depth_of_pictures(path, "/front/image_raw", "/depth/image_raw", stamps)
    assert list(found) == stamps and notes == []
    depth = decoded_depth(found[stamps[0]])[5:-5, 5:-5]
    np.testing.assert_allclose(depth[depth > 0], 1.9, atol=1e-3)
    assert depth_of_pictures(path, "/front/image_raw", "/depth/image_raw", []) == ({}, [])
    with pytest.raises(BagError, match="no image on /deep"):
        depth_of_pictures(path, "/front/image_raw", "/deep", stamps)


def test_images_without_stamps_have_different_names(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        for number in range(3):
            message = image_to_message(picture(number, SIZE), header(None, "camera"))
            bag.write("/image", message, 0.5 * number)
        bag.write("/image", image_to_message(picture(3, SIZE), header(2.0, "camera")), 2.0)
        damaged = image_to_message(picture(3, SIZE), header(2.0, "camera"))
        damaged.data = damaged.data[:-1]
        bag.write("/image", damaged, 2.5)
    notes = []
    names = [each.name for each in recorded_pictures(str(tmp_path / "a.bag"), notes)]
    assert len(set(names)) == len(names) == 4
    assert len(notes) == 1 and "1 of 5 messages" in notes[0]

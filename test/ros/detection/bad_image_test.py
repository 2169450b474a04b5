#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import cv2
import numpy as np
import rospy
import rostest
from marker_chain import ChainTest
from marker_scene import HEIGHT, WALL, WIDTH, image_msg
from ros_probe import until

DETECTION = "detector: detection"
PASSES = 5  # under load the newest image wins, and one of the bad ones may never have been looked at


def changed(msg, **fields):
    for name, value in fields.items():
        setattr(msg, name, value)
    return msg


def stacked(*planes):
    return np.ascontiguousarray(np.stack(planes, axis=2))


def readable_encodings(grey):
    """One grey picture in every encoding that holds it."""
    opaque, wide = np.full_like(grey, 255), grey.astype(np.uint16) * 257
    bgr, bgra = stacked(grey, grey, grey), stacked(grey, grey, grey, opaque)
    colourless = np.full_like(grey, 128)
    images = dict.fromkeys(
        ["mono8", "8UC1", "bayer_rggb8", "bayer_grbg8", "bayer_gbrg8", "bayer_bggr8"], grey
    )
    images.update(dict.fromkeys(["bgr8", "rgb8", "8UC3"], bgr))
    images.update(dict.fromkeys(["bgra8", "rgba8", "8UC4"], bgra))
    images.update({"mono16": wide, "bgr16": stacked(wide, wide, wide), "yuv422": stacked(colourless, grey)})
    return images


def unreadable_images(grey):
    """Every way in which an image can be no picture."""
    bytes_ = grey.tobytes()
    whole = [
        image_msg(grey, None, name) for name in ["", "nonsense", "8UC2", "8SC1", "mono8;", "bgr8", "yuv422"]
    ]
    deep = [
        image_msg(grey.astype(np.uint16), None, "16UC1"),
        image_msg(grey.astype(np.float32), None, "32FC1"),
        image_msg(grey.astype(np.float64), None, "64FC1"),
        image_msg(stacked(*[grey.astype(np.float32)] * 3), None, "32FC3"),
    ]
    malformed = [
        dict(width=0, height=0, step=0, data=b""),
        dict(width=0),
        dict(height=0),
        dict(data=b""),
        dict(data=bytes_[:-1]),
        dict(data=bytes_[: len(bytes_) // 2]),
        dict(step=0),
        dict(step=WIDTH - 1),
        dict(step=WIDTH + 1),
        dict(step=2**32 - 1),
        dict(width=2**32 - 1),
        dict(height=2**32 - 1),
        dict(width=2**32 - 1, height=2**32 - 1, step=2**32 - 1),
    ]
    return whole + deep + [changed(image_msg(grey, None), **fields) for fields in malformed]


class BadImageTest(ChainTest):
    def setUp(self):
        super().setUp()
        self.assert_still_right()

    def tearDown(self):
        self.assert_still_right()
        super().tearDown()

    def refused(self):
        return self.diagnostics.count(DETECTION, "not used: image")

    def pass_(self, bad):
        """Publishes all images; returns whether the detector has processed and counted each."""
        before = self.refused()
        for image in bad:
            self.shown.append(self.show(image))
            rospy.sleep(0.03)
        return until(lambda: self.refused() == before + len(bad), 2.5)

    def test_what_is_no_picture_is_counted_and_nothing_else(self):
        self.shown = []
        bad = unreadable_images(self.picture)
        self.assertTrue(any(self.pass_(bad) for _ in range(PASSES)), self.diagnostics.summary(DETECTION))
        self.assert_still_right()
        self.assertFalse([stamp for stamp in self.shown if self.markers.has(stamp) or self.poses.has(stamp)])

    def test_every_encoding_of_a_picture_gives_its_pose(self):
        for encoding, pixels in readable_encodings(self.picture).items():
            stamp = self.show(image_msg(pixels, None, encoding))
            self.assertIsNotNone(self.poses.at(stamp), encoding)

    def test_big_endian_and_padded_rows(self):
        big = image_msg((self.picture.astype(np.uint16) * 257).astype(">u2"), None, "mono16")
        self.assertIsNotNone(self.poses.at(self.show(changed(big, is_bigendian=1))))
        padded = np.hstack([self.picture, np.zeros((HEIGHT, 13), np.uint8)])
        self.assertIsNotNone(self.poses.at(self.show(changed(image_msg(padded, None), width=WIDTH))))

    def test_pictures_without_a_marker(self):
        noise = np.random.RandomState(1).randint(0, 256, (HEIGHT, WIDTH), np.uint8)
        blurred = cv2.GaussianBlur(self.picture, (0, 0), 15)
        for pixels in [
            np.zeros_like(noise),
            np.full_like(noise, 255),
            np.full_like(noise, WALL),
            noise,
            blurred,
        ]:
            stamp = self.show(image_msg(pixels, None))
            self.assertEqual(self.markers.at(stamp).markers, [])
            self.assert_still_right()
            self.assertFalse(self.poses.has(stamp))

    def test_another_size_than_the_calibration(self):
        before = self.diagnostics.count(DETECTION, "not used: calibration")
        for _ in range(PASSES):
            for shape in [(2, 2), (WIDTH, HEIGHT), (HEIGHT - 1, WIDTH), (2 * HEIGHT, 2 * WIDTH)]:
                stamp = self.show(image_msg(cv2.resize(self.picture, shape[::-1]), None))
                self.assert_still_right()
                self.assertFalse(self.markers.has(stamp))
        self.assertTrue(self.diagnostics.reaches(DETECTION, "not used: calibration", before + 1))

    def test_half_an_image_is_no_pose_that_is_wrong(self):
        half = self.picture.copy()
        half[:, WIDTH // 2 :] = 0

        def answered():
            self.shown = self.show(image_msg(half, None))
            return self.markers.at(self.shown, 0.5) is not None

        self.assertTrue(until(answered), "no answer to half an image")
        self.assertEqual(len(self.markers.at(self.shown).markers), 1)


if __name__ == "__main__":
    rospy.init_node("bad_image_test")
    rostest.rosrun("sextant", "bad_image", BadImageTest)

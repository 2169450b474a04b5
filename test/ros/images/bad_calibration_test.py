#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math

import numpy as np
import rospy
import rostest
from marker_chain import ChainTest
from marker_scene import HEIGHT, WIDTH, K, camera_info, image_msg
from ros_probe import Recorder, until
from sensor_msgs.msg import RegionOfInterest

from sextant.msg import MarkerArray

DETECTION = "detector: detection"
COUNTED = "not used: calibration"


def intrinsics(fx, fy=None, cx=319.5):
    return [fx, 0.0, cx, 0.0, fx if fy is None else fy, 239.5, 0.0, 0.0, 1.0]


REFUSED = {
    "K = 0": dict(K=[0.0] * 9, P=[0.0] * 12),
    "K = NaN": dict(K=[math.nan] * 9),
    "cx = NaN": dict(K=intrinsics(600.0, cx=math.nan)),
    "fx = inf": dict(K=intrinsics(math.inf)),
    "fx < 0": dict(K=intrinsics(-600.0, 600.0)),
    "fx = fy = 1": dict(K=intrinsics(1.0)),
    "no size": dict(width=0, height=0),
    "twice the size": dict(width=2 * WIDTH, height=2 * HEIGHT),
    "turned by 90 degrees": dict(width=HEIGHT, height=WIDTH),
    "binned": dict(binning_x=2, binning_y=2),
    "binned beyond the image": dict(binning_x=2**32 - 1, binning_y=2**32 - 1),
    "a region of the image": dict(roi=RegionOfInterest(x_offset=10, y_offset=10, width=100, height=100)),
    "unknown distortion": dict(distortion_model="barrel"),
    "no distortion model": dict(distortion_model=""),
    "three coefficients": dict(D=[0.0] * 3),
    "no coefficients": dict(distortion_model="rational_polynomial", D=[]),
    "D = NaN": dict(D=[math.nan] * 5),
}


def changed(**fields):
    info = camera_info()
    for name, value in fields.items():
        setattr(info, name, value)
    return info


class BadCalibrationTest(ChainTest):
    def setUp(self):
        super().setUp()
        self.assert_still_right()
        # Refused images of the test before may not be in the diagnostics yet.
        self.assertTrue(self.diagnostics.renewed(DETECTION))

    def refuse(self, name, fields):
        """Shows images until the detector has counted that it did not use one, and then one more."""
        before = self.diagnostics.count(DETECTION, COUNTED)

        def counted():
            self.infos.publish(changed(**fields))
            self.show()
            return until(lambda: self.diagnostics.count(DETECTION, COUNTED) > before, 0.2)

        self.assertTrue(until(counted), name)
        return self.show()

    def test_what_is_no_calibration_of_the_image_gives_nothing(self):
        late = []
        for name, fields in REFUSED.items():
            late.append(self.refuse(name, fields))
        self.assertTrue(self.diagnostics.renewed(DETECTION))  # the last image may still wait for the detector
        self.assert_still_right()
        self.assertFalse([stamp for stamp in late if self.markers.has(stamp)])
        self.assertTrue(until(self.markers.all))
        used = {(msg.camera_info.width, msg.camera_info.K) for msg in self.markers.all()}
        self.assertEqual(used, {(WIDTH, tuple(K.ravel()))})
        self.assertTrue(until(lambda: self.diagnostics.summary(DETECTION) == "working"))

    def test_the_operator_reads_what_is_wrong(self):
        self.refuse("fx = fy = 1", REFUSED["fx = fy = 1"])
        self.assertIn("K fx is 1, which is too short", self.diagnostics.summary(DETECTION))
        self.assert_still_right()
        self.refuse("twice the size", REFUSED["twice the size"])
        self.assertIn("1280 x 960 pixels, the image has 640 x 480", self.diagnostics.summary(DETECTION))

    def test_no_coefficients_are_a_lens_without_distortion(self):
        def answered():
            self.infos.publish(changed(D=[]))
            msg = self.markers.at(self.show(), 0.3)
            return msg is not None and len(msg.camera_info.D) == 0

        self.assertTrue(until(answered))

    def test_tiny_images_with_a_fitting_calibration(self):
        for height, width in [(1, 1), (2, 2), (1, 640), (480, 2), (7, 5)]:
            pixels = np.random.RandomState(1).randint(0, 256, (height, width), np.uint8)
            info = changed(width=width, height=height, K=intrinsics(600.0, cx=0.0))
            info.K[5] = 0.0

            def answered(pixels=pixels, info=info):
                self.infos.publish(info)
                msg = self.markers.at(self.show(image_msg(pixels, None)), 0.3)
                return msg is not None and msg.markers == []

            self.assertTrue(until(answered), (height, width))
        self.assert_still_right()

    def test_a_rectified_image_needs_a_rotation_and_a_projection(self):
        status = "rectified_detector: detection"
        for fields in [
            dict(R=[0.0] * 9),
            dict(R=[math.nan] * 9),
            dict(P=[0.0] * 12),
            dict(P=[math.nan] * 12),
        ]:
            received = Recorder("rectified/markers", MarkerArray)
            before = self.diagnostics.count(status, COUNTED)

            def counted(fields=fields, before=before):
                self.infos.publish(changed(**fields))
                self.show()
                return until(lambda: self.diagnostics.count(status, COUNTED) > before, 0.2)

            self.assertTrue(until(counted), fields)
            received.close()
            received = Recorder("rectified/markers", MarkerArray)
            self.assertTrue(received.connected())
            late = self.show()
            self.assertIsNotNone(self.markers.at(late))  # K is good: the other detector has looked at it
            self.assertFalse(received.has(late))
            received.close()

    def test_without_camera_info_there_is_nothing(self):
        status = "uncalibrated_detector: detection"
        received = Recorder("uncalibrated/markers", MarkerArray)
        self.addCleanup(received.close)

        def counted():
            self.show()
            return until(lambda: self.diagnostics.count(status, COUNTED) > 0, 0.2)

        self.assertTrue(until(counted))
        self.assertEqual(received.all(), [])
        self.assertIn("no calibration on /nobody/camera_info yet", self.diagnostics.summary(status))


if __name__ == "__main__":
    rospy.init_node("bad_calibration_test")
    rostest.rosrun("sextant", "bad_calibration", BadCalibrationTest)

#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math
import re
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import cv2
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from made_photos import picture, shifted
from nav_msgs.msg import Odometry
from ros_probe import WAIT, Diagnostics, Recorder, stamps, subscribers_of, until
from sensor_msgs.msg import CompressedImage, Image, NavSatFix
from std_msgs.msg import Header
from std_srvs.srv import Trigger

from sextant.msg import PlaceHypotheses, Places

COUNT = 12
RATE = 2.0  # Hz, of slow
# 10 pixels from photo to photo are 1 m; the frame is turned by a quarter to the left
METRIC = "frame=town;resolution=0.1;origin=7,3," + repr(math.pi / 2)
CORNERS = "north_west=55.01,13.0;south_east=55.0,13.02"  # of 1000 x 100 pixels
DIAGNOSTICS = "robot/robot: places"


class PlaceLocalizerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="a town ")
        cls.addClassCleanup(folder.cleanup)
        cls.folder, cls.stamps = Path(folder.name), stamps()
        for number in range(COUNT + 1):
            cv2.imwrite(str(cls.folder / f"{number}.png"), picture(number))
        cls.images = rospy.Publisher("/robot/image", Image, queue_size=10)
        cls.jpegs = rospy.Publisher("/walker/image/compressed", CompressedImage, queue_size=10)
        cls.hasty = rospy.Publisher("/slow/image", Image, queue_size=100)
        cls.publishers = {"robot": cls.images, "walker": cls.jpegs, "slow": cls.hasty}
        cls.odometry = rospy.Publisher("/robot/odom", Odometry, queue_size=100)
        cls.rough = rospy.Publisher("/robot/rough_pose", PoseWithCovarianceStamped, queue_size=10)
        cls.diagnostics = Diagnostics()
        given = "_use_odometry:=true", "_use_rough_pose:=true", "_initialpose:=relocalized"
        cls.start("robot", cls.write("town.txt", METRIC), *given)
        (cls.folder / "earth.txt.index").write_bytes(b"SEXTANT PLACES\n\0\1\0\0\0 of long ago")
        cls.start("walker", cls.write("earth.txt", CORNERS), "_mode:=single", "_compressed:=true")
        cls.start("slow", cls.write("street.txt", METRIC), f"_rate:={RATE}")
        for name in cls.publishers:
            rospy.wait_for_service(f"/{name}/{name}/publish_initialpose", WAIT)  # the last that it offers

    @classmethod
    def write(cls, name, *fields, count=COUNT):
        lines = [";".join(["overview.png;1000;100", *fields])]
        lines += [f"{number};{number}.png;{10 * number};50;yaw=0.5" for number in range(count)]
        (cls.folder / name).write_text("\n".join(lines) + "\n")
        return f"_map_file:={cls.folder / name}"

    @classmethod
    def start(cls, name, *given):
        """A localizer in a namespace of its own; its log is NAME.log in the folder."""
        log = open(cls.folder / f"{name}.log", "w")  # noqa: SIM115
        command = ["rosrun", "sextant", "place_localizer", f"__ns:=/{name}", f"__name:={name}", *given]
        node = subprocess.Popen(command, stdout=log, stderr=log)
        cls.addClassCleanup(cls.stop, node, log)

    @staticmethod
    def stop(node, log):
        node.terminate()
        node.wait(WAIT)
        log.close()

    def setUp(self):
        self.call("/robot/robot/reset")

    def call(self, service):
        return rospy.ServiceProxy(service, Trigger)()

    def recorder(self, topic, kind):
        """A recorder that is connected; images reach the node."""
        received = Recorder(topic, kind)
        self.addCleanup(received.close)
        self.assertTrue(received.connected())
        publisher = self.publishers[topic.split("/")[1]]
        self.assertTrue(until(lambda: publisher.get_num_connections() == 1))
        return received

    def has_logged(self, words, name="robot"):
        """Whether the words are in the log of a node, soon."""
        return until(lambda: re.search(words, (self.folder / f"{name}.log").read_text()))

    def show(self, pixels, stamp=None, height=None, name="robot"):
        stamp = stamp or next(self.stamps)
        rows, columns = pixels.shape
        header = Header(stamp=stamp, frame_id="camera")
        image = Image(header, height or rows, columns, "mono8", 0, columns, pixels.tobytes())
        self.publishers[name].publish(image)
        return stamp

    def walk(self, received, places):
        """Messages about pictures of places, one after another."""
        return [received.at(self.show(shifted(picture(place), 6, 2))) for place in places]

    def test_an_image_results_in_places_hypotheses_and_a_pose(self):
        places, hypotheses = (
            self.recorder("/robot/places", Places),
            self.recorder("/robot/hypotheses", PlaceHypotheses),
        )
        poses = self.recorder("/robot/pose", PoseWithCovarianceStamped)
        self.walk(places, (3, 4, 5))
        stamp = self.show(shifted(picture(6), 6, 2))
        answer, full, pose = places.at(stamp), hypotheses.at(stamp), poses.at(stamp)
        self.assertEqual((answer.header.frame_id, answer.poses[0]), ("camera", 6))
        self.assertEqual([each.id for each in full.places], list(answer.poses))
        self.assertEqual((full.status, full.frame), (PlaceHypotheses.LOCALIZED, "town"))
        self.assertLess(sum(answer.probabilities) + full.unknown_probability, 1 + 1e-5)
        best = full.places[0]
        self.assertEqual((best.image, best.x, best.y), ("6.png", 60, 50))
        # 6 m to the right and 5 m up, turned by a quarter
        np.testing.assert_allclose(best.pose.pose.position.x, 7 - 5, atol=1e-6)
        self.assertEqual(pose.header.frame_id, "town")
        where = pose.pose.pose.position
        np.testing.assert_allclose([where.x, where.y], [2, 9], atol=0.7)
        yaw = 2 * math.atan2(pose.pose.pose.orientation.z, pose.pose.pose.orientation.w)
        self.assertAlmostEqual(yaw, 0.5 + math.pi / 2, places=4)
        self.assertLess(abs(where.y - 9), 3 * math.sqrt(pose.pose.covariance[7]))
        self.assertTrue(until(lambda: self.diagnostics.row(DIAGNOSTICS, "place") == "6"))
        self.assertGreater(self.diagnostics.count(DIAGNOSTICS, "keypoints"), 100)
        self.assertTrue(self.diagnostics.row(DIAGNOSTICS, "time").endswith(" ms"))

    def test_a_rough_pose_is_used_if_it_is_in_the_frame_of_the_map(self):
        places = self.recorder("/robot/places", Places)
        self.assertTrue(until(lambda: self.rough.get_num_connections() == 1))
        counted = self.diagnostics.count(DIAGNOSTICS, "images with a rough pose")
        for frame, more in (("odom", 0), ("town", 1)):
            rough = PoseWithCovarianceStamped(header=Header(stamp=next(self.stamps), frame_id=frame))
            rough.pose.pose.orientation.w, rough.pose.covariance[35] = 1.0, 10.0
            rough.pose.covariance[0] = rough.pose.covariance[7] = 100.0
            self.rough.publish(rough)
            rospy.sleep(0.5)  # no message confirms it
            places.at(self.show(shifted(picture(3), 6, 2)))
            self.assertTrue(self.diagnostics.reaches(DIAGNOSTICS, "images with a rough pose", counted + more))
        self.assertEqual(self.diagnostics.count(DIAGNOSTICS, "images with a rough pose"), counted + 1)
        self.assertTrue(self.has_logged("a rough pose is not used: its frame is 'odom'"))

    def test_elsewhere_is_nowhere(self):
        full = self.recorder("/robot/hypotheses", PlaceHypotheses)
        poses = self.recorder("/robot/pose", PoseWithCovarianceStamped)
        published_stamps = [self.show_and_receive(full, picture(300 + i)) for i in range(3)]
        self.assertEqual(full.at(published_stamps[-1]).status, PlaceHypotheses.UNKNOWN_PLACE)
        self.assertGreater(full.at(published_stamps[-1]).unknown_probability, 0.5)
        self.assertFalse(any(poses.has(stamp) for stamp in published_stamps))

    def show_and_receive(self, received, pixels):
        stamp = self.show(pixels)
        self.assertIsNotNone(received.at(stamp))
        return stamp

    def test_a_damaged_image_is_counted_and_an_empty_one_logged(self):
        places = self.recorder("/robot/places", Places)
        before = self.diagnostics.count(DIAGNOSTICS, "damaged images")
        damaged = self.show(picture(3), height=999)
        # a picture that follows at once could take its place
        self.assertTrue(self.diagnostics.reaches(DIAGNOSTICS, "damaged images", before + 1))
        empty = places.at(self.show(np.full((240, 320), 80, np.uint8)))
        self.assertEqual((list(empty.poses), list(empty.probabilities)), ([0], [0.0]))
        self.assertFalse(places.has(damaged))
        self.assertTrue(self.has_logged("image on /robot/image is skipped: the image is cut short"))
        self.assertEqual(self.walk(places, (3,))[0].poses[0], 3)

    def test_compressed_pictures_in_a_georeferenced_map_are_a_fix(self):
        fixes, places = self.recorder("/walker/fix", NavSatFix), self.recorder("/walker/places", Places)
        stamp = next(self.stamps)
        header = Header(stamp=stamp, frame_id="camera")
        self.jpegs.publish(CompressedImage(header, "jpeg", b"\xff\xd8\xff"))
        jpeg = cv2.imencode(".jpg", shifted(picture(8), 6, 2))[1].tobytes()
        self.assertTrue(self.has_logged("cannot be decoded", "walker"))
        self.jpegs.publish(CompressedImage(header, "jpeg", jpeg))
        self.assertEqual(places.at(stamp).poses[0], 8)
        fix = fixes.at(stamp)
        # 80 of 1000 pixels to the right, half of the way down; 0.02 degrees are 1276 m there
        np.testing.assert_allclose([fix.latitude, fix.longitude], [55.005, 13.0016], atol=2e-4)
        self.assertEqual(fix.position_covariance_type, NavSatFix.COVARIANCE_TYPE_KNOWN)
        deviations = np.sqrt(np.array(fix.position_covariance)[[0, 4]])  # half of 12.76 m between places
        np.testing.assert_allclose(deviations, 6.4, atol=0.3)
        self.assertTrue(math.isnan(fix.altitude))

    def test_a_clock_that_is_set_back_is_a_new_beginning(self):
        places = self.recorder("/robot/places", Places)
        self.walk(places, (2, 3, 4))
        answer = places.at(self.show(shifted(picture(9), 6, 2), rospy.Time(100)))
        self.assertEqual(answer.poses[0], 9)
        self.assertTrue(self.has_logged("the images' clock was set back"))

    def test_more_images_than_its_rate_are_dropped_except_the_last(self):
        places, begin, shown = self.recorder("/slow/places", Places), time.monotonic(), []
        while time.monotonic() < begin + 2.0:
            shown.append(self.show(shifted(picture(3), 6, 2), name="slow"))
            time.sleep(0.05)
        self.assertIsNotNone(places.at(shown[-1]))
        answers = len(places.all())
        self.assertLessEqual(answers, 1 + RATE * (time.monotonic() - begin))
        self.assertGreaterEqual(answers, 3)

    def test_a_picture_that_comes_late_is_left_out(self):
        places = self.recorder("/robot/places", Places)
        first, *_, last = self.walk(places, (2, 3, 4))
        before = self.diagnostics.count(DIAGNOSTICS, "late images")
        late = self.show(shifted(picture(9), 6, 2), last.header.stamp - rospy.Duration(0.9))
        self.assertTrue(self.diagnostics.reaches(DIAGNOSTICS, "late images", before + 1))
        answer = self.walk(places, (5,))[0]
        self.assertFalse(places.has(late))
        self.assertEqual(answer.poses[0], 5)
        self.assertGreater(answer.probabilities[0], first.probabilities[0])  # nothing was forgotten

    def test_odometry_carries_the_robot_on(self):
        """4 m on, an image that alone is of no use."""
        full = self.recorder("/robot/hypotheses", PlaceHypotheses)
        self.assertTrue(until(lambda: self.odometry.get_num_connections() == 1))
        before = self.diagnostics.count(DIAGNOSTICS, "odometry messages")
        way = [(next(self.stamps), x) for x in (0.0, 1.0, 2.0, 6.0)]
        for stamp, x in way:
            odometry = Odometry(header=Header(stamp=stamp, frame_id="odom"))
            odometry.pose.pose.position.x = x
            self.odometry.publish(odometry)
        # it has another connection than the pictures
        self.assertTrue(self.diagnostics.reaches(DIAGNOSTICS, "odometry messages", before + len(way)))
        pixels = [*(shifted(picture(place), 6, 2) for place in range(3)), np.full((240, 320), 80, np.uint8)]
        for (stamp, _), seen in zip(way, pixels):
            answer = full.at(self.show(seen, stamp))
        self.assertEqual(answer.status, PlaceHypotheses.UNUSABLE)
        self.assertLessEqual(abs(answer.places[0].id - 6), 1)
        self.assertGreater(answer.places[0].probability, 0.5)
        self.assertTrue(until(lambda: self.diagnostics.row(DIAGNOSTICS, "odometry distance") == "4.00 m"))

    def test_initialpose_comes_when_found_again_and_on_request(self):
        places = self.recorder("/robot/places", Places)
        poses = self.recorder("/robot/initialpose", PoseWithCovarianceStamped)
        answer = self.call("/robot/robot/publish_initialpose")
        self.assertFalse(answer.success)
        self.assertIn("not localized", answer.message)
        last = self.walk(places, (0, 1, 2, 3))[-1].header.stamp
        self.assertTrue(until(lambda: len(poses.all()) == 1))
        self.assertTrue(self.call("/robot/robot/publish_initialpose").success)
        self.assertIsNotNone(poses.at(last))
        self.assertEqual(len(poses.all()), 2)

    def test_a_changed_map_is_read_again_but_not_a_broken_one(self):
        places = self.recorder("/robot/places", Places)
        self.addCleanup(self.call, "/robot/robot/reload")
        self.addCleanup(self.write, "town.txt", METRIC)
        self.write("town.txt", METRIC, count=COUNT + 1)
        answer = self.call("/robot/robot/reload")
        self.assertTrue(answer.success)
        self.assertIn("13 photos of 13 places", answer.message)
        self.assertEqual(self.walk(places, (COUNT - 1, COUNT))[-1].poses[0], COUNT)
        self.write("town.txt", METRIC + ";origin=3")
        answer = self.call("/robot/robot/reload")
        self.assertFalse(answer.success)
        self.assertIn("town.txt:1: duplicate field origin", answer.message)
        self.assertEqual(self.walk(places, (COUNT,))[-1].poses[0], COUNT)

    def test_matches_are_drawn_while_somebody_looks(self):
        places = self.recorder("/robot/places", Places)
        self.walk(places, (4,))
        matches = self.recorder("/robot/matches/image", Image)
        stamp = self.show(shifted(picture(4), 6, 2))
        drawn = matches.at(stamp)
        self.assertEqual((drawn.encoding, drawn.width, drawn.height), ("rgb8", 2 * 640 + 8, 480 + 36))
        matches.close()
        places.close()
        self.assertTrue(until(lambda: self.images.get_num_connections() == 1))  # initialpose is wanted, still
        self.assertTrue(until(lambda: subscribers_of("/walker/image/compressed") == []))

    def test_a_cache_of_another_version_is_built_anew(self):
        """walker's; the other tests show that it works."""
        line = "earth.txt.index: has version 1, expected "
        self.assertTrue(self.has_logged(f"{line}.; the index is rebuilt", "walker"))

    def test_a_photo_that_is_changed_behind_its_back_harms_nothing(self):
        places, matches = self.recorder("/robot/places", Places), self.recorder("/robot/matches/image", Image)
        photo = self.folder / "5.png"
        self.addCleanup(self.call, "/robot/robot/reload")
        self.addCleanup(photo.write_bytes, photo.read_bytes())
        self.walk(places, (4, 5))
        cv2.imwrite(str(photo), picture(99, (200, 320)))
        self.assertIsNotNone(matches.at(self.show(shifted(picture(5), 6, 2))))
        for change, reason in (
            (lambda: photo.write_bytes(photo.read_bytes()[:2000]), "5.png: the image is damaged"),
            (lambda: photo.write_text("text"), "5.png: is not an image"),
            (photo.unlink, "town.txt: missing photos: 5.png"),
        ):
            change()
            self.assertEqual(self.walk(places, (5,))[0].poses[0], 5)
            answer = self.call("/robot/robot/reload")
            self.assertFalse(answer.success)
            self.assertIn(reason, answer.message)
            self.assertEqual(self.walk(places, (5,))[0].poses[0], 5)
        self.assertTrue(self.has_logged("no match image: "))


if __name__ == "__main__":
    rospy.init_node("place_localizer_test")
    rostest.rosrun("sextant", "place_localizer", PlaceLocalizerTest)

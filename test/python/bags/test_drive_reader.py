# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from functools import partial

import cv2
import numpy as np
import pytest
from written_bags import SMALL, START, WrittenBag, calibration_file, detect, flat, nanoseconds, small_drive

import sextant
from sextant.bags.bag_file import BagError
from sextant.bags.bag_params import BagParams
from sextant.bags.drive_reader import read_drive
from sextant.base.jobs import run_jobs
from sextant.simulation.drive import DriveParams, SimulatedDrive

TURNED = sextant.pose_from_xyz_rpy([0.1, -0.2, 0.3], [0.1, -0.4, 1.2])
BEHIND = {
    "camera_rpy": [0.0, 0.0, np.pi],
    "camera_xyz": [-0.1, 0.0, 1.0],
    "distortion": [-0.1, 0.02, 0.0, 0.0, 0.0],
}


@pytest.fixture(scope="module")
def drives():
    """Two cameras of one robot, and what they saw: [(drive, frames)]."""
    both = [SimulatedDrive(DriveParams(rate=1.0, supersampling=1, **mount)) for mount in ({}, BEHIND)]
    return [(drive, list(drive.frames(3))) for drive in both]


@pytest.fixture(scope="module")
def seen(drives):
    """Of each camera and frame, the detections."""
    return [[detect(frame.image, drive.calibration) for frame in frames] for drive, frames in drives]


def assert_same(images, detections):
    assert len(images) == len(detections)
    for image, expected in zip(images, detections):
        assert [(marker.family, marker.id) for marker in image.markers] == [
            (d.family, d.id) for d in expected
        ]
        for marker, detection in zip(image.markers, expected):
            np.testing.assert_array_equal(marker.corners, detection.corners)
            np.testing.assert_array_equal(marker.corner_sigmas, detection.corner_sigmas)


def write_camera(bag, drive, frames, name, frame):
    bag.info(f"/{name}/camera_info", drive.calibration, frame=frame)
    for each in frames:
        bag.image(f"/{name}/image_raw", each.image, each.time, frame)


@pytest.fixture
def recorded(drives, tmp_path):
    """The path of a bag with both cameras on a mast, and odometry."""
    (front, front_frames), (back, back_frames) = drives
    T_mast_front = np.linalg.inv(TURNED) @ front.T_base_camera
    with WrittenBag(tmp_path / "a.bag") as bag:
        write_camera(bag, front, front_frames, "front", "front_optical")
        bag.transforms([("base_link", "mast", TURNED)])
        bag.transforms(
            [("/mast", "/front_optical", T_mast_front)], received=2.0
        )  # of another publisher, late
        bag.transforms([("back_optical", "base_link", np.linalg.inv(back.T_base_camera))])
        write_camera(bag, back, back_frames, "back", "back_optical")
        for each in front_frames:
            bag.odometry("/odom", each.T_odom_base, each.time)
    return tmp_path / "a.bag"


@pytest.mark.slow
def test_what_two_cameras_saw_from_where_they_sit(recorded, drives, seen):
    drive = read_drive(recorded)
    assert drive.name == str(recorded) and drive.warnings == ()
    assert [image.stamp for image in drive.images] == sorted(2 * [START + i * 10**9 for i in range(3)])
    assert sum(len(each) for camera in seen for each in camera) > 6
    for name, (each, _), detections in zip(("/front/image_raw", "/back/image_raw"), drives, seen):
        camera = drive.cameras[name]
        assert_same([image for image in drive.images if image.camera == name], detections)
        assert camera.T_base_camera == pytest.approx(each.T_base_camera, abs=1e-12)
        np.testing.assert_array_equal(camera.calibration.K, each.calibration.K)
        assert camera.calibration.D == each.calibration.D and not camera.rectified


def test_odometry_of_the_wheels(recorded, drives):
    drive, frames = read_drive(recorded), drives[0][1]
    assert drive.odometry_stamps.tolist() == [START + i * 10**9 for i in range(3)]
    assert drive.odometry == pytest.approx(np.array([each.T_odom_base for each in frames]), abs=1e-12)


def test_compressed_images_and_other_families(drives, seen, tmp_path):
    drive, frames = drives[0]
    with WrittenBag(tmp_path / "a.bag", compression="lz4") as bag:
        bag.info("/cam/camera_info", drive.calibration)
        bag.compressed("/cam/image_raw/compressed", frames[0].image, 0.0)
    result = read_drive(tmp_path / "a.bag")
    assert list(result.cameras) == ["/cam/image_raw"]
    assert_same(result.images, seen[0][:1])
    named = BagParams(images=["cam/image_raw"], families=["DICT_4X4_50"])
    assert read_drive(tmp_path / "a.bag", named).images[0].markers == []


@pytest.mark.parametrize(
    "encoding, data, big",
    [
        ("bgr8", lambda grey: cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR), False),
        ("rgba8", lambda grey: cv2.cvtColor(grey, cv2.COLOR_GRAY2RGBA), False),
        ("8UC4", lambda grey: cv2.cvtColor(grey, cv2.COLOR_GRAY2BGRA), False),
        ("mono16", lambda grey: (grey.astype("<u2") << 8) + 255, False),
        ("mono16", lambda grey: ((grey.astype(np.uint16) << 8) + 255).astype(">u2"), True),
    ],
)
def test_encodings_with_padded_rows(drives, seen, tmp_path, encoding, data, big):
    drive, frames = drives[0]
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", drive.calibration)
        bag.encoded("/cam/image_raw", data(frames[0].image), encoding, 0.0, padding=8, big=big)
    assert_same(read_drive(tmp_path / "a.bag").images, seen[0][:1])


def test_recorded_markers(drives, seen, tmp_path):
    drive = drives[0][0]
    with WrittenBag(tmp_path / "a.bag") as bag:
        for index, detections in enumerate(seen[0]):
            bag.markers("/markers", detections, drive.calibration, float(index), "camera")
        bag.info("/cam/camera_info", SMALL)
        bag.image("/cam/image_raw", flat(), 0.0)
    result = read_drive(tmp_path / "a.bag")
    assert_same(result.images, seen[0])
    assert list(result.cameras) == ["/markers"] and result.cameras["/markers"].calibration.width == 640
    assert "/cam/image_raw was left out: markers were recorded" in result.warnings
    assert list(read_drive(tmp_path / "a.bag", BagParams(images=["/cam/image_raw"])).cameras) == [
        "/cam/image_raw"
    ]


def test_markers_without_deviations_have_unknown_ones(tmp_path):
    detection = sextant.Detection("DICT_APRILTAG_36h11", 3, np.arange(8.0).reshape(4, 2))
    detection.corner_sigmas = [0.0, 0.2, -1.0, 0.0]
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.markers("/markers", [detection], SMALL, 0.0, rectified=True)
    result = read_drive(tmp_path / "a.bag")
    assert result.images[0].markers[0].family == "tag36h11" and result.cameras["/markers"].rectified
    np.testing.assert_array_equal(result.images[0].markers[0].corner_sigmas, [-1.0, 0.2, -1.0, -1.0])


def test_calibration_file_replaces_camera_info(drives, tmp_path):
    drive, frames = drives[1]
    path = calibration_file(tmp_path / "cam.yaml", drive.calibration)
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", SMALL)
        bag.image("/cam/image_raw", frames[0].image, 0.0)
        bag.markers("/markers", [], SMALL, 0.0)
    for topic in ("/cam/image_raw", "/markers"):
        kind = "markers" if topic == "/markers" else "images"
        result = read_drive(tmp_path / "a.bag", BagParams(**{kind: [topic]}, calibrations={topic: path}))
        camera = result.cameras[topic].calibration
        assert (camera.width, camera.height, camera.D) == (640, 480, drive.calibration.D)
        np.testing.assert_array_equal(camera.P, drive.calibration.P)
    result = read_drive(
        tmp_path / "a.bag", BagParams(images=["/cam/image_raw"], calibrations={"cam/image_raw": path})
    )
    assert_same(result.images, [detect(frames[0].image, drive.calibration)])


def test_binning_and_region_of_interest_are_applied(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", SMALL, binning_x=2, binning_y=2, width=128, height=96)
        bag.image("/cam/image_raw", flat(), 0.0)
    camera = read_drive(tmp_path / "a.bag").cameras["/cam/image_raw"].calibration
    K = SMALL.K
    expected = [K[0, 0] / 2, 0, (K[0, 2] + 0.5) / 2 - 0.5, 0, K[1, 1] / 2, (K[1, 2] + 0.5) / 2 - 0.5, 0, 0, 1]
    assert camera.K.ravel() == pytest.approx(expected) and (camera.width, camera.height) == (64, 48)


def test_one_topic_of_each_camera_is_read(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        for camera in ("/a", "/b", "/depth"):
            bag.info(f"{camera}/camera_info", SMALL)
        for topic in ("/a/image_rect", "/a/image_raw", "/b/image_rect_color", "/alone/image"):
            bag.image(topic, flat(), 0.0)
        bag.compressed("/a/image_raw/compressed", flat(), 0.0)
        bag.compressed("/a/image_raw/compressedDepth", flat(), 0.0)
        bag.encoded("/depth/image", np.zeros((48, 64), np.uint16), "16UC1", 0.0)
    options = BagParams(mounts={"camera": TURNED})
    result = read_drive(tmp_path / "a.bag", options)
    assert {name: camera.rectified for name, camera in result.cameras.items()} == {
        "/a/image_raw": False,
        "/b/image_rect_color": True,
    }
    assert sorted(result.warnings) == [
        "/a/image_raw/compressed was left out: the same camera as /a/image_raw",
        "/a/image_rect was left out: the same camera as /a/image_raw",
        "/alone/image was left out: no camera_info beside it",
        "/depth/image was left out: it holds no images",
    ]
    assert all(np.array_equal(camera.T_base_camera, TURNED) for camera in result.cameras.values())
    named = BagParams(images=["/a/image_raw"], rectified=["/a/image_raw"], mounts={"camera": TURNED})
    assert read_drive(tmp_path / "a.bag", named).cameras["/a/image_raw"].rectified


def test_a_camera_that_moves_on_the_robot(tmp_path):
    def joint(angle):
        return sextant.pose_from_xyz_rpy([0.2, 0.0, 0.5], [0.0, 0.0, angle])

    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", SMALL)
        bag.transforms([("head", "camera", TURNED)])
        for seconds, angle in ((0.0, 0.0), (1.0, 0.0), (2.0, 0.6)):
            bag.transforms([("base_link", "head", joint(angle))], seconds, "/tf")
        for seconds in (0.25, 0.5, 1.25, 2.5):
            bag.image("/cam/image_raw", flat(), seconds)
    result = read_drive(tmp_path / "a.bag")
    assert [image.camera for image in result.images] == [
        "/cam/image_raw",
        "/cam/image_raw",
        "/cam/image_raw#2",
    ]
    assert result.cameras["/cam/image_raw"].T_base_camera == pytest.approx(joint(0.0) @ TURNED, abs=1e-12)
    assert result.cameras["/cam/image_raw#2"].T_base_camera == pytest.approx(joint(0.15) @ TURNED, abs=1e-12)
    assert (
        "/cam/image_raw: 1 of 4 messages were left out: tf was not recorded at its stamp" in result.warnings
    )
    assert "/cam/image_raw: its camera moves on the robot, it took images from 2 places" in result.warnings


def test_a_camera_without_a_robot_is_the_base(tmp_path):
    small_drive(tmp_path / "a.bag")
    result = read_drive(tmp_path / "a.bag")
    np.testing.assert_array_equal(result.cameras["/cam/image_raw"].T_base_camera, np.eye(4))
    assert any(
        "is taken as the base itself, and odometry is not used" in warning for warning in result.warnings
    )
    assert read_drive(tmp_path / "a.bag", BagParams(base_frame="camera")).warnings == ()


def test_a_part_of_a_bag_and_its_progress(tmp_path):
    progress = []
    path = small_drive(tmp_path / "a.bag", 9)  # until 4 s
    part = read_drive(path, BagParams(start=0.75, end=3.25, every=2), progress.append)
    assert [image.stamp for image in part.images] == [nanoseconds(t) for t in (1.0, 2.0, 3.0)]
    assert progress == sorted(progress) and progress[-1] == 1.0 and 0.0 < progress[0] < 0.2


def test_damage_of_single_images_is_reported(tmp_path):
    with WrittenBag(tmp_path / "a.bag") as bag:
        bag.info("/cam/camera_info", SMALL)
        for seconds in (0.0, 0.2, 0.1):
            bag.image("/cam/image_raw", flat(), seconds)
        bag.image("/cam/image_raw", flat(), 0.2, received=0.3)
        bag.image("/cam/image_raw", flat(), None, received=0.4)
        bag.image("/cam/image_raw", flat(), 0.5, data=b"short")
        bag.image("/cam/image_raw", flat(), 0.6, step=3)
        bag.image("/cam/image_raw", flat(), 0.7, "other")
        bag.image("/cam/image_raw", flat()[:40], 0.8)
    result = read_drive(tmp_path / "a.bag")
    assert [image.stamp for image in result.images] == [nanoseconds(t) for t in (0.0, 0.1, 0.2)]
    reasons = (
        "a step of 3 bytes is too short for 64 pixels",
        "its frame is 'other', the first one's 'camera'",
        "the image has 64 x 40 pixels, its calibration is for 64 x 48",
        "the image is cut short: 5 bytes of 3072",
        "the same stamp came before",
        "the stamp is zero",
    )
    lost = [each for each in result.warnings if each.startswith("/cam")]
    assert sorted(lost) == [f"/cam/image_raw: 1 of 9 messages were left out: {reason}" for reason in reasons]


@pytest.mark.slow
def test_other_processes_read_the_same(drives, seen, tmp_path):
    drive, frames = drives[0]
    for name in ("a.bag", "b.bag"):
        with WrittenBag(tmp_path / name) as bag:
            write_camera(bag, drive, frames, "front", "camera")
    paths = [tmp_path / name for name in ("a.bag", "b.bag", "absent.bag")]
    job = partial(read_drive, params=BagParams(mounts={"camera": TURNED}))
    *results, error = run_jobs(job, paths, jobs=2, return_errors=True)
    for result, path in zip(results, paths):
        here = job(path)
        assert_same(result.images, seen[0])
        assert (result.name, result.warnings, list(result.cameras)) == (here.name, (), list(here.cameras))
        np.testing.assert_array_equal(result.cameras["/front/image_raw"].T_base_camera, TURNED)
    assert isinstance(error.cause, BagError) and str(error) == str(error.cause)
    assert str(error).startswith(f"{paths[2]}: there is no such file")

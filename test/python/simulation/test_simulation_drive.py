# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

import sextant
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.motion import FigureEight, Motion
from sextant.simulation.room_markers import default_map

LENSES = {
    "ideal": {},
    "barrel": {"distortion": [-0.25, 0.08, 0.001, -0.002, 0.0]},
    "rational": {
        "distortion_model": "rational_polynomial",
        "distortion": [0.4, -0.1, 0.001, 0.001, 0.02, 0.7, -0.05, 0.01],
    },
    "fisheye": {
        "distortion_model": "equidistant",
        "distortion": [-0.02, 0.004, 0.001, 0.0],
        "horizontal_fov": 2.0,
        "width": 960,
        "height": 540,
    },
}


def images(frames, **params):
    return np.array([frame.image for frame in SimulatedDrive(DriveParams(**params)).frames(frames)])


def expected_corners(drive, frame):
    """Pixels (4, 2) by id of the markers that lie within the image and are seen from the front."""
    camera, corners = sextant.CameraModel(drive.calibration), {}
    for marker in drive.map.markers:
        T = np.linalg.inv(frame.T_map_base @ drive.T_base_camera) @ marker.T_map_marker
        half = 0.5 * marker.size
        square = [[-half, half, 0, 1], [half, half, 0, 1], [half, -half, 0, 1], [-half, -half, 0, 1]]
        points = (T @ np.transpose(square)).T[:, :3]
        if T[:3, 2] @ T[:3, 3] >= 0.0:
            continue
        pixels = [camera.project(point) for point in points]
        if all(
            p is not None and 10 < p[0] < camera.width - 10 and 10 < p[1] < camera.height - 10 for p in pixels
        ):
            corners[marker.id] = np.array(pixels)
    return corners


@pytest.mark.slow
@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("family", ["tag36h11", "DICT_4X4_50"])
def test_detectors_find_the_markers_where_the_truth_has_them(lens, family):
    drive = SimulatedDrive(DriveParams(obstacles=False, rate=1.0, **LENSES[lens]), default_map(family))
    params = sextant.DetectorParams()
    params.families = [family]
    detector = sextant.MarkerDetector(params)
    seen = found = 0
    errors = []
    for frame in drive.frames(20):
        truth = expected_corners(drive, frame)
        detections = {detection.id: detection.corners for detection in detector.detect(frame.image)}
        seen += len(truth)
        found += len(set(truth) & set(detections))
        errors += [detections[i] - truth[i] for i in set(truth) & set(detections)]
    assert seen > 20 and found > 0.9 * seen
    assert np.median(np.linalg.norm(errors, axis=2)) < 0.4  # pixels; the detectors' own tests are stricter


def test_same_seed_same_images():
    first = images(3, seed=1)
    np.testing.assert_array_equal(first, images(3, seed=1))
    assert np.mean(first != images(3, seed=2)) > 0.5


def test_exposure_smears_a_turning_camera():
    turning = Motion(0.0, 0.0, 0.0, 0.3, 0.0, 1.0)
    sharp, smeared = (
        SimulatedDrive(DriveParams(exposure_time=t, noise_sigma=0.0)).frame(turning).image
        for t in (0.0, 0.02)
    )
    edges = [np.mean(np.abs(np.diff(image.astype(float), axis=1))) for image in (sharp, smeared)]
    assert edges[1] < 0.8 * edges[0]
    assert abs(np.mean(sharp) - np.mean(smeared)) < 1.0


def test_a_map_of_ones_own_can_be_driven_through():
    marker_map = sextant.MarkerMap("hall")
    pose = sextant.pose_from_xyz_rpy([8.0, 0.0, 1.0], [0.5 * np.pi, 0.0, -0.5 * np.pi])
    marker_map.add(sextant.MappedMarker("tag25h9", 4, 0.4, pose))
    frame = SimulatedDrive(DriveParams(), marker_map).frame(Motion(x=6.0))
    params = sextant.DetectorParams()
    params.families = ["tag25h9"]
    assert [detection.id for detection in sextant.MarkerDetector(params).detect(frame.image)] == [4]


def test_path_through_the_wall_is_refused():
    with pytest.raises(ValueError, match="eight_half_length"):
        next(SimulatedDrive(DriveParams(eight=FigureEight(half_length=3.5))).frames(1))


@pytest.mark.parametrize(
    "name, value",
    [
        ("seed", -1),
        ("rate", 0.0),
        ("width", 0),
        ("horizontal_fov", 3.5),
        ("distortion_model", "none"),
        ("distortion", [0.1]),
        ("camera_xyz", [0.0, 0.0]),
        ("camera_rpy", [0.0, 0.0, float("nan")]),
        ("exposure_time", -1.0),
        ("supersampling", 0),
        ("blur_sigma", -1.0),
        ("noise_sigma", float("nan")),
        ("vignette", 2.0),
        ("white_level", 0.0),
        ("quiet_zone", 0.0),
        ("light_unevenness", 2.0),
        ("room_size", [30.0, 2.4]),
        ("room_size", [30.0, 0.0, 2.5]),
        ("robot_radius", -0.1),
    ],
)
def test_what_is_out_of_range_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=name if name != "distortion" else "D"):
        DriveParams(**{name: value})


def test_defaults_are_valid():
    DriveParams()

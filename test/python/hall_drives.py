# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of a robot that drives an eight in a hall with markers on the walls and pillars, and takes photos."""

import numpy as np
from landmark_bags import observation_message, observations_message, planar
from made_photos import picture
from simulated_observations import T_BASE_CAMERA, SimulatedCamera, wall_map
from written_bags import WrittenBag

from sextant.geometry.plane_poses import composed, in_frame, relative
from sextant.simulation.camera import camera_calibration
from sextant.simulation.motion import FigureEight

# Hz of odometry; one of so many readings with markers and pillars, and with a photo
RATE, SENSOR_EVERY, PHOTO_EVERY = 10, 2, 5
EIGHT = FigureEight(half_length=3.0, half_width=2.0, period=40.0)
WALLS = wall_map(
    [(5.0, y, 1.0, np.pi) for y in (-2.0, 0.0, 2.0)]
    + [(-5.0, y, 1.2, 0.0) for y in (-2.0, 0.0, 2.0)]
    + [(x, 4.0, 1.1, -np.pi / 2) for x in (-2.5, 2.5)]
    + [(x, -4.0, 0.9, np.pi / 2) for x in (-2.5, 2.5)]
)
PILLARS = np.array(
    [(4.2, 3.2), (4.5, 1.0), (4.1, -2.9), (2.2, -3.4), (0.3, 3.4), (-0.4, -3.3), (-2.0, 3.6), (-4.0, 3.0)]
    + [(-4.6, 0.8), (-4.3, -3.1), (0.2, 1.6), (-0.3, -1.7)]
)
CLASSES = [
    f"{name}_pillar" for name in "red blue green red yellow blue green yellow blue red white white".split()
]
REACH, HALF_VIEW = 5.0, 0.5  # metres, radians: of the detector of pillars
SIGMAS = np.array([0.03, 0.03])  # metres
PHOTO_SIZE, SAME_PLACE = (160, 120), 15  # pixels; readings of odometry at which the camera sees the same
PHOTO_CAMERA = camera_calibration(*PHOTO_SIZE)


def pose(seconds):
    """True pose (3,) in the frame of the hall."""
    motion = EIGHT.at(seconds)
    return np.array([motion.x, motion.y, motion.yaw])


def write_hall(path, seconds=40.0, seed=0, systems=("markers", "landmarks", "photos")):
    """Writes the drive; its odometry is 1 % long and turns a little."""
    rng, camera = np.random.default_rng(seed), SimulatedCamera("plumb_bob 4", seed=seed + 1)
    T_odom_base = np.zeros(3)
    with WrittenBag(path) as bag:
        bag.transforms([("base_link", "camera", T_BASE_CAMERA)])
        if "photos" in systems:
            bag.info("/front/camera_info", PHOTO_CAMERA)
        for number in range(int(seconds * RATE) + 1):
            at = number / RATE
            step = relative(pose(max(0.0, at - 1 / RATE)), pose(at)) * [1.01, 1.0, 1.005]
            T_odom_base = composed(T_odom_base, step)
            bag.odometry("/odom", planar(T_odom_base), at)
            for system in systems:
                WRITERS[system](bag, number, camera, rng)
    return str(path)


def _write_markers(bag, number, camera, rng):
    if number % SENSOR_EVERY == 0:
        T = planar(pose(number / RATE))
        seen = camera.view(T, camera.visible(T, WALLS)).detections
        bag.markers("/markers", seen, camera.calibration, number / RATE)


def _write_landmarks(bag, number, camera, rng):
    if number % SENSOR_EVERY == 0:
        at = number / RATE
        bag.write("/landmarks", observations_message(at, list(_seen(pose(at), rng))), at)


def _write_photo(bag, number, camera, rng):
    if number % PHOTO_EVERY == 0:
        bag.image("/front/image_raw", photo(number), number / RATE)


WRITERS = {"markers": _write_markers, "landmarks": _write_landmarks, "photos": _write_photo}


def _seen(at, rng):
    for pillar, name in zip(in_frame(at, PILLARS), CLASSES):
        if np.hypot(*pillar) < REACH and abs(np.arctan2(pillar[1], pillar[0])) < HALF_VIEW:
            yield observation_message(name, pillar + SIGMAS * rng.standard_normal(2), np.diag(SIGMAS**2))


def photo(number):
    """What the camera sees at a reading of odometry: something else at every place, the same in every lap."""
    return picture(number % round(EIGHT.period * RATE) // SAME_PLACE, PHOTO_SIZE)

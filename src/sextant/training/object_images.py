# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rendered images of balls and pillars with ground truth, to train and evaluate a detector's network."""

from typing import Callable, Iterable, List, NamedTuple, Sequence, Tuple

import numpy as np

import sextant
from sextant.detection_scores.average_precision import TrueObjects
from sextant.objects.object_kinds import BALL, KINDS
from sextant.simulation.arena_looks import random_light, random_paint
from sextant.simulation.ball_simulation import WALL, BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import TASKS, random_world
from sextant.simulation.camera import camera_calibration, camera_mount
from sextant.training.image_set import ObjectImage

CLASSES = list(KINDS)
WIDTH, HEIGHT = 640, 480  # pixels of the camera's image
# Minimum area and side of objects that count, pixels of the network's input: it cannot resolve smaller ones.
MIN_AREA, MIN_SIDE = 16.0, 4.0
MAX_CLUTTER = 12  # maximum number of objects in front of the camera
NEAR, FAR = 0.3, 6.0  # minimum and maximum distance of these objects to the camera, metres
ROOM = 5.0, 12.0  # minimum and maximum width and depth of the room, metres
CLEARANCE = 0.35  # minimum distance of the robot to walls and objects, metres
MIN_RADIUS, MAX_RADIUS = 0.03, 0.08  # of the objects in front of the camera, metres


def random_image(seed: int, size: int) -> ObjectImage:
    """Renders a world of the ball task if the seed is even, random clutter if it is odd.

    :param size: side of the network's input, pixels; objects that are too small in it do not count
    """
    return (clutter_image if seed % 2 else task_image)(seed, size)


def task_image(seed: int, size: int) -> ObjectImage:
    """Renders the view from a random pose in a world of the ball task, mostly toward the ball."""
    random = np.random.default_rng([seed, 21])
    world = random_world(sorted(TASKS)[seed // 2 % len(TASKS)], seed)
    occupied = np.array([*([each.x, each.y] for each in world.pillars), world.ball])
    at = _free_place(random, world.size, occupied)
    toward = world.ball - at if random.random() < 0.5 else occupied[random.integers(len(occupied))] - at
    yaw = np.arctan2(toward[1], toward[0]) + random.uniform(-0.6, 0.6)
    world = world._replace(robot=np.array([*at, yaw]))
    simulation = BallSimulation(world, BallSimulationParams(seed=seed))
    images = simulation.take_images()
    return ObjectImage(images.colour, truth_of(images.seen, simulation.class_names, size))


def clutter_image(seed: int, size: int) -> ObjectImage:
    """Renders objects of random size and colour with a random field of view, blur, noise and mount; some have
    no class."""
    random = np.random.default_rng([seed, 22])
    scene_params = sextant.ArenaSceneParams()
    scene_params.size, scene_params.seed = random.uniform(*ROOM, 2), seed
    scene_params.wall_height = WALL
    scene = sextant.ArenaScene(scene_params)
    clutter = random_clutter(random, scene_params.size, seed)
    scene.set_objects(clutter.objects)
    scene.set_light(random_light(random))
    image, seen = sextant.ArenaCamera(clutter.sensor, clutter.lens).take(scene, clutter.T_map_camera, 0)
    return ObjectImage(image, truth_of(seen, clutter.names, size))


class Clutter(NamedTuple):
    """Objects in front of a camera."""

    objects: List["sextant.ArenaObject"]  # in the map
    names: List[str]  # of their classes; empty: no class
    lens: "sextant.CameraModel"  # of a random field of view
    sensor: "sextant.ArenaCameraParams"  # of random blur, noise and gamma
    T_map_camera: np.ndarray  # (4, 4)


def random_clutter(
    random: np.random.Generator,
    room: np.ndarray,
    seed: int,
    paint: Callable[[str, np.random.Generator], np.ndarray] = random_paint,
) -> Clutter:
    """Objects of random size and colour in the view of a random camera.

    :param room: width and depth of the room (2,), metres
    :param seed: of the camera's noise
    :param paint: draws the reflectance of an object of a class
    """
    yaw, at = random.uniform(-np.pi, np.pi), _free_place(random, room, np.zeros((0, 2)))
    fov, high = random.uniform(0.7, 1.4), random.uniform(0.15, 0.6)
    places = random_places(random, MAX_CLUTTER, (at, yaw, fov), 0.5 * room - 0.1)
    objects, names = _cluttered(random, places, paint)
    model = sextant.CameraModel(camera_calibration(WIDTH, HEIGHT, fov))
    sensor = _sensor(random, seed)
    mount = camera_mount([*at, high], [random.normal(0.0, 0.02), random.uniform(0.0, 0.45), yaw])
    return Clutter(objects, names, model, sensor, mount)


def truth_of(seen: Iterable["sextant.VisibleObject"], names: Sequence[str], size: int) -> TrueObjects:
    """Ground truth of an image; objects without a class are left out.

    :param names: class names of the objects by index; empty: no class
    :param size: side of the network's input, pixels
    """
    scale = size / max(WIDTH, HEIGHT)
    rows = [(*each.low, *each.high, CLASSES.index(names[each.object]), each.pixels)
            for each in seen if names[each.object] in CLASSES]  # fmt: skip
    table = np.array(rows, float).reshape(-1, 6)
    sides = (table[:, 2:4] - table[:, :2]).min(axis=1, initial=np.inf)
    is_counted = (table[:, 5] * scale**2 >= MIN_AREA) & (sides * scale >= MIN_SIDE)
    return TrueObjects(table[:, :4], table[:, 4].astype(int), is_counted)


def _free_place(random: np.random.Generator, room: Sequence[float], occupied: np.ndarray) -> np.ndarray:
    """A random position (2,), metres, with CLEARANCE to walls and occupied positions (n, 2).

    :param room: width and depth of the room, metres
    """
    half = 0.5 * np.asarray(room) - CLEARANCE
    while True:
        at = random.uniform(-half, half)
        if np.all(np.linalg.norm(occupied - at, axis=1) > CLEARANCE):
            return at


def random_places(
    random: np.random.Generator, most: int, view: Tuple[np.ndarray, float, float], half: np.ndarray
) -> np.ndarray:
    """At most so many positions (n, 2) in and near the field of view inside the room, metres.

    :param view: position (2,) of the camera, its yaw and field of view, metres and radians
    :param half: half the width and depth of the part of the room with objects (2,), metres
    """
    at, yaw, fov = view
    places: List[np.ndarray] = []
    for _ in range(random.integers(0, most + 1)):
        distance = np.exp(random.uniform(np.log(NEAR), np.log(FAR)))
        turn = yaw + 0.6 * random.uniform(-fov, fov)
        place = at + distance * np.array([np.cos(turn), np.sin(turn)])
        # At least two of the largest radii apart, so that objects do not overlap.
        is_apart = all(np.linalg.norm(place - each) > 2.0 * MAX_RADIUS for each in places)
        if np.all(abs(place) < half) and is_apart:
            places.append(place)
    return np.array(places).reshape(-1, 2)


def _cluttered(
    random: np.random.Generator, places: np.ndarray, paint: Callable[[str, np.random.Generator], np.ndarray]
) -> Tuple[List["sextant.ArenaObject"], List[str]]:
    """Objects and their class names; an empty name: no class."""
    objects, names = [], []
    for place in places:
        name = CLASSES[random.choice(len(CLASSES), p=[0.4, 0.2, 0.2, 0.2])]
        is_ball = name == BALL
        each = sextant.ArenaObject()
        each.radius = random.uniform(MIN_RADIUS, MAX_RADIUS)
        each.height = random.uniform(0.2, 0.6)
        each.colour = np.clip(paint(name, random) * random.uniform(0.75, 1.3), 0.0, 1.0)
        # Objects without a class: the other shape in this class's paint (a yellow pillar, a red ball), half
        # of them grey.
        if random.random() < 0.12:
            is_ball = not is_ball
            name = ""
            if random.random() < 0.5:
                each.colour = np.clip(random.uniform(0.05, 0.9) + random.normal(0.0, 0.02, 3), 0.0, 1.0)
        if is_ball:
            each.shape = sextant.ArenaObject.Shape.ball
        each.position = np.array([*place, each.radius if is_ball else 0.0])
        objects.append(each)
        names.append(name)
    return objects, names


def _sensor(random: np.random.Generator, seed: int) -> "sextant.ArenaCameraParams":
    """Random blur, noise and gamma of a camera."""
    params = sextant.ArenaCameraParams()
    params.blur_sigma = random.uniform(0.3, 2.0)
    params.noise_sigma = random.uniform(0.0, 10.0)
    params.gamma = random.uniform(1.8, 2.6)
    params.seed = seed
    return params

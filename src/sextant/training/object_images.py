# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rendered images of balls and pillars with ground truth, to train and evaluate a detector's network."""

import functools
from typing import Iterable, List, NamedTuple, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.jobs import run_jobs
from sextant.detection_scores.average_precision import TrueObjects
from sextant.objects.letter_box import letter_box, letterboxed
from sextant.objects.object_kinds import BALL, KINDS
from sextant.simulation.ball_simulation import (
    WALL,
    BallSimulation,
    BallSimulationParams,
    random_light,
    random_paint,
)
from sextant.simulation.ball_world import TASKS, random_world
from sextant.simulation.camera import camera_calibration, camera_mount

CLASSES = list(KINDS)
WIDTH, HEIGHT = 640, 480  # pixels of the camera's image
# Minimum area and side of objects that count, pixels of the network's input: it cannot resolve smaller ones.
MIN_AREA, MIN_SIDE = 16.0, 4.0
MAX_CLUTTER = 12  # maximum number of objects in front of the camera
NEAR, FAR = 0.3, 6.0  # minimum and maximum distance of these objects to the camera, metres
CLEARANCE = 0.35  # minimum distance of the robot to walls and objects, metres
MIN_RADIUS, MAX_RADIUS = 0.03, 0.08  # of the objects in front of the camera, metres


class ObjectImage(NamedTuple):
    """An image and its ground truth."""

    image: np.ndarray  # uint8 (height, width, 3), RGB
    truth: TrueObjects  # boxes and classes


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
    scene_params.size, scene_params.seed = random.uniform(5.0, 12.0, 2), seed
    scene_params.wall_height = WALL
    scene, yaw = sextant.ArenaScene(scene_params), random.uniform(-np.pi, np.pi)
    at = _free_place(random, scene_params.size, np.zeros((0, 2)))
    fov, high = random.uniform(0.7, 1.4), random.uniform(0.15, 0.6)
    places = _places(random, at, yaw, fov, 0.5 * scene_params.size - 0.1)
    objects, names = _cluttered(random, places)
    scene.set_objects(objects)
    scene.set_light(random_light(random))
    calibration = camera_calibration(WIDTH, HEIGHT, fov)
    camera = sextant.ArenaCamera(_sensor(random, seed), sextant.CameraModel(calibration))
    mount = camera_mount([*at, high], [random.normal(0.0, 0.02), random.uniform(0.0, 0.45), yaw])
    image, seen = camera.take(scene, mount, 0)
    return ObjectImage(image, truth_of(seen, names, size))


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


def _places(
    random: np.random.Generator, at: np.ndarray, yaw: float, fov: float, half: np.ndarray
) -> np.ndarray:
    """Positions (n, 2) in and near the field of view inside the room.

    :param half: half the width and depth of the part of the room with objects (2,), metres
    """
    places: List[np.ndarray] = []
    for _ in range(random.integers(0, MAX_CLUTTER + 1)):
        distance = np.exp(random.uniform(np.log(NEAR), np.log(FAR)))
        turn = yaw + 0.6 * random.uniform(-fov, fov)
        place = at + distance * np.array([np.cos(turn), np.sin(turn)])
        # At least two of the largest radii apart, so that objects do not overlap.
        is_apart = all(np.linalg.norm(place - each) > 2.0 * MAX_RADIUS for each in places)
        if np.all(abs(place) < half) and is_apart:
            places.append(place)
    return np.array(places).reshape(-1, 2)


def _cluttered(
    random: np.random.Generator, places: np.ndarray
) -> Tuple[List["sextant.ArenaObject"], List[str]]:
    """Objects and their class names; an empty name: no class."""
    objects, names = [], []
    for place in places:
        name = CLASSES[random.choice(len(CLASSES), p=[0.4, 0.2, 0.2, 0.2])]
        is_ball = name == BALL
        each = sextant.ArenaObject()
        each.radius = random.uniform(MIN_RADIUS, MAX_RADIUS)
        each.height = random.uniform(0.2, 0.6)
        each.colour = np.clip(random_paint(name, random) * random.uniform(0.75, 1.3), 0.0, 1.0)
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


class ImageSet(NamedTuple):
    """Letterboxed images of one size with ground truth; most: the largest number of objects in an image."""

    images: np.ndarray  # uint8 (n, size, size, 3), RGB
    boxes: np.ndarray  # (n, most, 4) left, top, right, bottom, pixels
    classes: np.ndarray  # (n, most) int
    exists: np.ndarray  # (n, most) bool; False: padding
    is_counted: np.ndarray  # (n, most) bool, as TrueObjects.is_counted

    def truths(self) -> List[TrueObjects]:
        """Ground truth of each image."""
        return [
            TrueObjects(boxes[exists], classes[exists], is_counted[exists])
            for boxes, classes, exists, is_counted in zip(
                self.boxes, self.classes, self.exists, self.is_counted
            )
        ]


def image_set(seeds: Sequence[int], size: int, jobs: int, progress: str = "") -> ImageSet:
    """Renders the images of these seeds.

    :param size: side of the network's input, pixels
    :param jobs: number of parallel processes
    :param progress: title of the progress bar, as in run_jobs()
    """
    draw = functools.partial(_letterboxed_image, size=size)
    return stacked_images(list(run_jobs(draw, seeds, jobs, progress=progress)))


def stacked_images(images: Sequence[ObjectImage]) -> ImageSet:
    """A set of letterboxed images of the same size."""
    most = max([1, *(len(each.truth.classes) for each in images)])
    return ImageSet(
        images=np.array([each.image for each in images]),
        boxes=_filled([each.truth.boxes for each in images], most),
        classes=_filled([each.truth.classes for each in images], most),
        exists=_filled([np.ones(len(each.truth.classes), bool) for each in images], most),
        is_counted=_filled([each.truth.is_counted for each in images], most),
    )


def _letterboxed_image(seed: int, size: int) -> ObjectImage:
    image, truth = random_image(seed, size)
    box = letter_box((WIDTH, HEIGHT), (size, size))
    return ObjectImage(letterboxed(image, box, (size, size)), truth._replace(boxes=box.to_input(truth.boxes)))


def _filled(rows: Sequence[np.ndarray], most: int) -> np.ndarray:
    """Stacks rows to (n, most, ...), padded with zeros."""
    filled = np.zeros((len(rows), most, *rows[0].shape[1:]), rows[0].dtype)
    for i, row in enumerate(rows):
        filled[i, : len(row)] = row
    return filled

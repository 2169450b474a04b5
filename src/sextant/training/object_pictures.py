# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drawn pictures of balls and pillars and where these are in them, as a detector's network takes them."""

import functools
from typing import Iterable, List, NamedTuple, Sequence, Tuple

import numpy as np

import sextant
from sextant.base.jobs import run_jobs
from sextant.objects.letter_box import boxed, letter_box
from sextant.objects.object_kinds import BALL, KINDS
from sextant.simulation.ball_simulation import (
    WALL,
    BallSimulation,
    BallSimulationParams,
    drawn_light,
    drawn_paint,
)
from sextant.simulation.ball_world import TASKS, drawn_world
from sextant.simulation.camera import camera_calibration, camera_mount
from sextant.training.mean_precision import KnownObjects

CLASSES = list(KINDS)
WIDTH, HEIGHT = 640, 480  # pixels of what the camera takes
# What counts as seen, in pixels of the network's input: below, not even the nearest cell's box can fit.
LEAST_AREA, LEAST_SIDE = 16.0, 4.0
CLUTTER = 12  # objects before the camera, at most
NEAR, FAR = 0.3, 6.0  # metres, of these to the camera
ROOM = 0.35  # metres between robot and wall or pillar


class ObjectPicture(NamedTuple):
    """A picture and what is in it."""

    image: np.ndarray  # uint8 (height, width, 3), red first
    truth: KnownObjects

    def boxed(self, size: int) -> "ObjectPicture":
        """Letter-boxed. :param size: pixels a side"""
        taken, shape = (size, size), (self.image.shape[1], self.image.shape[0])
        box = letter_box(shape, taken)
        truth = self.truth._replace(boxes=box.to_input(self.truth.boxes))
        return ObjectPicture(boxed(self.image, box, taken), truth)


def drawn_picture(seed: int, size: int) -> ObjectPicture:
    """Of the ball task's worlds if the seed is even, of anything on a floor if it is odd.

    :param size: of the network's input, pixels a side: what would be too small in it does not count
    """
    return (clutter_picture if seed % 2 else task_picture)(seed, size)


def task_picture(seed: int, size: int) -> ObjectPicture:
    """What the robot sees from anywhere in a world of the ball task, most often toward the ball."""
    random = np.random.default_rng([seed, 21])
    world = drawn_world(sorted(TASKS)[seed // 2 % len(TASKS)], seed)
    taken = np.array([*([each.x, each.y] for each in world.pillars), world.ball])
    at = _free_place(random, world.size, taken)
    toward = world.ball - at if random.random() < 0.5 else taken[random.integers(len(taken))] - at
    yaw = np.arctan2(toward[1], toward[0]) + random.uniform(-0.6, 0.6)
    world = world._replace(robot=np.array([*at, yaw]))
    simulation = BallSimulation(world, BallSimulationParams(seed=seed))
    picture = simulation.take_picture()
    return ObjectPicture(picture.colour, truth_of(picture.seen, simulation.class_names, size))


def clutter_picture(seed: int, size: int) -> ObjectPicture:
    """Objects of many sizes and paints before a camera of any lens and mount; some are of no class."""
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
    scene.set_light(drawn_light(random))
    calibration = camera_calibration(WIDTH, HEIGHT, fov)
    camera = sextant.ArenaCamera(_lens(random, seed), sextant.CameraModel(calibration))
    mount = camera_mount([*at, high], [random.normal(0.0, 0.02), random.uniform(0.0, 0.45), yaw])
    image, seen = camera.take(scene, mount, 0)
    return ObjectPicture(image, truth_of(seen, names, size))


def truth_of(seen: Iterable["sextant.SeenObject"], names: Sequence[str], size: int) -> KnownObjects:
    """:param names: of the objects by index; what is of no class is left out

    :param size: of the network's input, pixels a side
    """
    scale = size / max(WIDTH, HEIGHT)
    rows = [(*each.low, *each.high, CLASSES.index(names[each.object]), each.pixels)
            for each in seen if names[each.object] in CLASSES]  # fmt: skip
    table = np.array(rows, float).reshape(-1, 6)
    sides = (table[:, 2:4] - table[:, :2]).min(axis=1, initial=np.inf)
    counts = (table[:, 5] * scale**2 >= LEAST_AREA) & (sides * scale >= LEAST_SIDE)
    return KnownObjects(table[:, :4], table[:, 4].astype(int), counts)


def _free_place(random: np.random.Generator, size: Sequence[float], taken: np.ndarray) -> np.ndarray:
    """(2,) that has room."""
    half = 0.5 * np.asarray(size) - ROOM
    while True:
        at = random.uniform(-half, half)
        if np.all(np.linalg.norm(taken - at, axis=1) > ROOM):
            return at


def _places(
    random: np.random.Generator, at: np.ndarray, yaw: float, fov: float, half: np.ndarray
) -> np.ndarray:
    """(n, 2) in the room before the camera, none nearer to another than two wide pillars."""
    places: List[np.ndarray] = []
    for _ in range(random.integers(0, CLUTTER + 1)):
        far = np.exp(random.uniform(np.log(NEAR), np.log(FAR)))
        turn = yaw + 0.6 * random.uniform(-fov, fov)
        place = at + far * np.array([np.cos(turn), np.sin(turn)])
        if np.all(abs(place) < half) and all(np.linalg.norm(place - each) > 0.16 for each in places):
            places.append(place)
    return np.array(places).reshape(-1, 2)


def _cluttered(
    random: np.random.Generator, places: np.ndarray
) -> Tuple[List["sextant.ArenaObject"], List[str]]:
    """Objects, and their names, empty where they are of no class."""
    objects, names = [], []
    for place in places:
        name = CLASSES[random.choice(len(CLASSES), p=[0.4, 0.2, 0.2, 0.2])]
        is_ball = name == BALL
        each = sextant.ArenaObject()
        each.radius = random.uniform(0.03, 0.08)
        each.height = random.uniform(0.2, 0.6)
        each.colour = np.clip(drawn_paint(name, random) * random.uniform(0.75, 1.3), 0.0, 1.0)
        if random.random() < 0.12:  # a yellow pillar is none, nor is a red ball, nor anything grey
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


def _lens(random: np.random.Generator, seed: int) -> "sextant.ArenaCameraParams":
    params = sextant.ArenaCameraParams()
    params.blur_sigma = random.uniform(0.3, 2.0)
    params.noise_sigma = random.uniform(0.0, 10.0)
    params.gamma = random.uniform(1.8, 2.6)
    params.seed = seed
    return params


class PictureSet(NamedTuple):
    """Letter-boxed pictures of one size."""

    images: np.ndarray  # uint8 (n, size, size, 3), red first
    boxes: np.ndarray  # (n, most, 4) corners, pixels
    classes: np.ndarray  # (n, most) int
    exists: np.ndarray  # (n, most) bool: the others only fill up
    counts: np.ndarray  # (n, most) bool

    def known(self) -> List[KnownObjects]:
        """Of each picture."""
        return [
            KnownObjects(boxes[exists], classes[exists], counts[exists])
            for boxes, classes, exists, counts in zip(*self[1:])
        ]


def picture_set(seeds: Sequence[int], size: int, jobs: int, progress: str = "") -> PictureSet:
    """Drawn pictures of these seeds.

    :param size: of the network's input, pixels a side
    :param jobs: processes at a time
    :param progress: as run_jobs() has it
    """
    drawn = list(run_jobs(functools.partial(_boxed_picture, size=size), seeds, jobs, progress=progress))
    most = max([1, *(len(each.truth.classes) for each in drawn)])
    return PictureSet(
        np.array([each.image for each in drawn]),
        *(_filled([each.truth[field] for each in drawn], most) for field in (0, 1)),
        _filled([np.ones(len(each.truth.classes), bool) for each in drawn], most),
        _filled([each.truth.counts for each in drawn], most),
    )


def _boxed_picture(seed: int, size: int) -> ObjectPicture:
    return drawn_picture(seed, size).boxed(size)


def _filled(rows: Sequence[np.ndarray], most: int) -> np.ndarray:
    """(n, most, ...) with zeros behind each."""
    filled = np.zeros((len(rows), most, *rows[0].shape[1:]), rows[0].dtype)
    for i, row in enumerate(rows):
        filled[i, : len(row)] = row
    return filled

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images with what makes real ones difficult: hard rooms, effects of a camera, photographs as backgrounds."""

from functools import lru_cache
from pathlib import Path
from typing import List, Sequence, Tuple

import cv2
import numpy as np

import sextant
from sextant.images.photo_file import find_photos, photo_size, read_rgb
from sextant.objects.object_kinds import BALL
from sextant.simulation.arena_looks import random_light, random_paint
from sextant.simulation.ball_simulation import WALL
from sextant.simulation.camera_effects import random_effects, with_effects
from sextant.simulation.hard_room import (
    GAMMA,
    dirty,
    furniture,
    hard_light,
    hard_scene,
    random_colour,
    stray_object,
)
from sextant.training.image_set import ObjectImage
from sextant.training.object_images import (
    FAR,
    HEIGHT,
    NEAR,
    ROOM,
    WIDTH,
    Clutter,
    random_clutter,
    truth_of,
)

BALL_GREEN = 0.30, 0.75  # minimum and maximum green reflectance of a ball: orange to yellow
STRAY, FURNITURE = 10, 5  # maximum number of objects without a class, and of pieces of furniture, in view
FURNITURE_NEAR = 1.0  # minimum distance of furniture to the camera, metres
ASIDE = 0.8  # maximum bearing of both, radians
MAX_BLUR = 14.0  # maximum motion of the image during its exposure, pixels
MIN_CROP = 0.4  # minimum part of a photo's smaller side in an image
EMPTY = 0.5  # fraction of the photos without any object
RECOLOURED = 0.5  # fraction of the photos with other hues: other things in the colours of the classes
MAX_SATURATION_FACTOR = 2.5  # of these; the minimum is its inverse
PAINTED, MOST_PAINTED = 0.5, 4  # fraction of the photos with painted surfaces; the largest number of these
PAINTED_HEIGHT = 0.15, 1.5  # of a painted surface, fraction of the image's height
PAINTED_WIDTH = 0.2, 1.5  # of a painted surface, fraction of its height: doors to walls
MAX_SLOPE = 0.4  # of its upper and lower edge, in perspective
HALL = np.array([2.2 * FAR, 2.2 * FAR])  # size of the room of objects in front of a photo, metres
EDGE = 0.7  # blur of the edge of an object in front of a photo, pixels


def hard_image(seed: int, size: int) -> ObjectImage:
    """As clutter_image(), with dirty objects in a hard room, and after CameraEffects."""
    random = np.random.default_rng([seed, 23])
    room = random.uniform(*ROOM, 2)
    scene = hard_scene(random, room, WALL)
    clutter = random_clutter(random, room, seed, wide_paint)
    objects = dirty(clutter.objects, random) + _others(random, clutter, room)
    scene.set_objects(objects)
    scene.set_light(hard_light(random))
    image, seen, _ = _without_faults(clutter, scene)
    names = clutter.names + [""] * (len(objects) - len(clutter.names))
    return ObjectImage(_as_taken(image, clutter.sensor, random), truth_of(seen, names, size))


class PhotoImages:
    """Images of photographs: EMPTY of them without objects, the others with rendered objects in front."""

    def __init__(self, folders: Sequence[Path]):
        """:param folders: chosen equally often, however many photos each has

        :raises OSError: a photo cannot be read
        :raises ValueError: there is no photo in a folder, or a file is not a photo
        """
        self._folders: List[List[Path]] = [find_photos(folder) for folder in folders]
        for folder, found in zip(folders, self._folders):
            if not found:
                raise ValueError(f"{folder}: there are no photos")
            for path in found:
                photo_size(path)

    def __call__(self, seed: int, size: int) -> ObjectImage:
        """Draws an image.

        :raises OSError: a photo cannot be read
        :raises ValueError: a photo is damaged
        """
        random = np.random.default_rng([seed, 24])
        paths = self._folders[random.integers(len(self._folders))]
        photo = _crop(read_rgb(paths[random.integers(len(paths))], HEIGHT), random)
        if random.random() < RECOLOURED:
            photo = recoloured(photo, random)
        if random.random() < PAINTED:
            photo = painted(photo, random)
        clutter = random_clutter(random, HALL, seed, wide_paint)
        if random.random() < EMPTY:
            return ObjectImage(_as_taken(photo, clutter.sensor, random), truth_of([], [], size))
        joined, seen = joined_with(photo, clutter, random)
        return ObjectImage(_as_taken(joined, clutter.sensor, random), truth_of(seen, clutter.names, size))


def recoloured(photo: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A photo with all hues shifted by one random angle, and the saturation multiplied by a random factor.

    :param photo: uint8 (rows, columns, 3), RGB
    """
    hue, saturation, value = cv2.split(cv2.cvtColor(photo.astype(np.float32) / 255.0, cv2.COLOR_RGB2HSV))
    hue = (hue + random.uniform(0.0, 360.0)) % 360.0
    saturation = np.minimum(saturation * MAX_SATURATION_FACTOR ** random.uniform(-1.0, 1.0), 1.0)
    changed = cv2.cvtColor(cv2.merge([hue, saturation, value]), cv2.COLOR_HSV2RGB)
    return np.clip(255.0 * changed + 0.5, 0.0, 255.0).astype(np.uint8)


def painted(photo: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A photo with upright surfaces, as of doors and walls, in random colours, often those of the classes.

    :param photo: uint8 (rows, columns, 3), RGB
    """
    rows, columns = photo.shape[:2]
    changed = photo.astype(np.float32)
    for _ in range(random.integers(1, MOST_PAINTED + 1)):
        height = rows * random.uniform(*PAINTED_HEIGHT)
        width = height * random.uniform(*PAINTED_WIDTH)
        x, y = random.uniform(-0.5 * width, columns - 0.5 * width), random.uniform(-0.5 * height, 0.8 * rows)
        rise, fall = width * random.uniform(-MAX_SLOPE, MAX_SLOPE, 2)
        corners = [[x, y], [x + width, y + rise], [x + width, y + height + fall], [x, y + height]]
        mask = cv2.fillConvexPoly(np.zeros((rows, columns), np.uint8), np.intp(corners).astype(np.int32), 1)
        mask = cv2.GaussianBlur(mask.astype(np.float32), (0, 0), EDGE)[..., np.newaxis]
        if mask.sum() < 1.0:
            continue
        light = changed.mean(axis=2, keepdims=True)
        # The surface's own light and shadow.
        shade = light / max(1.0, float((light * mask).sum() / mask.sum()))
        colour = 255.0 * random_colour(random) ** (1.0 / GAMMA) * random.uniform(0.5, 1.2)
        changed += mask * (np.clip(colour * shade, 0.0, 255.0) - changed)
    return (changed + 0.5).astype(np.uint8)


def joined_with(
    photo: np.ndarray, clutter: Clutter, random: np.random.Generator
) -> Tuple[np.ndarray, List["sextant.VisibleObject"]]:
    """A photo with objects in front of it, and the visible ones.

    :param photo: uint8 (HEIGHT, WIDTH, 3), RGB. :param random: of light and dirt
    """
    scene = _hall()
    scene.set_objects(dirty(clutter.objects, random))
    scene.set_light(random_light(random))
    image, seen, mask = _without_faults(clutter, scene)
    # Pixels of an object's edge also have light of the room behind it.
    share = cv2.GaussianBlur(cv2.erode(mask, np.ones((3, 3))), (0, 0), EDGE)[..., np.newaxis] / 255.0
    return (photo + share * (image.astype(float) - photo)).astype(np.uint8), seen


def wide_paint(class_name: str, random: np.random.Generator) -> np.ndarray:
    """As random_paint(), with balls from orange to yellow, and paler and darker paint."""
    paint = random_paint(class_name, random)
    if class_name == BALL:
        paint[1] = random.uniform(*BALL_GREEN)
    pale = 0.5 * random.beta(1.0, 4.0)
    return np.clip(
        (1.0 - pale) * paint * random.uniform(0.7, 1.2) + pale * random.uniform(0.2, 0.8), 0.0, 1.0
    )


@lru_cache(maxsize=1)
def _hall() -> "sextant.ArenaScene":
    params = sextant.ArenaSceneParams()
    params.size, params.wall_height = HALL, WALL
    return sextant.ArenaScene(params)


def _without_faults(
    clutter: Clutter, scene: "sextant.ArenaScene"
) -> Tuple[np.ndarray, List["sextant.VisibleObject"], np.ndarray]:
    """Image without blur and noise, visible objects, and their mask (HEIGHT, WIDTH)."""
    sensor = sextant.ArenaCameraParams()
    sensor.gamma, sensor.blur_sigma, sensor.noise_sigma = clutter.sensor.gamma, 0.0, 0.0
    camera = sextant.ArenaCamera(sensor, clutter.lens)
    image, seen = camera.take(scene, clutter.T_map_camera, 0)
    return image, seen, camera.mask()


def _others(random: np.random.Generator, clutter: Clutter, room: np.ndarray) -> List["sextant.ArenaObject"]:
    """Furniture and objects without a class in front of the camera."""
    at, ahead = clutter.T_map_camera[:2, 3], np.arctan2(*clutter.T_map_camera[[1, 0], 2])

    def places(most: int, near: float) -> List[np.ndarray]:
        number = random.integers(0, most + 1)
        turns = ahead + random.uniform(-ASIDE, ASIDE, number)
        away = random.uniform(near, FAR, number)[:, np.newaxis] * np.column_stack(
            [np.cos(turns), np.sin(turns)]
        )
        return [place for place in at + away if np.all(abs(place) < 0.5 * room - 0.1)]

    objects = [stray_object(random, place) for place in places(STRAY, NEAR)]
    return objects + [
        part for place in places(FURNITURE, FURNITURE_NEAR) for part in furniture(random, place)
    ]


def _as_taken(
    image: np.ndarray, sensor: "sextant.ArenaCameraParams", random: np.random.Generator
) -> np.ndarray:
    """An image after random effects of a camera."""
    length, turn = MAX_BLUR * random.beta(0.5, 3.0), random.uniform(0.0, np.pi)
    effects = random_effects(random)._replace(
        blur=(length * np.cos(turn), length * np.sin(turn)),
        defocus=sensor.blur_sigma,
        noise=sensor.noise_sigma,
    )
    return with_effects(image, effects, random)


def _crop(photo: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A random part of a photo, HEIGHT × WIDTH pixels."""
    rows, columns = photo.shape[:2]
    scale = min(rows / HEIGHT, columns / WIDTH) * random.uniform(MIN_CROP, 1.0)
    height, width = max(1, int(scale * HEIGHT)), max(1, int(scale * WIDTH))
    top, left = random.integers(rows - height + 1), random.integers(columns - width + 1)
    part = photo[top : top + height, left : left + width]
    part = part[:, ::-1] if random.random() < 0.5 else part
    return cv2.resize(
        part, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA if scale > 1.0 else cv2.INTER_LINEAR
    )

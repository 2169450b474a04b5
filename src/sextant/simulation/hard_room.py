# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rooms as robots meet them: patterned floors and walls, furniture, people, dirt, shadows, reflections
and objects without a class in the colours of the classes."""

from typing import Callable, List, Sequence, Tuple

import cv2
import numpy as np

import sextant
from sextant.objects.object_kinds import BALL
from sextant.simulation.arena_looks import COLOURS, random_light, random_paint

FLOOR, WALLS = 0, (1, 2, 3, 4)  # surfaces of sextant.ArenaScene
PATTERN, PATTERN_WIDTH = 256, (0.5, 4.0)  # side of a pattern, pixels; its width in the room, metres
PILLARS = [name for name in COLOURS if name != BALL]
CLASS_COLOUR = 0.4  # share of the colours that are those of a class
GAMMA = 2.2  # of a photo's grey levels

Objects = List["sextant.ArenaObject"]


def hard_scene(random: np.random.Generator, size: Sequence[float], wall: float) -> "sextant.ArenaScene":
    """A room with a glossy floor, and patterns on half of its surfaces.

    :param size: of the floor, metres. :param wall: height of the walls, metres
    """
    params = sextant.ArenaSceneParams()
    params.size, params.wall_height = np.array(size, float), wall
    params.seed = int(random.integers(2**31))
    params.gloss = float(random.choice([0.0, random.uniform(0.0, 1.0)]))
    scene = sextant.ArenaScene(params)
    for surface in (FLOOR, *WALLS):
        if random.random() < 0.5:
            scene.set_texture(surface, _pattern(random), random.uniform(*PATTERN_WIDTH))
    return scene


def hard_light(random: np.random.Generator) -> "sextant.ArenaLight":
    """As random_light(), with cast shadows, and more often with the colour of lamps."""
    light = random_light(random)
    light.direct = float(random.uniform(0.2, 0.8))
    light.shadows = float(random.uniform(0.3, 1.0))
    warmth, green = random.normal(0.0, 0.12), random.normal(0.0, 0.04)
    light.tint = np.exp([warmth, green, -warmth])
    return light


def furniture(random: np.random.Generator, place: np.ndarray) -> Objects:
    """A table, a chair, a cupboard, a bin or a person at a place (2,), metres."""
    makers = (_table, _chair, _cupboard, _bin, _person)
    return dirty(makers[random.integers(len(makers))](random, place), random)


def stray_object(
    random: np.random.Generator, place: np.ndarray, largest: float = np.inf
) -> "sextant.ArenaObject":
    """A small object of no class at a place (2,), metres: no ball in the ball's colour, and no upright one as
    slim as a pillar.

    :param largest: of an obstacle: maximum distance of its points from its axis, metres; inf: it may be flat
    """
    makers = (_parcel, _tin, _post, _other_ball, _flat)[: 5 if np.isinf(largest) else 4]
    each = makers[random.integers(len(makers))](random, place)
    if each.reach > largest:
        smaller = largest / each.reach
        each.sides, each.height = smaller * each.sides, smaller * each.height
        each.radius *= smaller
        if each.shape == sextant.ArenaObject.Shape.ball:
            each.position = np.array([*place, each.radius])
    return dirty([each], random)[0]


def dirty(objects: Objects, random: np.random.Generator) -> Objects:
    """The objects, with random dirt."""
    for each in objects:
        each.dirt = float(random.beta(1.0, 2.0))
    return objects


def random_colour(random: np.random.Generator) -> np.ndarray:
    """Reflectance (3,): that of a class, a grey or any other."""
    if random.random() < CLASS_COLOUR:
        return random_paint(list(COLOURS)[random.integers(len(COLOURS))], random)
    return _pale_colour(random) if random.random() < 0.4 else random.uniform(0.02, 0.9, 3)


def _pale_colour(random: np.random.Generator) -> np.ndarray:
    """Reflectance (3,): a grey with a tint."""
    return np.clip(random.uniform(0.03, 0.8) * np.exp(random.normal(0.0, 0.15, 3)), 0.0, 1.0)


def _flat(random: np.random.Generator, place: np.ndarray) -> "sextant.ArenaObject":
    """A sheet of paper, a mat, a book."""
    sides, height = random.uniform(0.05, 0.4, 2), random.uniform(0.001, 0.04)
    return _box(place, sides, height, random_colour(random), random)


def _parcel(random: np.random.Generator, place: np.ndarray) -> "sextant.ArenaObject":
    sides, height = random.uniform(0.1, 0.3, 2), random.uniform(0.05, 0.12)
    return _box(place, sides, height, random_colour(random), random)


def _tin(random: np.random.Generator, place: np.ndarray) -> "sextant.ArenaObject":
    return _pillar(place, random.uniform(0.035, 0.06), random.uniform(0.04, 0.06), random_colour(random))


def _post(random: np.random.Generator, place: np.ndarray) -> "sextant.ArenaObject":
    return _pillar(place, random.uniform(0.008, 0.015), 0.7, random_colour(random))


def _other_ball(random: np.random.Generator, place: np.ndarray) -> "sextant.ArenaObject":
    """In the colour of a pillar."""
    paint = random_paint(PILLARS[random.integers(len(PILLARS))], random)
    ball = _pillar(place, random.uniform(0.03, 0.12), 1.0, paint)
    ball.shape = sextant.ArenaObject.Shape.ball
    ball.position = np.array([*place, ball.radius])
    return ball


def _box(
    place: np.ndarray, sides: Sequence[float], height: float, colour: np.ndarray,
    random: np.random.Generator, bottom: float = 0.0,
) -> "sextant.ArenaObject":  # fmt: skip
    each = sextant.ArenaObject()
    each.shape, each.sides, each.height = sextant.ArenaObject.Shape.box, np.array(sides), height
    each.position, each.colour = np.array([*place, bottom]), colour
    each.yaw = random.uniform(0.0, np.pi)
    return each


def _pillar(place: np.ndarray, radius: float, height: float, colour: np.ndarray) -> "sextant.ArenaObject":
    each = sextant.ArenaObject()
    each.position, each.radius, each.height = np.array([*place, 0.0]), radius, height
    each.colour = colour
    return each


def _corners(place: np.ndarray, sides: np.ndarray, yaw: float) -> np.ndarray:
    """(4, 2) metres."""
    axis = np.array([np.cos(yaw), np.sin(yaw)])
    off = 0.5 * np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]]) * sides
    return place + off @ np.array([axis, [-axis[1], axis[0]]])


def _on_legs(random: np.random.Generator, place: np.ndarray, sides: np.ndarray, height: float) -> Objects:
    """A board on four legs."""
    board = _box(place, sides, 0.03, random_colour(random), random, height)
    radius, colour = random.uniform(0.008, 0.016), random_colour(random)
    legs = [_pillar(each, radius, height, colour) for each in _corners(place, 0.9 * sides, board.yaw)]
    return [board, *legs]


def _table(random: np.random.Generator, place: np.ndarray) -> Objects:
    return _on_legs(random, place, random.uniform([0.6, 0.5], [1.6, 0.9]), random.uniform(0.4, 0.75))


def _chair(random: np.random.Generator, place: np.ndarray) -> Objects:
    seat = _on_legs(random, place, random.uniform(0.35, 0.5, 2), random.uniform(0.4, 0.5))
    back = _box(place, [seat[0].sides[0], 0.03], 0.45, seat[0].colour, random, 0.45)
    axis = np.array([-np.sin(seat[0].yaw), np.cos(seat[0].yaw)])
    back.yaw = seat[0].yaw
    back.position = np.array([*(place + 0.5 * seat[0].sides[1] * axis), 0.45])
    return [*seat, back]


def _cupboard(random: np.random.Generator, place: np.ndarray) -> Objects:
    sides = random.uniform([0.3, 0.3], [1.2, 0.6])
    return [_box(place, sides, random.uniform(0.5, 2.0), random_colour(random), random)]


def _bin(random: np.random.Generator, place: np.ndarray) -> Objects:
    radius, height = random.uniform(0.12, 0.25), random.uniform(0.25, 0.6)
    return [_pillar(place, radius, height, _pale_colour(random))]


def _person(random: np.random.Generator, place: np.ndarray) -> Objects:
    """Shoes and legs up to the hips."""
    yaw, apart = random.uniform(-np.pi, np.pi), random.uniform(0.15, 0.5)
    ahead = np.array([np.cos(yaw), np.sin(yaw)])
    trousers, leather = _pale_colour(random), random_colour(random)
    parts: Objects = []
    for side in (-0.5, 0.5):
        foot = place + side * apart * np.array([-ahead[1], ahead[0]]) + random.normal(0.0, 0.05, 2)
        shoe = _box(foot + 0.06 * ahead, [0.28, 0.1], 0.08, leather, random)
        shoe.yaw = yaw
        parts += [shoe, _pillar(foot, random.uniform(0.06, 0.09), 0.85, trousers)]
    hips = _box(place, [0.22, 0.36], 0.9, random_colour(random), random, 0.85)
    hips.yaw = yaw
    return [*parts, hips]


def _pattern(random: np.random.Generator) -> np.ndarray:
    """Squares, stripes, a carpet or blots in two colours, uint8 (PATTERN, PATTERN, 3)."""
    painters: Tuple[Callable[[np.random.Generator], np.ndarray], ...] = (_squares, _stripes, _carpet, _blots)
    share = painters[random.integers(len(painters))](random)[..., np.newaxis]
    one, other = random_colour(random), random_colour(random)
    light = np.clip(one + share * (other - one) * random.uniform(0.2, 1.0), 0.0, 1.0)
    return (255.0 * light ** (1.0 / GAMMA)).astype(np.uint8)


def _squares(random: np.random.Generator) -> np.ndarray:
    cell = int(2 ** random.integers(3, 8))
    y, x = np.mgrid[:PATTERN, :PATTERN] // cell
    return ((x + y) % 2).astype(float)


def _stripes(random: np.random.Generator) -> np.ndarray:
    period = int(2 ** random.integers(3, 8))
    return np.broadcast_to(
        np.arange(PATTERN) % period < random.uniform(0.1, 0.9) * period, (PATTERN, PATTERN)
    ).astype(float)


def _carpet(random: np.random.Generator) -> np.ndarray:
    return random.random((PATTERN, PATTERN))


def _blots(random: np.random.Generator) -> np.ndarray:
    coarse = random.normal(0.5, 0.6, (int(random.integers(4, 24)),) * 2)
    return np.clip(cv2.resize(coarse, (PATTERN, PATTERN), interpolation=cv2.INTER_CUBIC), 0.0, 1.0)

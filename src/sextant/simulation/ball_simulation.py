# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulation of the ball task: a BallGround and the robot's camera images of it."""

from dataclasses import dataclass
from typing import Dict, List, Tuple

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.objects.object_kinds import BALL
from sextant.simulation.ball_ground import BallGround, BallParams, RobotParams
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.rgbd_camera import RgbdCamera, RgbdImages, RgbdParams

HEIGHT = 0.4  # of a pillar, metres
COLOURS: Dict[str, Tuple[float, float, float]] = {  # reflectance of red, green and blue
    BALL: (0.85, 0.62, 0.04),
    "blue_pillar": (0.04, 0.12, 0.55),
    "green_pillar": (0.05, 0.40, 0.10),
    "red_pillar": (0.62, 0.05, 0.05),
}
COLOUR_CHANGE = 0.15  # maximum relative deviation of an object's reflectance from that of its class
WALL = 2.5  # height of the walls, metres


@dataclass(frozen=True)
class BallSimulationParams(StrictParams):
    """Parameters of physics, light and cameras."""

    seed: int = param(0, "random seed of the world, its appearance and all noise", within(0, 2**31 - 1))
    flicker: float = param(0.15, "relative change of the light over time", within(0, 1))
    ball: BallParams = nested(BallParams, "ball_")
    drive: RobotParams = nested(RobotParams)
    camera: RgbdParams = nested(RgbdParams)


class BallSimulation:
    """A simulated world; images show its current state."""

    def __init__(self, world: BallWorld, params: BallSimulationParams):
        self.world = world
        self.ground = BallGround(
            world.size, world.pillars, world.ball, world.robot, params.ball, params.drive, params.seed
        )
        self.camera = RgbdCamera(params.camera, params.seed)
        self._params, self._random = params, np.random.default_rng([params.seed, 11])
        scene = sextant.ArenaSceneParams()
        scene.size, scene.wall_height, scene.seed = np.array(world.size, float), WALL, params.seed
        self._scene = sextant.ArenaScene(scene)
        self._objects = self._painted()
        self._light = random_light(self._random)
        self._brightness = self._light.brightness
        self._phases = self._random.uniform(0.0, 2.0 * np.pi, 2)
        self._frames = 0

    @property
    def class_names(self) -> List[str]:
        """Class names of the objects by index: the pillars, then the ball."""
        return [each.class_name for each in self.world.pillars] + [BALL]

    def take_images(self) -> RgbdImages:
        """Renders both images at the current time."""
        ground, robot = self.ground, self.ground.robot
        self._objects[-1].position = np.array([*ground.ball, ground.ball_params.radius])
        self._scene.set_objects(self._objects)
        waves = np.sin(2.0 * np.pi * ground.stamp / np.array([7.0, 31.0]) + self._phases)
        self._light.brightness = self._brightness * (1.0 + self._params.flicker * 0.5 * waves.sum())
        self._scene.set_light(self._light)
        self._frames += 1
        return self.camera.take(self._scene, robot.pose, self._frames)

    def _painted(self) -> List["sextant.ArenaObject"]:
        """Objects of the scene with random colours: the pillars, then the ball."""
        objects = []
        for pillar in self.world.pillars:
            each = sextant.ArenaObject()
            each.position = np.array([pillar.x, pillar.y, 0.0])
            each.radius, each.height = pillar.radius, HEIGHT
            objects.append(each)
        ball = sextant.ArenaObject()
        ball.shape, ball.radius = sextant.ArenaObject.Shape.ball, self.ground.ball_params.radius
        objects.append(ball)
        for each, name in zip(objects, self.class_names):
            each.colour = random_paint(name, self._random)
        return objects


def random_paint(class_name: str, random: np.random.Generator) -> np.ndarray:
    """Random reflectance (3,) of red, green and blue for an object of a class."""
    change = random.uniform(1.0 - COLOUR_CHANGE, 1.0 + COLOUR_CHANGE, 3)
    return np.clip(np.array(COLOURS[class_name]) * change, 0.0, 1.0)


def random_light(random: np.random.Generator) -> "sextant.ArenaLight":
    """Random light: dim to bright, with the colour of lamps to that of daylight."""
    light = sextant.ArenaLight()
    light.brightness = float(np.exp(random.uniform(np.log(0.45), np.log(1.4))))
    light.direct = float(random.uniform(0.2, 0.65))
    azimuth, height = random.uniform(-np.pi, np.pi), random.uniform(0.4, 1.4)
    light.toward = np.array([np.cos(azimuth), np.sin(azimuth), height])
    warmth = random.uniform(-0.12, 0.12)
    light.tint = np.array([1.0 + warmth, 1.0, 1.0 - warmth])
    return light

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulation of the ball task: a BallGround and the robot's camera images of it."""

from dataclasses import dataclass, replace
from typing import List

import numpy as np

import sextant
from sextant.base.strict_params import StrictParams, nested, param, within
from sextant.objects.object_kinds import BALL
from sextant.simulation.arena_looks import random_light, random_paint
from sextant.simulation.ball_ground import BallGround, BallParams, Pillar, RobotParams
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.camera_effects import random_effects, with_effects
from sextant.simulation.hard_room import dirty, hard_light, hard_scene, stray_object
from sextant.simulation.rgbd_camera import RgbdCamera, RgbdImages, RgbdParams

HEIGHT = 0.4  # of a pillar, metres
WALL = 2.5  # height of the walls, metres
STRAY = 0.06  # maximum radius of an obstacle without a class, metres
EXPOSURE = 0.01  # exposure time of an image in a hard room, seconds


@dataclass(frozen=True)
class BallSimulationParams(StrictParams):
    """Parameters of physics, light and cameras."""

    seed: int = param(0, "random seed of the world, its appearance and all noise", within(0, 2**31 - 1))
    flicker: float = param(0.15, "relative change of the light over time", within(0, 1))
    hard: bool = param(
        False, "patterned walls, a glossy floor, dirt, shadows, small obstacles and a poor colour camera"
    )
    ball: BallParams = nested(BallParams, "ball_")
    drive: RobotParams = nested(RobotParams)
    camera: RgbdParams = nested(RgbdParams)


class BallSimulation:
    """A simulated world; images show its current state."""

    def __init__(self, world: BallWorld, params: BallSimulationParams):
        self.world = world
        self._params, self._random = params, np.random.default_rng([params.seed, 11])
        # The noise of a poor camera follows its motion blur.
        camera = replace(params.camera, noise_sigma=0.0) if params.hard else params.camera
        self.camera = RgbdCamera(camera, params.seed)
        self._scene = self._room()
        self._objects = self._painted()
        self._light = hard_light(self._random) if params.hard else random_light(self._random)
        strays = [stray_object(self._random, at, STRAY) for at in world.strays]
        obstacles = [Pillar(*each.position[:2], each.reach, "") for each in strays]
        self.ground = BallGround(
            world.size, [*world.pillars, *obstacles], world.ball, world.robot, params.ball, params.drive,
            params.seed,
        )  # fmt: skip
        self._objects = (dirty(self._objects, self._random) if params.hard else self._objects) + strays
        self._brightness = self._light.brightness
        self._phases = self._random.uniform(0.0, 2.0 * np.pi, 2)
        self._effects = random_effects(self._random)._replace(noise=params.camera.noise_sigma)
        self._frames = 0

    @property
    def class_names(self) -> List[str]:
        """Class names of the objects by index: the pillars, then the ball."""
        return [each.class_name for each in self.world.pillars] + [BALL]

    def take_images(self) -> RgbdImages:
        """Renders both images at the current time."""
        ground, robot = self.ground, self.ground.robot
        self._objects[len(self.world.pillars)].position = np.array([*ground.ball, ground.ball_params.radius])
        self._scene.set_objects(self._objects)
        waves = np.sin(2.0 * np.pi * ground.stamp / np.array([7.0, 31.0]) + self._phases)
        self._light.brightness = self._brightness * (1.0 + self._params.flicker * 0.5 * waves.sum())
        self._scene.set_light(self._light)
        self._frames += 1
        images = self.camera.take(self._scene, robot.pose, self._frames)
        seen = [each for each in images.seen if each.object < len(self.class_names)]
        return images._replace(seen=seen, colour=self._as_taken(images.colour))

    def _as_taken(self, image: np.ndarray) -> np.ndarray:
        """An image by the colour camera of this world."""
        if not self._params.hard:
            return image
        # Far objects move across the image as the robot turns.
        blur = self.camera.colour.K[0, 0] * self.ground.robot.turn_rate * EXPOSURE
        random = np.random.default_rng([self._params.seed, 13, self._frames])
        return with_effects(image, self._effects._replace(blur=(blur, 0.0)), random)

    def _room(self) -> "sextant.ArenaScene":
        if self._params.hard:
            return hard_scene(self._random, self.world.size, WALL)
        scene = sextant.ArenaSceneParams()
        scene.size, scene.wall_height, scene.seed = np.array(self.world.size, float), WALL, self._params.seed
        return sextant.ArenaScene(scene)

    def _painted(self) -> List["sextant.ArenaObject"]:
        """Objects of the scene with random colours: the pillars, then the ball."""
        objects = []
        for pillar in self.world.pillars:
            each = sextant.ArenaObject()
            each.position = np.array([pillar.x, pillar.y, 0.0])
            each.radius, each.height = pillar.radius, HEIGHT
            objects.append(each)
        ball = sextant.ArenaObject()
        ball.shape, ball.radius = sextant.ArenaObject.Shape.ball, self._params.ball.radius
        objects.append(ball)
        for each, name in zip(objects, self.class_names):
            each.colour = random_paint(name, self._random)
        return objects

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy of located pillars and balls, and consistency of their covariances.

Images of many random worlds from random poses. The boxes are those of a detector, or the true boxes with
errors like those of a detector: up to three pixels or 6 % of the box on each side. The depth camera measures
1 m as 1/1.04 m. Errors are in % of the distance from the camera; NEES is divided by
its two degrees of freedom.
"""

from dataclasses import replace
from typing import Any, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np
from tables import Row, Table, Value

import sextant
from sextant.detection_scores.average_precision import MIN_OVERLAP, overlaps
from sextant.objects.object_kinds import BALL, KINDS
from sextant.objects.object_locator import ObjectLocator, ObjectLocatorParams
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import random_world
from sextant.simulation.rgbd_camera import RgbdParams

WORLDS, SHOTS, QUICK_WORLDS = 100, 6, 4
USUAL = RgbdParams()
FAULTY = RgbdParams(depth_noise=0.012, holes=0.2, bleeding=3)  # a poor depth camera
RANGES = ((0.5, 1.0), (1.0, 2.0), (2.0, 3.0), (0.5, 3.0))  # metres
ERROR, NEES = 3.0, (0.3, 1.3)  # % at the 95th percentile; bounds of the mean NEES over its dimension
COLUMNS = ["objects", "located, %", "error at 95 %, %", "median, %", "NEES"]


class Judged(NamedTuple):
    """Evaluation of one object in one image."""

    is_ball: bool
    distance: float  # metres
    error: float  # fraction of the distance; NaN: not located
    nees: float  # of the position, 2 degrees of freedom; NaN: not located


def place_tables(quick: bool, detector: Optional[Any] = None, camera: RgbdParams = USUAL) -> List[Table]:
    """One table.

    :param detector: a Detector; None: jittered true boxes
    """
    worlds = QUICK_WORLDS if quick else WORLDS
    judged = np.array(list(judged_objects(worlds, detector, camera)), float)
    boxes = "true boxes, jittered" if detector is None else "a detector's boxes"
    title = f"Places of objects: {worlds} worlds, {SHOTS} images each, {boxes}"
    if camera != USUAL:
        title += f"; depth noise {camera.depth_noise:g} m, {camera.holes:.0%} holes"
        title += f", edges bleed {camera.bleeding} px"
    rows = [_row(judged, False, each, quick) for each in RANGES] + [_row(judged, True, RANGES[-1], True)]
    return [Table(title, COLUMNS, rows)]


def _row(judged: np.ndarray, is_ball: bool, ranges: Tuple[float, float], quick: bool) -> Row:
    is_in = (judged[:, 0] == is_ball) & (judged[:, 1] >= ranges[0]) & (judged[:, 1] < ranges[1])
    located = is_in & ~np.isnan(judged[:, 2])
    errors = 100.0 * judged[located, 2]
    low, high = NEES if ranges == RANGES[-1] and not quick else (None, None)
    return f"{'ball' if is_ball else 'pillar'}, {ranges[0]:g} to {ranges[1]:g} m", [
        Value(is_in.sum(), 0),
        Value(100.0 * located.sum() / max(1, is_in.sum()), 1),
        Value(np.percentile(errors, 95) if len(errors) else np.nan, 2, at_most=None if quick else ERROR),
        Value(np.median(errors) if len(errors) else np.nan, 2),
        Value(judged[located, 3].mean() / 2 if len(errors) else np.nan, 2, at_least=low, at_most=high),
    ]


def judged_objects(worlds: int, detector: Optional[Any] = None, rgbd: RgbdParams = USUAL) -> Iterator[Judged]:
    """Evaluates all objects in the images."""
    for seed in range(worlds):
        simulation = BallSimulation(random_world(3, seed), BallSimulationParams(seed=seed, camera=rgbd))
        random = np.random.default_rng([seed, 3])
        camera = simulation.camera
        params = ObjectLocatorParams(depth_scale=1.04, depth_sigma=rgbd.depth_noise)
        T_colour_depth = np.linalg.inv(camera.T_base_colour) @ camera.T_base_depth
        models = map(sextant.CameraModel, (camera.colour, camera.depth))
        locator = ObjectLocator(params, *models, T_colour_depth)
        for _ in range(SHOTS):
            _go_anywhere(simulation, random)
            yield from _judged_picture(simulation, locator, detector, random)


def _go_anywhere(simulation: BallSimulation, random: np.random.Generator) -> None:
    """Moves the robot to a random pose from which a pillar or the ball is in the image."""
    ground = simulation.ground
    things = np.array([*([pillar.x, pillar.y] for pillar in ground.pillars), ground.ball])
    thing = things[-1] if random.random() < 0.3 else things[random.integers(len(things))]
    at = things[0]
    while np.linalg.norm(things - at, axis=1).min() < 0.35:
        at = random.uniform(-1.0, 1.0, 2) * (ground.half - 0.4)
    yaw = np.arctan2(*(thing - at)[::-1]) + random.uniform(-0.45, 0.45)
    ground.robot = replace(ground.robot, x=at[0], y=at[1], yaw=yaw)


def _judged_picture(
    simulation: BallSimulation, locator: ObjectLocator, detector: Optional[Any], random: np.random.Generator
) -> Iterator[Judged]:
    picture, camera = simulation.take_images(), simulation.camera
    names = [simulation.class_names[each.object] for each in picture.seen]
    true = np.array([[*each.low, *each.high] for each in picture.seen], float).reshape(-1, 4)
    boxes = jittered(true, random) if detector is None else _detected(detector, picture.colour, true, names)
    found = locator.locate(picture.depth, boxes, [KINDS[name] for name in names], camera.T_base_colour)
    T_base_map, eye = np.linalg.inv(simulation.ground.robot.pose), camera.T_base_colour[:2, 3]
    for seen, name, place in zip(picture.seen, names, found):
        at = simulation.ground.ball if name == BALL else simulation.ground.pillars[seen.object][:2]
        truth = (T_base_map @ [*at, 0.0, 1.0])[:2]
        distance = float(np.linalg.norm(truth - eye))
        if place is None:
            yield Judged(name == BALL, distance, np.nan, np.nan)
        else:
            error = place.position - truth
            nees = error @ np.linalg.solve(place.covariance, error)
            yield Judged(name == BALL, distance, float(np.linalg.norm(error)) / distance, float(nees))


def jittered(boxes: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Boxes (n, 4) with errors like a detector's on each side, clipped at the image's border."""
    size = np.tile(boxes[:, 2:] - boxes[:, :2], 2)
    largest = np.maximum(np.minimum(3.0, 0.25 * size), 0.06 * size)
    return np.clip(boxes + random.uniform(-1.0, 1.0, boxes.shape) * largest, 0.0, [640, 480, 640, 480])


def _detected(detector: Any, image: np.ndarray, true: np.ndarray, names: List[str]) -> np.ndarray:
    """Detected boxes (n, 4) of the true boxes; NaN if an object was not detected."""
    found, boxes = detector.detect(image), np.full_like(true, np.nan)
    for box, name in zip(found.boxes, (detector.classes[each] for each in found.classes)):
        shares = overlaps(box[np.newaxis], true)[0] * [name == other for other in names]
        if shares.max(initial=0.0) >= MIN_OVERLAP:
            boxes[int(np.argmax(shares))] = box
    return boxes

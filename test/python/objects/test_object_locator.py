# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from dataclasses import replace

import numpy as np
import pytest

import sextant
from sextant.objects.object_kinds import KINDS
from sextant.objects.object_locator import ObjectLocator, ObjectLocatorParams
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld
from sextant.simulation.rgbd_camera import RgbdParams

SCALE = 1.04
EXACT = RgbdParams(depth_noise=0.0, holes=0.0)


class Scene:
    """Pillars (x, y) and a ball in a room, before a camera, and their located positions."""

    def __init__(self, pillars, ball=(-2.0, 0.0), camera=EXACT):
        things = [Pillar(*each, 0.05, "red_pillar") for each in pillars]
        world = BallWorld((8.0, 6.0), things, np.array(ball), np.zeros(3))
        self.simulation = BallSimulation(world, BallSimulationParams(seed=1, camera=camera))
        self.truth = np.array([*pillars, ball], float)
        picture = self.simulation.take_images()
        self.depth, self.seen = picture.depth, {each.object: each for each in picture.seen}
        self.boxes = {key: np.array([*each.low, *each.high], float) for key, each in self.seen.items()}

    def locator(self, **settings):
        camera = self.simulation.camera
        models = map(sextant.CameraModel, (camera.colour, camera.depth))
        T = np.linalg.inv(camera.T_base_colour) @ camera.T_base_depth
        return ObjectLocator(ObjectLocatorParams(**{"depth_scale": SCALE, **settings}), *models, T)

    def located(self, number, box=None, depth=None, **settings):
        kind = KINDS["ball" if number == len(self.truth) - 1 else "red_pillar"]
        boxes = [self.boxes[number] if box is None else box]
        depth = self.depth if depth is None else depth
        T_base_colour = self.simulation.camera.T_base_colour
        return self.locator(**settings).locate(depth, np.array(boxes), [kind], T_base_colour)[0]

    def assert_located(self, number, share=0.01, **what):
        place = self.located(number, **what)
        off = place.position - self.truth[number]
        assert np.linalg.norm(off) < share * np.linalg.norm(self.truth[number])
        assert off @ np.linalg.solve(place.covariance, off) < 16.0
        return place


@pytest.mark.slow
@pytest.mark.parametrize("x, y", [(0.6, 0.0), (0.7, 0.2), (1.0, -0.35), (2.0, 0.8), (3.0, -1.0)])
def test_a_pillar_is_located_by_its_axis(x, y):
    Scene([(x, y)]).assert_located(0, 0.003)


@pytest.mark.parametrize("x, y", [(0.8, 0.0), (1.0, -0.3), (2.0, 0.6), (3.0, 0.0)])
def test_a_ball_is_located_by_its_centre(x, y):
    Scene([], (x, y)).assert_located(0, 0.004)


def test_the_depth_scale_is_applied():
    place = Scene([(2.0, 0.0)]).located(0, depth_scale=1.0)
    assert place.position[0] - 0.1 == pytest.approx((2.0 - 0.1) / SCALE, rel=0.01)


def test_inexact_boxes_have_little_effect():
    scene = Scene([(2.0, 0.5)])
    for shift in ([-4, 0, -2, 0], [3, -5, 5, 8], [-4, -10, 4, 10], [3, 6, -3, -6]):
        scene.assert_located(0, 0.012, box=scene.boxes[0] + shift)


def test_a_pillar_behind_another_and_one_behind_a_ball_are_located():
    scene = Scene([(1.2, 0.0), (2.2, -0.11)], (0.8, 0.0))
    assert 0.3 < (scene.boxes[1][2] - scene.boxes[1][0]) / 30.0 < 1.0  # half of it is seen
    for number in range(3):
        scene.assert_located(number, 0.015)


def test_a_pillar_cut_by_the_border_is_located_with_a_larger_covariance():
    whole, cut = Scene([(2.0, 0.8)]), Scene([(2.0, 1.01)])
    assert cut.boxes[0][0] == 0.0
    assert cut.assert_located(0, 0.015).covariance.trace() > whole.assert_located(0).covariance.trace()


@pytest.mark.parametrize("x, y", [(0.3, 0.03), (0.36, -0.05), (0.4, 0.0)])
def test_a_pillar_below_the_minimum_depth_is_located_by_its_width(x, y):
    scene = Scene([(x, y)])
    assert not np.any((scene.depth > 0) & (scene.depth < 0.28 / SCALE))
    scene.assert_located(0, 0.03)


def test_an_object_below_the_minimum_depth_is_not_confused_with_what_is_behind():
    scene = Scene([(0.3, 0.03)])
    cut = scene.boxes[0] * [0, 1, 1, 1]  # as if the border hid how wide it is
    assert scene.located(0, box=cut) is None


def test_without_depths_nothing_is_located():
    scene = Scene([(1.5, 0.0)])
    assert scene.located(0, depth=np.zeros_like(scene.depth)) is None
    assert scene.located(0, box=np.full(4, np.nan)) is None
    assert scene.located(0, box=np.array([300.0, 200.0, 301.0, 260.0])) is None
    assert scene.located(0, min_points=10000) is None


def test_a_position_that_is_not_certain_is_dropped():
    scene = Scene([(2.5, 0.3)])
    assert scene.located(0, max_sigma=0.05) is not None
    assert scene.located(0, max_sigma=0.001) is None


def test_one_object_in_two_boxes_is_located_once():
    scene = Scene([(1.5, 0.0)])
    boxes = np.array([scene.boxes[0] + [-20, 0, 20, 0], scene.boxes[0]])
    kinds = [KINDS["red_pillar"]] * 2
    found = scene.locator().locate(scene.depth, boxes, kinds, scene.simulation.camera.T_base_colour)
    assert [each is None for each in found] == [True, False]


def test_any_lens_and_any_mount_of_the_depth_camera_are_used():
    turned = replace(EXACT, baseline=0.06, depth_yaw=0.08, depth_fov=1.2, pitch=0.35, y=0.1)
    Scene([(1.5, 0.3)], camera=turned).assert_located(0, 0.004)


def test_the_covariance_grows_with_the_range():
    near, far = (Scene([(x, 0.0)]).located(0).covariance for x in (1.0, 3.0))
    assert far[0, 0] > 9.0 * near[0, 0]  # as noise of depth, with its square at least
    assert far[1, 1] > near[1, 1]


def test_a_depth_image_of_another_size_is_refused_with_both_sizes():
    scene = Scene([(1.5, 0.0)])
    with pytest.raises(ValueError, match="the depth image is 320×240, its camera_info has 640×480"):
        scene.located(0, depth=scene.depth[::2, ::2])


@pytest.mark.parametrize(
    "settings",
    [
        {"depth_scale": 3.0},
        {"min_points": 0},
        {"correlation_length": 0.5},
        {"max_sigma": -1.0},
        {"min_depth": 0.0},
    ],
)
def test_a_setting_out_of_range_is_named(settings):
    with pytest.raises(ValueError, match=f"{next(iter(settings))}: must be within .*, is"):
        ObjectLocatorParams(**settings)


@pytest.mark.slow
@pytest.mark.parametrize("x, slope", [(0.6, 0.65), (0.6, 0.66), (0.64, 0.64), (0.64, 0.65), (0.72, 0.63)])
def test_a_ball_whose_centre_the_border_cuts_is_located_correctly_or_not_at_all(x, slope):
    """What is left of it is lower than it: no ball that is farther, under the floor."""
    scene = Scene([], (x, (x - 0.1) * slope), RgbdParams())
    left, top, right, bottom = scene.boxes[0]
    assert left < 1.0 and right < 40.0
    for low in (0.0, 3.0, 6.0, 9.0):
        place = scene.located(0, box=np.array([left, top + low, right + 4.0, bottom - low]))
        assert place is None or np.linalg.norm(place.position - scene.truth[0]) < 0.06


@pytest.mark.parametrize(
    "aside, top, left", [(-0.99, 4, -6), (-0.99, 4, -3), (-1.005, 0, -3), (-1.005, 2, -3)]
)
def test_a_few_depths_of_what_stands_before_it_are_not_the_pillar(aside, top, left):
    """A pillar near by covers one side of another, the image's border the other side."""
    scene = Scene([(0.55, -0.16), (2.16, aside)], camera=RgbdParams())
    place = scene.located(1, box=scene.boxes[1] + [left, top, -3, -1])
    assert place is None or np.linalg.norm(place.position - scene.truth[1]) < 0.1

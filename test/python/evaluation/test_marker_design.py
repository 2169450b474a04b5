# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sweep, against geometry that is worked out by hand."""

import numpy as np
import pytest

from sextant.evaluation.marker_design import (
    Cell,
    DesignParams,
    Setup,
    camera_calibrations,
    cells,
    simulate_cell,
    simulate_design,
)
from sextant.simulation.camera import camera_calibration

SMALL = (320, 240)
NEAR = DesignParams(resolution=(SMALL,), size=(0.1,), in_view=(1,), distance=(0.5,), angle=(30.0,), images=4)


def simulated(size, in_view, distance, angle=0.0, setup=None, **params):
    setup = setup or Setup((640, 480), "tag36h11", 4.0, 200.0)
    params = DesignParams(resolution=(setup.resolution,), **{"images": 6, **params})
    cell = Cell(setup, size, in_view, distance, angle)
    return simulate_cell(params, camera_calibrations(params, None), cell)


def test_a_near_marker_is_located():
    found = simulated(0.2, 1, 1.0, 30.0)
    assert (found.images, found.detected, found.located) == (6, 1.0, 1.0)
    focal_length = 320.0 / np.tan(np.deg2rad(31.0))
    assert found.pixels == pytest.approx(0.2 * focal_length)
    assert found.median_error <= found.error < 0.005 and found.angle_error < 0.01 and found.cpu > 0.0


def test_a_marker_of_fewer_pixels_than_its_code_is_not_detected():
    found = simulated(0.05, 1, 6.0)  # 4.4 px, 10 modules
    assert (found.detected, found.located, found.error) == (0.0, 0.0, np.inf)


def test_two_markers_determine_the_pose_better_than_one():
    """Head-on, the lateral position from one marker follows from its perspective alone."""
    one, two = simulated(0.16, 1, 2.0), simulated(0.16, 2, 2.0)
    assert two.error < 0.3 * one.error


@pytest.mark.parametrize("distance, fits", [(0.9, False), (1.2, True)])
def test_markers_must_fit_into_the_image(distance, fits):
    """Two of 0.1 m, 1 m apart, span 1.13 m with their margins: 62 degrees see that from 0.94 m on."""
    found = simulated(0.1, 2, distance)
    assert (found.images > 0) == fits and np.isnan(found.error) != fits


def test_noise_and_darkness_make_it_worse():
    clean = simulated(0.1, 1, 1.5, 30.0, Setup((640, 480), "tag36h11", 1.0, 200.0), images=12)
    dark = simulated(0.1, 1, 1.5, 30.0, Setup((640, 480), "tag36h11", 8.0, 60.0), images=12)
    assert clean.error < 0.5 * dark.error


def test_all_combinations_are_simulated_once():
    params = DesignParams(family=("tag36h11", "DICT_APRILTAG_16h5"), noise=(1.0, 4.0), angle=(0.0,))
    every = list(cells(params, [(640, 480)]))
    assert len(every) == len(set(every)) == 2 * 2 * 5 * 2 * 8
    assert {cell.setup.family for cell in every} == {"tag36h11", "tag16h5"}


@pytest.mark.slow
def test_parallel_results_are_the_same():
    params = DesignParams(**{**vars(NEAR), "distance": (0.5, 1.0)})
    one, two = (simulate_design(params, jobs=jobs) for jobs in (1, 2))
    assert [each._replace(cpu=0.0) for each in one] == [each._replace(cpu=0.0) for each in two]


def test_camera_is_that_of_the_calibration():
    calibration = camera_calibration(320, 240, 1.0, "plumb_bob", [-0.3, 0.1, 0.0, 0.0, 0.0])
    (found,) = simulate_design(DesignParams(**{**vars(NEAR), "resolution": ()}), calibration)
    assert found.cell.setup.resolution == (320, 240) and found.located == 1.0
    assert found.pixels == pytest.approx(0.1 * calibration.K[0, 0] / 0.5) and found.error < 0.005


@pytest.mark.parametrize(
    "values, reason",
    [
        ({"size": (0.1, 0.0)}, "size: each must be within"),
        ({"angle": (90.0,)}, "angle: each must be within"),
        ({"distance": (float("nan"),)}, "distance: each must be within"),
        ({"resolution": ((640, 8),)}, "resolution: each each must be within"),
        ({"noise": (-1.0,)}, "noise_sigma"),
        ({"light": (0.0,)}, "white_level"),
        ({"family": ("tag99h1",)}, "unknown marker family 'tag99h1'"),
        ({"size": (0.9,)}, "spacing: markers of 0.9 m need at least 1.17 m"),
    ],
)
def test_what_cannot_be_simulated_is_refused(values, reason):
    with pytest.raises(ValueError, match=reason):
        DesignParams(**values)

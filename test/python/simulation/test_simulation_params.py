# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of what is simulated: which are refused."""

import math

import pytest

from sextant.simulation.ball_ground import BallParams, RobotParams
from sextant.simulation.ball_simulation import BallSimulationParams
from sextant.simulation.motion import FigureEight
from sextant.simulation.odometry import OdometryNoise
from sextant.simulation.rgbd_camera import RgbdParams

WRONG = {
    BallParams: {"radius": 0.0, "restitution": 1.1},
    RobotParams: {"acceleration": math.nan},
    OdometryNoise: {"angle_per_metre": -1.0},
    BallSimulationParams: {"seed": -1, "flicker": 1.5},
    FigureEight: {"half_length": 0.0, "half_width": 0.0, "period": 0.0},
    RgbdParams: {
        **{"width": 8, "height": 5000, "colour_fov": 3.1, "depth_fov": 0.0, "pitch": 2.0, "baseline": 2.0},
        **{"x": 11.0, "y": math.nan, "z": -11.0, "depth_yaw": 1.0},
        **{"noise_sigma": -1.0, "depth_noise": 2.0, "depth_scale": 0.0, "holes": 1.5},
    },
}


@pytest.mark.parametrize("cls", WRONG)
def test_what_is_out_of_range_is_refused_by_name(cls):
    for name, value in WRONG[cls].items():
        with pytest.raises(ValueError, match=f"^{name}: "):
            cls(**{name: value})

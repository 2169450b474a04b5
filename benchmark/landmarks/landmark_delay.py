# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Late observations, and those with a clock offset, through LandmarkTimeline.

The pose is compared at every odometry reading, ahead of the observations. The same drives are processed
without delay, with late observations at their own stamps, and with late observations at the stamps of their
arrival.

The clock offset is observable through the velocities that odometry measures. With the noise of wheel odometry
the velocities, the pose and so the offset have correlated errors of a few milliseconds.
"""

from typing import Any, List, NamedTuple, Optional, Tuple

import numpy as np
from tables import Row, Table, Value

import sextant
from landmarks.landmark_drives import EXACT, labelled, pose_error, rms, slam_params
from sextant.geometry.plane_poses import composed
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

RUNS, DURATION = 20, 120.0  # seconds
ODOMETRY, SPEED, TURN = 30.0, 0.5, 1.0  # Hz, m/s, rad/s
DELAY, OFFSET, CLOCK_SIGMA = 0.1, 0.05, 0.1  # seconds
MORE = 1.05  # times the RMSE without delay
NEAR, DEVIATIONS = 5.0, 3.0  # milliseconds, or standard deviations of the filter
GYROSCOPE = {"rotation_from_rotation": 0.01, "rotation_from_translation": 0.005}  # as of OdometryNoiseParams


class Drive(NamedTuple):
    """Errors of the pose at the stamps of odometry, and the estimated clock offset."""

    squares: np.ndarray  # of the position, square metres
    headings: np.ndarray  # radians
    offset: float  # seconds
    deviation: float


def delay_tables(quick: bool) -> List[Table]:
    """Two tables; a quick run is of few short drives, without bars."""
    runs, duration = (2, 10.0) if quick else (RUNS, DURATION)
    how = {"duration": duration, "odometry_rate": ODOMETRY, "speed": SPEED, "turn_rate": TURN}
    in_time = _drives(runs, how)
    late = {**how, "delay": DELAY}
    rows = [
        _row("no delay", in_time, in_time, None),
        _row("late, at their stamps", _drives(runs, late), in_time, None if quick else MORE),
        _row("late, at their arrival", _drives(runs, late, at_arrival=True), in_time, None),
    ]
    title = f"{runs} drives of {duration:g} s at {SPEED:g} m/s and up to {TURN:g} rad/s, observations"
    columns = ["position, cm", "of no delay", "heading, deg"]
    return [
        Table(f"{title} {1e3 * DELAY:g} ms late", columns, rows),
        _clock_table(f"{title} stamped {1e3 * OFFSET:g} ms early", runs, how, quick),
    ]


def _drives(runs: int, how: dict, **taken: Any) -> List[Drive]:
    """:param how: fields of LandmarkWorldParams. :param taken: of driven()"""
    return [driven(LandmarkWorldParams(seed=seed, **how), **taken) for seed in range(runs)]


def driven(params: LandmarkWorldParams, at_arrival: bool = False, clock_sigma: float = 0.0) -> Drive:
    """Runs one drive. :param clock_sigma: initial deviation of the clock offset, s; 0: not estimated"""
    world, slam = LandmarkWorld(params), slam_params(params)
    slam.filter.clock_sigma = clock_sigma
    timeline_params = sextant.LandmarkTimelineParams()
    timeline_params.odometry = params.odometry_noise()
    timeline = sextant.LandmarkTimeline(timeline_params, sextant.LandmarkSlam(slam, world.start, EXACT))
    T_odom_base, errors = np.zeros(3), []
    timeline.odometry(0.0, T_odom_base)
    for step in world.steps():
        T_odom_base = composed(T_odom_base, step.odometry_step)
        timeline.odometry(step.stamp, T_odom_base)
        if step.scan:
            stamp = step.stamp if at_arrival else step.scan.stamp
            timeline.observe(stamp, labelled(step.scan.observations))
        errors.append(pose_error(step.pose, timeline.now.pose))
    found = np.array(errors)
    known = timeline.slam.filter
    return Drive(np.sum(found[:, :2] ** 2, 1), found[:, 2], known.clock_offset, np.sqrt(known.clock_variance))


def _errors(drives: List[Drive]) -> Tuple[float, float]:
    """Mean over the drives of the RMSE of the position, cm, and of the heading, degrees."""
    positions = np.mean([100 * rms(drive.squares) for drive in drives])
    return float(positions), float(np.mean([np.degrees(rms(drive.headings**2)) for drive in drives]))


def _row(name: str, drives: List[Drive], others: List[Drive], most: Optional[float]) -> Row:
    position, heading = _errors(drives)
    return name, [
        Value(position, 2),
        Value(position / _errors(others)[0], 3, at_most=most),
        Value(heading, 3),
    ]


def _clock_table(title: str, runs: int, how: dict, quick: bool) -> Table:
    off = {**how, "clock_offset": OFFSET}
    with_gyroscope = _drives(runs, {**off, **GYROSCOPE}, clock_sigma=CLOCK_SIGMA)
    near = f"within {NEAR:g} ms or {DEVIATIONS:g} deviations, %"
    columns = ["offset, ms", "deviation, ms", "largest error, ms", near, "position, cm"]
    rows = [
        ("not estimated", ["-", "-", "-", "-", Value(_errors(_drives(runs, off))[0], 2)]),
        ("estimated", _clock_figures(_drives(runs, off, clock_sigma=CLOCK_SIGMA), None)),
        ("estimated, with a gyroscope", _clock_figures(with_gyroscope, None if quick else 100)),
    ]
    return Table(title, columns, rows)


def _clock_figures(drives: List[Drive], least: Optional[float]) -> List[Value]:
    errors = np.array([1e3 * (drive.offset - OFFSET) for drive in drives])  # milliseconds
    deviations = np.array([1e3 * drive.deviation for drive in drives])
    is_near = abs(errors) <= np.maximum(NEAR, DEVIATIONS * deviations)
    return [
        Value(1e3 * OFFSET + errors.mean(), 1),
        Value(deviations.mean(), 1),
        Value(abs(errors).max(), 1),
        Value(100 * is_near.mean(), 0, at_least=least),
        Value(_errors(drives)[0], 2),
    ]

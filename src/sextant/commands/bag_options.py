# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Options of the commands that read bags, and the reading of many of them."""

import argparse
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_params import BagParams
from sextant.base.jobs import JobError, run_jobs


def add_bag_options(group) -> None:
    """What is read of a bag."""
    group.add_argument("--images", nargs="+", default=[], metavar="TOPIC")
    group.add_argument(
        "--markers", nargs="+", default=[], metavar="TOPIC", help="recorded by marker_detector"
    )
    group.add_argument(
        "--calibrations", nargs="+", type=pair, default=[], metavar="TOPIC=FILE",
        help="in place of camera_info",
    )  # fmt: skip
    group.add_argument(
        "--rectified", nargs="+", default=[], metavar="TOPIC",
        help="of rectified images; those that are called image_rect... are so without being named",
    )  # fmt: skip
    group.add_argument("--every", type=int, default=1, metavar="N", help="only every n-th image")


def add_robot_options(group) -> None:
    """Where the cameras are on the robot, and where its wheels had it."""
    add_mount_options(group)
    group.add_argument(
        "--odometry", default="", metavar="TOPIC", help="default: the only one; none: not used"
    )


def add_mount_options(group) -> None:
    """Where the cameras are on the robot."""
    group.add_argument(
        "--mounts", nargs="+", type=pair, default=[], metavar="FRAME=X,Y,Z,ROLL,PITCH,YAW",
        help="of a camera's optical frame on the base, where the bag has no tf",
    )  # fmt: skip
    group.add_argument("--base-frame", default=BagParams.base_frame, help="default: %(default)s")


def add_job_options(group) -> None:
    """How many bags are read."""
    group.add_argument("--skip", action="store_true", help="go on without a bag that cannot be read")
    group.add_argument("--jobs", type=int, default=1, metavar="N", help="bags that are read at a time")
    group.add_argument(
        "--scheduler", default="", metavar="tcp://HOST:PORT", help="of a Dask cluster that reads"
    )


def pair(text: str) -> Tuple[str, str]:
    """:raises argparse.ArgumentTypeError: it is not NAME=VALUE."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text!r} is not NAME=VALUE")
    return name, value


def bag_params(options: argparse.Namespace, families: Sequence[str] = (), **others: Any) -> BagParams:
    """Of add_bag_options() and add_robot_options().

    :param families: empty: the detector's own
    :param others: more fields
    :raises ValueError: one that cannot be
    """
    given: Dict[str, Any] = {"families": tuple(families)} if families else {}
    return BagParams(
        images=tuple(options.images), markers=tuple(options.markers),
        calibrations=dict(options.calibrations), rectified=tuple(options.rectified), every=options.every,
        mounts=read_mounts(options.mounts), base_frame=options.base_frame, odometry=options.odometry,
        **given, **others,
    )  # fmt: skip


def read_mounts(pairs: Sequence[Tuple[str, str]]) -> Dict[str, np.ndarray]:
    """T_base_camera by frame, of --mounts. :raises ValueError: one is no pose"""
    return {frame: _mount(frame, text) for frame, text in pairs}


def _mount(frame: str, text: str) -> np.ndarray:
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 6:
        raise ValueError(f"--mounts {frame} is {text!r}, allowed are six numbers: x,y,z,roll,pitch,yaw")
    return sextant.pose_from_xyz_rpy(numbers[:3], numbers[3:])


def read_bags(
    read: Callable[[str], Any], bags: Sequence[str], options: argparse.Namespace
) -> Tuple[List[Tuple[str, Any]], List[str]]:
    """read(bag) of every bag, as add_job_options() has it.

    :param read: of a module, or functools.partial of one; what it returns has warnings
    :returns: (bag, result) of every bag, and what was noted on the way
    :raises JobError: a bag cannot be read, unless they are skipped
    :raises ValueError: none can
    """
    results = run_jobs(
        read, bags, options.jobs, options.scheduler, return_errors=options.skip, progress="bags"
    )
    good: List[Tuple[str, Any]] = []
    notes: List[str] = []
    for bag, result in zip(bags, results):
        if isinstance(result, JobError):
            notes.append(f"skipped: {result}")
            continue
        good.append((bag, result))
        notes += [f"{bag}: {warning}" for warning in result.warnings]
    if not good:
        raise ValueError("no bag could be read: " + "; ".join(notes))
    return good, notes

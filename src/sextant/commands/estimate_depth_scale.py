# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the factor that corrects a depth camera's depths, from distances measured with a tape.

A CSV file contains lines `measured, true`: the depth of a wall that the camera faces straight on, and the
distance from the camera to the wall, in metres. Or record the camera in front of the wall, one bag for each
distance. The result is the parameter `depth_scale` of object_locator and ball_task.
"""

import argparse
from pathlib import Path
from typing import List, Optional

from sextant.bags.measured_depth import middle_depth
from sextant.commands.command_line import Answer, CommandParser, run
from sextant.objects.depth_scale import (
    DepthScale,
    DepthScaleParams,
    MeasuredDepth,
    estimate_depth_scale,
    read_measured_depths,
)

_EXAMPLES = """\
examples:
  estimate_depth_scale distances.csv
  estimate_depth_scale --bag near.bag --distance 0.8 --bag far.bag --distance 2.4 \\
      --depth /camera/depth/image_rect_raw
"""


def main(arguments: Optional[List[str]] = None) -> int:
    """Run the command. :returns: exit code: 0, or 2 for invalid input"""
    return run(_parser(), arguments, _estimate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="estimate_depth_scale", description=__doc__, epilog=_EXAMPLES)
    add, params = parser.add_argument, DepthScaleParams()
    add("csv", type=Path, nargs="*", help="file with lines 'measured, true', metres")
    add("--bag", action="append", default=[], help="recording of a wall; repeat with a --distance for each")
    add(
        "--distance",
        type=float,
        action="append",
        default=[],
        metavar="METRES",
        help="to the wall, by the tape",
    )
    add("--depth", default="", metavar="TOPIC", help="depth images (default: the only topic of this type)")
    add(
        "--share",
        type=float,
        default=0.1,
        help="fraction of the image's sides, around its centre (default: %(default)s)",
    )
    for name, what in (("depth", "a depth at 1 m, growing with its square"), ("tape", "a measured distance")):
        default = getattr(params, f"{name}_sigma")
        text = f"standard deviation of {what}, metres (default: %(default)s)"
        add(f"--{name}-sigma", type=float, default=default, help=text)
    return parser


def _estimate(options: argparse.Namespace) -> Answer:
    params = DepthScaleParams(options.depth_sigma, options.tape_sigma)
    measured = _measured(options)
    found = estimate_depth_scale(measured, params)
    return Answer(_lines(measured, found))


def _measured(options: argparse.Namespace) -> List[MeasuredDepth]:
    if len(options.bag) != len(options.distance):
        raise ValueError(f"there are {len(options.bag)} --bag and {len(options.distance)} --distance")
    if not options.csv and not options.bag:
        raise ValueError("no distances: give a CSV file or --bag and --distance")
    for distance in options.distance:
        if not 0.0 < distance <= 100.0:
            raise ValueError(f"--distance is {distance}, must be within (0, 100] metres")
    measured = [each for path in options.csv for each in read_measured_depths(path)]
    for bag, distance in zip(options.bag, options.distance):
        measured.append(MeasuredDepth(middle_depth(bag, options.depth, options.share), distance))
    return measured


def _lines(measured: List[MeasuredDepth], found: DepthScale) -> List[str]:
    lines = ["measured       true   true - scale * measured   expected"]
    for each, residual, sigma in zip(measured, found.residuals, found.sigmas):
        lines.append(
            f"{each.measured:6.3f} m   {each.true:6.3f} m   "
            f"{1e3 * residual:+21.1f} mm   {1e3 * sigma:5.1f} mm"
        )
    lines += ["", f"scale: {found.scale:.4f} ± {found.deviation:.4f}"]
    return lines + [f"WARNING: {warning}" for warning in found.warnings]

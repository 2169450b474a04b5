# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells by what a depth camera's depths have to be multiplied, from distances measured with a tape.

A CSV file has lines `told, true`: the depth that the camera told of a wall that it looks at straight on, and
the distance from the camera to that wall, in metres. Or the camera is recorded before the wall, a bag for
each distance. The scale is the parameter `scale` of object_locator.
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
    """:returns: exit code: 0 estimated, 2 bad input."""
    return run(_parser(), arguments, _estimate)


def _parser() -> CommandParser:
    parser = CommandParser(prog="estimate_depth_scale", description=__doc__, epilog=_EXAMPLES)
    params = DepthScaleParams()
    parser.add_argument("csv", type=Path, nargs="*", help="file of lines 'told, true', metres")
    parser.add_argument(
        "--bag", action="append", default=[], help="recording of a wall; each with a --distance"
    )
    parser.add_argument(
        "--distance",
        type=float,
        action="append",
        default=[],
        metavar="METRES",
        help="to the wall, by the tape",
    )
    parser.add_argument(
        "--depth", default="", metavar="TOPIC", help="of depth images (default: the only one)"
    )
    parser.add_argument(
        "--share",
        type=float,
        default=0.1,
        help="of the image's sides, about its middle (default: %(default)s)",
    )
    for name, what in (("range", "a depth at 1 m, growing with its square"), ("tape", "a taped distance")):
        default = getattr(params, f"{name}_sigma")
        text = f"deviation of {what}, metres (default: %(default)s)"
        parser.add_argument(f"--{name}-sigma", type=float, default=default, help=text)
    return parser


def _estimate(options: argparse.Namespace) -> Answer:
    params = DepthScaleParams(options.range_sigma, options.tape_sigma)
    measured = _measured(options)
    found = estimate_depth_scale(measured, params)
    return Answer(_lines(measured, found))


def _measured(options: argparse.Namespace) -> List[MeasuredDepth]:
    if len(options.bag) != len(options.distance):
        raise ValueError(f"there are {len(options.bag)} --bag and {len(options.distance)} --distance")
    if not options.csv and not options.bag:
        raise ValueError("which distances? Name a CSV file or --bag and --distance")
    for distance in options.distance:
        if not 0.0 < distance <= 100.0:
            raise ValueError(f"--distance is {distance}, allowed is (0, 100] metres")
    measured = [each for path in options.csv for each in read_measured_depths(path)]
    for bag, distance in zip(options.bag, options.distance):
        measured.append(MeasuredDepth(middle_depth(bag, options.depth, options.share), distance))
    return measured


def _lines(measured: List[MeasuredDepth], found: DepthScale) -> List[str]:
    lines = ["    told       true   true - scale * told   expected"]
    for each, residual, sigma in zip(measured, found.residuals, found.sigmas):
        lines.append(
            f"{each.told:6.3f} m   {each.true:6.3f} m   {1e3 * residual:+16.1f} mm   {1e3 * sigma:5.1f} mm"
        )
    lines += ["", f"scale: {found.scale:.4f} ± {found.deviation:.4f}"]
    return lines + [f"WARNING: {doubt}" for doubt in found.doubts]

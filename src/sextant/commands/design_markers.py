# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulates a camera in front of markers, to choose their size and number.

All combinations of distance, angle, size, number in view, resolution, family, noise and light are simulated:
images are rendered, the markers detected, the camera located, and its position compared with the truth. Every
image is located on its own. Exit code: 0 the target is reached, 1 not with these markers, 2 invalid input.
"""

import argparse
import dataclasses
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from sextant.base.atomic_file import atomic_files
from sextant.calibration.calibration_file import read_calibration
from sextant.commands.command_line import Answer, CommandParser, check_output, run, whole_pair
from sextant.evaluation.marker_design import (
    CellResult,
    DesignParams,
    Resolution,
    Setup,
    Target,
    camera_calibrations,
    simulate_design,
)
from sextant.evaluation.marker_design_plots import plot_conditions, plot_setup
from sextant.evaluation.marker_design_report import (
    answer,
    choices,
    describe,
    range_table,
    write_table,
)

_EXAMPLES = """\
examples:
  design_markers --calibration camera.yaml
  design_markers --calibration camera.yaml --target 0.02 4 --size 0.16 0.25 0.4 --in-view 2 3 --jobs 2
  design_markers --resolution 640x480 1280x720 --fov 90 --noise 2 8 --light 60 200 --images 10
"""
_LISTS = ("size", "in_view", "distance", "angle", "family", "noise", "light")
_NUMBERS = ("images", "spacing", "seed")


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command.

    :returns: exit code: 0 the target is reached, 1 not with these markers, 2 invalid input
    """
    return run(_parser(), arguments, _design)


def _parser() -> CommandParser:
    parser = CommandParser(prog="design_markers", description=__doc__, epilog=_EXAMPLES)
    add, default = parser.add_argument, "default: %(default)s"
    add("--calibration", type=Path, metavar="FILE", help="YAML file of camera_calibration")
    add(
        "--fov",
        type=float,
        default=DesignParams.fov,
        metavar="DEGREES",
        help=f"{_described('fov')} ({default})",
    )
    add(
        "--resolution", type=_resolution, nargs="+", default=[], metavar="WIDTHxHEIGHT",
        help="image sizes (default: that of the calibration, or 640x480)",
    )  # fmt: skip
    for name in _LISTS:
        values = getattr(DesignParams(), name)
        text = f"{_described(name)} (default: {' '.join(map(str, values))})"
        option = f"--{name.replace('_', '-')}"
        add(option, type=type(values[0]), nargs="+", default=values, metavar="X", help=text)
    for name in _NUMBERS:
        value = getattr(DesignParams, name)
        text = f"{_described(name)} ({default})"
        add(f"--{name}", type=type(value), default=value, metavar="N", help=text)
    add(
        "--target", type=float, nargs=2, default=(0.02, 2.0), metavar=("ERROR", "DISTANCE"),
        help="position error that 95 %% of the poses must not exceed, and up to which distance, metres"
        " (default: 0.02 2)",
    )  # fmt: skip
    add("--jobs", type=int, default=1, metavar="N", help="number of parallel processes")
    add(
        "-o", "--output", type=Path, default=Path("design"), metavar="NAME",
        help="prefix of the files to write: table and heat maps (default: %(default)s)",
    )  # fmt: skip
    add("--force", action="store_true", help="overwrite existing files")
    return parser


def _described(name: str) -> str:
    """Returns the description of a field of DesignParams with its unit."""
    metadata = next(each for each in dataclasses.fields(DesignParams) if each.name == name).metadata
    return ", ".join(filter(None, [metadata["what"], metadata["unit"]])).replace("%", "%%")


def _resolution(text: str) -> Resolution:
    return whole_pair(text, "WIDTHxHEIGHT, e.g. 640x480")


def _design(options: argparse.Namespace) -> Answer:
    target = Target(*options.target)
    calibration = None if options.calibration is None else read_calibration(options.calibration)
    params = _params(options, target)
    calibrations = camera_calibrations(params, calibration)
    setups = params.setups(list(calibrations))
    names = {setup: describe(setup, calibrations[setup.resolution].K[0, 0]) for setup in setups}
    files = _Files.named(options.output, setups)
    for path in (files.table, *files.plots()):
        check_output(path, options.force)
    results = simulate_design(params, calibration, options.jobs)
    _write(files, results, names, target)
    camera = str(options.calibration or f"a field of view of {params.fov:g} degrees")
    answered = _answer(results, names, camera, target)
    plots = ", ".join(map(str, files.plots()))
    written = ["", f"{files.table}: all combinations", f"{plots}: heat maps"]
    return answered._replace(lines=answered.lines + written)


def _answer(results: List[CellResult], names: Dict[Setup, str], camera: str, target: Target) -> Answer:
    """Returns the tables and the smallest markers that reach the target."""
    lines: List[str] = []
    for setup, name in names.items():
        lines += [*range_table(results, setup, name, target), ""]
    chosen = choices(results, target)
    lines += [answer(each, key, camera, target) for key, each in chosen.items()]
    is_reached = any(choice.size for each in chosen.values() for choice in each)
    return Answer(lines, 0 if is_reached else 1)


def _params(options: argparse.Namespace, target: Target) -> DesignParams:
    """:raises ValueError: an option is not allowed"""
    if options.calibration is not None and options.fov != DesignParams.fov:
        raise ValueError("--fov has no effect with --calibration")
    if not target.error > 0.0:
        raise ValueError(f"--target: the error must be above 0 m, is {target.error:g}")
    options.distance = [*options.distance, target.distance]
    lists = {name: tuple(sorted(set(getattr(options, name)))) for name in ("resolution", *_LISTS)}
    lists["family"] = tuple(dict.fromkeys(options.family))
    return DesignParams(**lists, **{name: getattr(options, name) for name in ("fov", *_NUMBERS)})


class _Files(NamedTuple):
    table: Path  # CSV
    setups: Dict[Setup, Path]  # heat maps of each setup
    conditions: Dict[Tuple[Resolution, str], Path]  # by resolution and family; only for several conditions

    def plots(self) -> List[Path]:
        """Returns the PNG files."""
        return [*self.setups.values(), *self.conditions.values()]

    @classmethod
    def named(cls, name: Path, setups: Sequence[Setup]) -> "_Files":
        """Returns the files with a common prefix, e.g. design.csv and design.png."""
        if name.name in ("", "..") or str(name).endswith("."):
            raise ValueError(f"--output {name}: is not a prefix of file names")
        if len(setups) == 1:
            return cls(_ending(name, ".csv"), {setups[0]: _ending(name, ".png")}, {})
        plots, conditions = {}, {}
        for setup in setups:
            (width, height), family, noise, light = setup
            camera = f"_{width}x{height}_{family}"
            plots[setup] = _ending(name, f"{camera}_noise{noise:g}_light{light:g}.png")
            conditions[setup[:2]] = _ending(name, f"{camera}_conditions.png")
        several = len(plots) > len(conditions)
        return cls(_ending(name, ".csv"), plots, conditions if several else {})


def _ending(name: Path, ending: str) -> Path:
    return name.with_name(name.name + ending)


def _write(files: _Files, results: List[CellResult], names: Dict[Setup, str], target: Target) -> None:
    with atomic_files(files.table.parent) as folder:
        write_table(folder / files.table.name, results)
        for setup, path in files.setups.items():
            plot_setup(folder / path.name, results, setup, names[setup], target)
        for (resolution, family), path in files.conditions.items():
            own = [each for each in results if each.cell.setup[:2] == (resolution, family)]
            where = f"{resolution[0]} x {resolution[1]}, {family}, {target.distance:g} m"
            title = f"95 % position error, cm, worst of all angles: {where}"
            plot_conditions(folder / path.name, own, title, target)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overview pictures: drawn from where photos were taken, or taken from a map_server YAML."""

import math
from pathlib import Path
from typing import Any, List, NamedTuple, Sequence, Tuple

import matplotlib
import numpy as np
import yaml
from PIL import Image, ImageDraw, ImageFont

from sextant.place_maps.photo_file import photo_size
from sextant.place_maps.place_map import MetricFrame, Overview

LARGEST_SIDE = 2000  # pixels of a drawn overview
PAPER, LINES, PATH, WORDS = "#fbfaf7", "#e2ded4", "#b9c7d6", "#8a857a"
SLIMMEST = 0.25  # shorter side of a sheet of paths, of the longer one
LETTERS = 30  # pixels high
GRID_LINES = 12  # at most, across the longer side


class Drawing(NamedTuple):
    """A drawn overview and how large its pixels are."""

    image: Image.Image
    metres_a_pixel: float


def draw_overview(paths: Sequence[np.ndarray], width: float, height: float) -> Drawing:
    """A sheet with a grid in metres and the paths that were walked.

    :param paths: each (n, 2), metres from the left and from the top edge
    :param width: height: metres of the sheet
    :raises ValueError: it has no extent
    """
    if not (width > 0 and height > 0 and math.isfinite(width * height)):
        raise ValueError(f"an overview of {width:g} x {height:g} m cannot be drawn")
    scale = LARGEST_SIDE / max(width, height)  # pixels a metre
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    image = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(image)
    step = grid_step(max(width, height))
    for i in range(1, math.ceil(max(width, height) / step)):
        at = i * step * scale
        draw.line([(at, 0), (at, size[1])], LINES, 2)
        draw.line([(0, at), (size[0], at)], LINES, 2)
    font = ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", LETTERS)
    draw.text((LETTERS / 2, LETTERS / 4), f"{step:g} m a square", WORDS, font)
    for path in paths:
        if len(path) > 1:
            points = [(x * scale, y * scale) for x, y in path]
            draw.line(points, PATH, 6, joint="curve")
    return Drawing(image, round(max(width, height) / LARGEST_SIDE, 9))


def draw_paths(paths: Sequence[np.ndarray], frame: str, margin: float) -> Tuple[Image.Image, MetricFrame]:
    """A sheet that shows all of the paths and margin metres around them, and where it lies.

    :param paths: each (n, 2), metres in the tf frame; together at least one point
    """
    points = np.vstack(paths)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    size = high - low
    beside = np.maximum(SLIMMEST * size.max() - size, 0) / 2  # of a long straight way
    left, bottom = np.floor(10 * (low - beside)) / 10  # whole decimetres
    right, top = np.ceil(10 * (high + beside)) / 10
    on_sheet = [(path - (left, top)) * (1, -1) for path in paths]
    image, resolution = draw_overview(on_sheet, *np.round((right - left, top - bottom), 1).tolist())
    bottom = top - image.height * resolution  # of whole pixels
    origin = (round(float(left), 6), round(float(bottom), 6), 0.0)
    return image, MetricFrame(frame, resolution, origin)


def grid_step(longer_side: float) -> float:
    """1, 2 or 5 times a power of ten, so that there are at most GRID_LINES lines; metres."""
    least = longer_side / GRID_LINES
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least * (1 - 1e-9))


def map_server_frame(path: Path, frame: str) -> Tuple[Path, MetricFrame, Overview]:
    """The picture of a map_server YAML, and where it lies.

    :param frame: tf frame of that map; the YAML does not say it
    :returns: the picture's file; its place; its name and size
    :raises OSError: a file cannot be read
    :raises ValueError: it is no such YAML, or its picture is none
    """
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is no YAML: {str(error).splitlines()[0]}") from None
    lacking = [
        name
        for name in ("image", "resolution", "origin")
        if not isinstance(values, dict) or name not in values
    ]
    if lacking:
        raise ValueError(f"{path}: is no map of map_server, it lacks {', '.join(lacking)}")
    picture = path.parent / str(values["image"])
    try:
        resolution, (x, y, yaw) = float(values["resolution"]), _numbers(values["origin"])
    except (TypeError, ValueError):
        raise ValueError(f"{path}: resolution has to be a number, origin [x, y, yaw]") from None
    return picture, MetricFrame(frame, resolution, (x, y, yaw)), Overview(picture.name, *photo_size(picture))


def _numbers(values: Any) -> List[float]:
    return np.asarray(values, float).tolist()

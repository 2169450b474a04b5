# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overview images: drawn from paths, or read from a map_server YAML file."""

import math
from pathlib import Path
from typing import Sequence, Tuple

import matplotlib
import numpy as np
import yaml
from PIL import Image, ImageDraw, ImageFont

from sextant.place_maps.place_map import MetricFrame

LONGER_SIDE = 2000  # pixels of a drawn overview
PAPER, GRID, PATH, TEXT = "#fbfaf7", "#e2ded4", "#b9c7d6", "#8a857a"
MIN_ASPECT = 0.25  # minimum ratio of the shorter to the longer side
FONT_SIZE = 30  # pixels
MAX_GRID_LINES = 12  # maximum number of grid lines across the longer side


def draw_overview(paths: Sequence[np.ndarray], width: float, height: float) -> Tuple[Image.Image, float]:
    """Draws a metric grid and paths.

    :param paths: each (n, 2), metres from the left and from the top edge
    :param width: metres
    :param height: metres
    :returns: the image and its resolution in metres per pixel
    :raises ValueError: width or height is not above 0
    """
    if not (width > 0 and height > 0 and math.isfinite(width * height)):
        raise ValueError(f"an overview of {width:g} x {height:g} m cannot be drawn")
    scale = LONGER_SIDE / max(width, height)  # pixels per metre
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    image = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(image)
    step = grid_step(max(width, height))
    for i in range(1, math.ceil(max(width, height) / step)):
        at = i * step * scale
        draw.line([(at, 0), (at, size[1])], GRID, 2)
        draw.line([(0, at), (size[0], at)], GRID, 2)
    font = ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", FONT_SIZE)
    draw.text((FONT_SIZE / 2, FONT_SIZE / 4), f"grid {step:g} m", TEXT, font)
    for path in paths:
        if len(path) > 1:
            draw.line([(x * scale, y * scale) for x, y in path], PATH, 6, joint="curve")
    return image, round(max(width, height) / LONGER_SIDE, 9)


def draw_paths(paths: Sequence[np.ndarray], frame: str, margin: float) -> Tuple[Image.Image, MetricFrame]:
    """Draws an overview of paths with a margin, and returns it with its position in the frame.

    :param paths: each (n, 2), metres in the frame; together at least one point
    :param frame: tf frame
    :param margin: metres
    """
    points = np.vstack(paths)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    size = high - low
    padding = np.maximum(MIN_ASPECT * size.max() - size, 0) / 2  # for long straight paths
    left, bottom = np.floor(10 * (low - padding)) / 10  # rounded to decimetres
    right, top = np.ceil(10 * (high + padding)) / 10
    in_image = [(path - (left, top)) * (1, -1) for path in paths]
    image, resolution = draw_overview(in_image, *np.round((right - left, top - bottom), 1).tolist())
    bottom = top - image.height * resolution  # aligned to whole pixels
    origin = (round(float(left), 6), round(float(bottom), 6), 0.0)
    return image, MetricFrame(frame, resolution, origin)


def grid_step(longer_side: float) -> float:
    """Grid spacing in metres: 1, 2 or 5 times a power of ten, for at most MAX_GRID_LINES lines."""
    min_step = longer_side / MAX_GRID_LINES
    power = 10.0 ** math.floor(math.log10(min_step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= min_step * (1 - 1e-9))


def map_server_frame(path: Path, frame: str) -> Tuple[Path, MetricFrame]:
    """Reads the image file and the position of a map_server map.

    :param path: of the YAML file
    :param frame: tf frame of the map, which the YAML file does not contain
    :raises OSError: the file cannot be read
    :raises ValueError: it is not a map_server YAML file
    """
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is not YAML: {str(error).splitlines()[0]}") from None
    known = values if isinstance(values, dict) else {}
    missing = [name for name in ("image", "resolution", "origin") if name not in known]
    if missing:
        raise ValueError(f"{path}: is not a map_server map, {', '.join(missing)} missing")
    try:
        resolution, (x, y, yaw) = float(values["resolution"]), np.asarray(values["origin"], float).tolist()
    except (TypeError, ValueError):
        raise ValueError(f"{path}: resolution must be a number, origin [x, y, yaw]") from None
    return path.parent / str(values["image"]), MetricFrame(frame, resolution, (x, y, yaw))

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds pillars and balls by their colour alone: for those who have no network."""

import time
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, NamedTuple, Tuple

import cv2
import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.objects.detection import Detections, check_picture
from sextant.objects.object_kinds import BALL, GOAL

CLOSED = np.ones((3, 3), np.uint8)  # of gaps that noise leaves
HUES = 180  # of OpenCV, two degrees each


class ColourRange(NamedTuple):
    """Colours of a class, in OpenCV's HSV."""

    hue: float  # [0, 179] middle
    around: float  # [0, 90] on either side
    saturation: float  # [0, 255] least
    value: float  # [0, 255] least


_LARGEST = ColourRange(HUES - 1, HUES / 2, 255, 255)

RANGES: Dict[str, ColourRange] = {
    BALL: ColourRange(25, 8, 135, 50),
    GOAL: ColourRange(112, 12, 120, 30),
    "green_pillar": ColourRange(66, 14, 105, 30),
    "red_pillar": ColourRange(0, 8, 125, 35),
}


def _check_ranges(ranges: Dict[str, ColourRange]) -> str:
    try:
        ranges_of({name: colours._asdict() for name, colours in ranges.items()})
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ColourParams(StrictParams):
    """What colours there are, and how large a blot must be."""

    ranges: Dict[str, ColourRange] = param(RANGES, _check_ranges)
    least_area: int = param(30, within(1, 1000000))  # pixels
    least_fill: float = param(0.5, within(0, 1))  # of its box that a blot covers
    most: int = param(100, within(1, 10000))  # that are told of a picture


def ranges_of(written: Mapping[str, Any]) -> Dict[str, ColourRange]:
    """Of a YAML dictionary {class name: {hue, around, saturation, value}}; an empty one means RANGES.

    :raises ValueError: names the class, what of it cannot be, and what is allowed
    """
    return {str(name): _range(f"ranges/{name}", fields) for name, fields in written.items()} or dict(RANGES)


def _range(name: str, fields: Any) -> ColourRange:
    if not isinstance(fields, Mapping) or set(fields) != set(ColourRange._fields):
        raise ValueError(
            f"{name}: must be {{hue: ..., around: ..., saturation: ..., value: ...}}, is {fields!r}"
        )
    for key, most in _LARGEST._asdict().items():
        value = fields[key]
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= most:
            raise ValueError(f"{name}/{key}: must be within [0, {most:g}], is {value!r}")
    return ColourRange(**fields)


class ColourDetector:
    """As YoloDetector, by colour."""

    def __init__(self, params: ColourParams):
        """:raises ValueError: a setting out of range"""
        self._params = params
        self.classes = list(params.ranges)
        self._limits = [_limits(colours) for colours in params.ranges.values()]
        self.seconds: Dict[str, float] = {}  # of each stage of the last picture

    def detect(self, image: np.ndarray) -> Detections:
        """Boxes of connected blots. The score: the share of its box that a blot covers, less for small ones.

        :param image: uint8 (height, width, 3), red first
        :raises ValueError: it is not
        """
        check_picture(image)
        begin = time.perf_counter()
        hsv = cv2.cvtColor(cv2.medianBlur(image, 3), cv2.COLOR_RGB2HSV)
        rows: List[Tuple[float, ...]] = []
        for number, limits in enumerate(self._limits):
            rows += [(*row, number) for row in self._blots(_mask(hsv, limits))]
        table = np.array(rows, float).reshape(-1, 6)
        table = table[np.argsort(-table[:, 4], kind="stable")][: self._params.most]
        self.seconds = {"colours": time.perf_counter() - begin}
        return Detections(table[:, :4], table[:, 4], table[:, 5].astype(int))

    def _blots(self, mask: np.ndarray) -> List[Tuple[float, ...]]:
        """left, top, right, bottom, score."""
        least, rows = self._params.least_area, []
        for outline in cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]:
            left, top, width, height = cv2.boundingRect(outline)
            if width * height < least:
                continue
            area = cv2.contourArea(outline) + 0.5 * len(outline) + 1.0  # pixels, by Pick's theorem
            fill = min(1.0, area / (width * height))
            if area >= least and fill >= self._params.least_fill:
                score = fill * area / (area + least)
                rows.append((left, top, left + width, top + height, score))
        return rows


def _limits(colours: ColourRange) -> List[Tuple[np.ndarray, np.ndarray]]:
    """Least and most hue, saturation and value; two pairs where the hues go round the end of the circle."""
    low, high = colours.hue - colours.around, colours.hue + colours.around
    spans = [(low + turn, high + turn) for turn in (-HUES, 0, HUES)]
    return [
        (np.array([first, colours.saturation, colours.value], float), np.array([last, 255.0, 255.0]))
        for first, last in spans
        if last >= 0 and first < HUES
    ]


def _mask(hsv: np.ndarray, limits: List[Tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """uint8 (height, width), 255 where a pixel is of the colours."""
    mask = cv2.inRange(hsv, *limits[0])
    for each in limits[1:]:
        mask |= cv2.inRange(hsv, *each)
    return cv2.morphologyEx(mask, cv2.MORPH_CLOSE, CLOSED)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detection of pillars and balls by colour alone, without a network."""

import time
from dataclasses import asdict, dataclass
from typing import Any, Dict, List, Mapping, Tuple

import cv2
import numpy as np

from sextant.base.strict_params import Check, StrictParams, param, parse_params, required, within
from sextant.objects.detections import Detections, check_image
from sextant.objects.object_kinds import BALL, GOAL

CLOSING_KERNEL = np.ones((3, 3), np.uint8)  # closes gaps caused by noise
HUES = 180  # OpenCV's range of hue, two degrees each


@dataclass(frozen=True)
class ColourRange(StrictParams):
    """Colour range of a class, in OpenCV's HSV."""

    hue: float = required("centre of the range of hue", within(0, HUES - 1))
    hue_tolerance: float = required("half width of the range of hue", within(0, HUES // 2))
    min_saturation: float = required("minimum saturation", within(0, 255))
    min_value: float = required("minimum value", within(0, 255))


RANGES: Dict[str, ColourRange] = {
    BALL: ColourRange(25, 8, 135, 50),
    GOAL: ColourRange(112, 12, 120, 30),
    "green_pillar": ColourRange(66, 14, 105, 30),
    "red_pillar": ColourRange(0, 8, 125, 35),
}


def _check_ranges(ranges: Dict[str, Dict[str, Any]]) -> str:
    try:
        ranges_of(ranges)
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ColourParams(StrictParams):
    """Colour ranges of the classes, and thresholds for connected components."""

    ranges: Dict[str, Dict[str, Any]] = param(
        {name: asdict(colours) for name, colours in RANGES.items()},
        "`detector: colour`: colour range of each class in OpenCV's HSV",
        Check("hue: [0, 179], hue_tolerance: [0, 90], min_saturation, min_value: [0, 255]", _check_ranges),
    )
    min_area: int = param(
        30, "`detector: colour`: minimum area of a connected component", within(1, 1000000), "px"
    )
    min_fill: float = param(
        0.5, "`detector: colour`: minimum fraction of its box that a component covers", within(0, 1)
    )
    max_objects: int = param(100, "maximum number of detections in an image", within(1, 10000))


def ranges_of(written: Mapping[str, Mapping[str, Any]]) -> Dict[str, ColourRange]:
    """Parse a YAML dictionary {class name: {hue, hue_tolerance, min_saturation, min_value}}; empty: RANGES.

    :raises ValueError: names the class, the invalid field and the allowed values
    """
    ranges = {str(name): parse_params(ColourRange, each, f"ranges/{name}") for name, each in written.items()}
    return ranges or dict(RANGES)


class ColourDetector:
    """Detects connected components of the classes' colours."""

    def __init__(self, params: ColourParams):
        """:raises ValueError: a parameter out of range"""
        self._params = params
        ranges = ranges_of(params.ranges)
        self.classes = list(ranges)
        self._limits = [_limits(colours) for colours in ranges.values()]
        self.notes: List[str] = []
        self.seconds: Dict[str, float] = {}  # processing time of each stage, last image

    def detect(self, image: np.ndarray) -> Detections:
        """Detect connected components. The score is the covered fraction of the box, lower for small ones.

        :param image: uint8 (height, width, 3), red first
        :raises ValueError: another shape or type
        """
        check_image(image)
        begin = time.perf_counter()
        hsv = cv2.cvtColor(cv2.medianBlur(image, 3), cv2.COLOR_RGB2HSV)
        rows: List[Tuple[float, ...]] = []
        for number, limits in enumerate(self._limits):
            rows += [(*row, number) for row in self._components(_mask(hsv, limits))]
        table = np.array(rows, float).reshape(-1, 6)
        table = table[np.argsort(-table[:, 4], kind="stable")][: self._params.max_objects]
        self.seconds = {"colours": time.perf_counter() - begin}
        return Detections(table[:, :4], table[:, 4], table[:, 5].astype(int))

    def _components(self, mask: np.ndarray) -> List[Tuple[float, ...]]:
        """left, top, right, bottom, score."""
        min_area, rows = self._params.min_area, []
        for outline in cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]:
            left, top, width, height = cv2.boundingRect(outline)
            if width * height < min_area:
                continue
            area = cv2.contourArea(outline) + 0.5 * len(outline) + 1.0  # by Pick's theorem
            fill = min(1.0, area / (width * height))
            if area >= min_area and fill >= self._params.min_fill:
                score = fill * area / (area + min_area)
                rows.append((left, top, left + width, top + height, score))
        return rows


def _limits(colours: ColourRange) -> List[Tuple[np.ndarray, np.ndarray]]:
    """Lower and upper limits of HSV; two pairs where the range of hue wraps around."""
    low, high = colours.hue - colours.hue_tolerance, colours.hue + colours.hue_tolerance
    spans = [(low + turn, high + turn) for turn in (-HUES, 0, HUES)]
    return [
        (np.array([first, colours.min_saturation, colours.min_value], float), np.array([last, 255.0, 255.0]))
        for first, last in spans
        if last >= 0 and first < HUES
    ]


def _mask(hsv: np.ndarray, limits: List[Tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """uint8 (height, width), 255 where a pixel is in the range."""
    masks = [cv2.inRange(hsv, *each) for each in limits]
    return cv2.morphologyEx(np.bitwise_or.reduce(masks), cv2.MORPH_CLOSE, CLOSING_KERNEL)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders the overview of a map with its places as dots and the hypotheses in colour.

Two lines of text and the colour scale are below the overview.
"""

from functools import lru_cache
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.spatial import cKDTree

from sextant.place_maps.overview_backdrop import READABLE, backdrop
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.probability_colours import Colour, probability_bar, probability_colour

Box = Tuple[float, float, float, float]  # left, top, right, bottom; pixels

PAPER, INK, FAINT = (255, 255, 255), (33, 37, 41), (108, 117, 125)
PLACE, TRAIL = (92, 104, 116), (20, 110, 140)
MIN_LABELLED = 0.05  # minimum probability of a hypothesis whose id is written, if there is room
MAX_LABELS = 8  # maximum number of ids written
LINE, RING = 1.5, 5.5  # outline of hypotheses, ring around the best one; width, pixels in an image of 800
_MIN_PERCENT = 0.005  # smaller probabilities are written as "< 1 %"
_SUBPIXELS = 4  # fractional bits of OpenCV's coordinates
_ANGLES = np.linspace(0.0, 2 * np.pi, 36, endpoint=False)
_CIRCLE = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


class Hypothesis(NamedTuple):
    """A place and its probability."""

    id: int  # of its photo
    probability: float  # [0, 1]


class Radii(NamedTuple):
    """Radii of the dots, pixels of the overview."""

    place: float  # for a place
    hypothesis: float  # for a hypothesis
    best: float  # for the most probable hypothesis


class OverviewRenderer:
    """Renders hypotheses on the overview of one map; all images have the same size."""

    def __init__(self, place_map: PlaceMap, max_side: int = 1600):
        """:param max_side: maximum of the overview's longer side, pixels

        :raises OSError: the overview cannot be read
        :raises ValueError: it is not an image
        """
        self.backdrop = backdrop(place_map, max_side)  # uint8 (height, width, 3) RGB
        height, width = self.backdrop.shape[:2]
        self._unit = max(width, height) / READABLE  # scale of all sizes, which are for an image of 800 pixels
        self._layout = _Layout(width, height, self._unit)
        scale = width / place_map.overview.width, height / place_map.overview.height
        # position (x, y) of each photo id in the image, pixels
        self.at: Dict[int, Tuple[float, float]] = {
            photo.id: (photo.x * scale[0] + self._layout.left, photo.y * scale[1])
            for photo in place_map.photos
        }
        places = [self.at[photos[0].id] for photos in place_map.places()]
        self._dot = _dot_radius(places, self._unit)
        radii = (self._dot, self._radius(False), self._radius(True))
        self.radii = Radii(*(radius / scale[0] for radius in radii))
        self._count = len(places)
        self._empty = self._drawn_places(places)

    def likely(self, hypotheses: Sequence[Hypothesis]) -> List[Hypothesis]:
        """The hypotheses with a probability above 0 that are in the map, most probable first."""
        possible = [each for each in hypotheses if each.probability > 0 and each.id in self.at]
        return sorted(possible, key=lambda each: -each.probability)

    def draw(
        self, hypotheses: Optional[Sequence[Hypothesis]] = None, trail: Sequence[int] = ()
    ) -> np.ndarray:
        """Returns uint8 (height, width, 3), RGB.

        :param hypotheses: None: no result yet. Empty, or no probability above 0: an unknown place. Those that
            are not in the map are ignored
        :param trail: ids of the best hypotheses so far, oldest first
        """
        image = self._empty.copy()
        likely = self.likely(hypotheses or ())
        self._draw_trail(image, [self.at[number] for number in trail if number in self.at])
        for each in likely[::-1]:
            self._draw_hypothesis(image, each, each is likely[0])
        canvas = Image.fromarray(image)
        draw = ImageDraw.Draw(canvas)
        self._write_ids(draw, likely)
        self._write_text(draw, *text_of(hypotheses, likely, self._count))
        return np.array(canvas)

    def _drawn_places(self, places: Sequence[Tuple[float, float]]) -> np.ndarray:
        """The image without hypotheses."""
        layout = self._layout
        image = np.full((layout.height, layout.width, 3), PAPER, np.uint8)
        height, width = self.backdrop.shape[:2]
        image[:height, layout.left : layout.left + width] = self.backdrop
        for place in places:
            _disc(image, place, self._dot + 0.8 * self._unit, PAPER)
        for place in places:
            _disc(image, place, self._dot, PLACE)
        layout.draw_scale(image)
        return image

    def _draw_trail(self, image: np.ndarray, points: Sequence[Tuple[float, float]]) -> None:
        colours = trail_colours(len(points))
        for i, point in enumerate(points):
            colour, thickness = colours[i], max(1, round((1 + 2.5 * i / len(points)) * self._unit))
            if i + 1 < len(points) and points[i + 1] != point:
                ends = [_subpixels(each) for each in (point, points[i + 1])]
                cv2.line(image, *ends, colour, thickness, cv2.LINE_AA, _SUBPIXELS)
            _disc(image, point, max(self._dot, 2.2 * self._unit), colour)

    def _draw_hypothesis(self, image: np.ndarray, hypothesis: Hypothesis, is_best: bool) -> None:
        at, radius, line = self.at[hypothesis.id], self._radius(is_best), LINE * self._unit
        if is_best:
            _disc(image, at, radius + RING * self._unit, INK)
            _disc(image, at, radius + RING * self._unit - line, PAPER)
        _disc(image, at, radius + line, INK)
        _disc(image, at, radius, probability_colour(hypothesis.probability))

    def _radius(self, is_best: bool) -> float:
        return max(1.5 * self._dot, 5 * self._unit) * (1.4 if is_best else 1.0)

    def _write_ids(self, draw: ImageDraw.ImageDraw, likely: Sequence[Hypothesis]) -> None:
        """Writes ids beside the dots, most probable first, where they do not overlap dots or other ids."""
        unit, font = self._unit, _font(round(13 * self._unit), True)
        outer = [self._radius(False) + LINE * unit] * len(likely)
        outer[:1] = [self._radius(True) + RING * unit] * len(outer[:1])
        taken = [_around(self.at[each.id], radius) for each, radius in zip(likely, outer)]
        for each, radius in list(zip(likely, outer))[:MAX_LABELS]:
            width, height = font.getbbox(str(each.id), anchor="lt")[2:]
            boxes = _beside(self.at[each.id], radius + 3 * unit, (width + 6 * unit, height + 6 * unit))
            boxes = [_inside(box, self._layout.width - 1, self._layout.top - 1) for box in boxes]
            free = [box for box in boxes if not any(_overlap(box, other) for other in taken)]
            if free and each.probability >= MIN_LABELLED:
                taken.append(free[0])
                draw.rectangle(free[0], PAPER, FAINT)
                middle = ((free[0][0] + free[0][2]) / 2, (free[0][1] + free[0][3]) / 2)
                draw.text(middle, str(each.id), INK, font, anchor="mm")

    def _write_text(self, draw: ImageDraw.ImageDraw, headline: str, detail: str) -> None:
        layout = self._layout
        for text, rows, size, colour in ((headline, 0.9, 16, INK), (detail, 2.7, 13, FAINT)):
            font = _font(round(size * self._unit), colour == INK)
            too_wide = max(1.0, font.getlength(text) / (layout.scale_left - 2 * layout.margin))
            font = _font(int(size * self._unit / too_wide), colour == INK)
            draw.text((layout.margin, layout.top + rows * layout.margin), text, colour, font)


class _Layout:
    """Layout in pixels: the overview above, a strip with text and colour scale below."""

    def __init__(self, width: int, height: int, unit: float):
        self.margin = round(12 * unit)
        self.width = max(width, round(520 * unit))  # minimum for the text
        self.left = (self.width - width) // 2  # of the overview
        self.top = height  # of the strip
        self.height = height + round(56 * unit)
        self._scale_width, self._unit = round(180 * unit), unit
        self.scale_left = self.width - self.margin - self._scale_width

    def draw_scale(self, image: np.ndarray) -> None:
        """Draws the colour scale in the right half of the strip."""
        width, height = self._scale_width, round(12 * self._unit)
        left, top = self.scale_left, self.top + self.margin
        image[self.top, :] = _mixed(FAINT, PAPER, 0.6)
        image[top : top + height, left : left + width] = probability_bar(width, height)
        canvas = Image.fromarray(image)
        draw = ImageDraw.Draw(canvas)
        font = _font(round(11 * self._unit), False)
        for percent, anchor in ((0, "lt"), (50, "mt"), (100, "rt")):
            at = left + (width - 1) * percent / 100
            draw.line([(at, top + height), (at, top + height + 3 * self._unit)], FAINT)
            draw.text((at, top + height + 5 * self._unit), f"{percent} %", FAINT, font, anchor=anchor)
        image[:] = np.asarray(canvas)


def trail_colours(count: int) -> List[Colour]:
    """Colours of a trail of count points, oldest and palest first."""
    return [_mixed(TRAIL, PAPER, 0.85 * (count - i) / (count + 1)) for i in range(count)]


def text_of(
    hypotheses: Optional[Sequence[Hypothesis]], likely: Sequence[Hypothesis], places: int
) -> Tuple[str, str]:
    """Two lines of text that describe hypotheses.

    :param hypotheses: see OverviewRenderer.draw()
    :param likely: as returned by OverviewRenderer.likely()
    :param places: number of places in the map
    """
    map_size = f"{places} places in this map" if places != 1 else "1 place in this map"
    if hypotheses is None:
        return "No result yet", map_size
    if not any(each.probability > 0 for each in hypotheses):
        return "Unknown place", map_size
    if not likely:
        return "Places that are not in this map", map_size
    rest = 1 - sum(each.probability for each in likely)
    items = [f"{each.id}: {_percent(each.probability)}" for each in likely[:3]]
    items += [f"{len(likely) - 3} more"] * (len(likely) > 3)
    if rest > 0.5:
        return f"Probably none of these: {_percent(rest)}", "place " + ", ".join(items)
    items += [f"none of these: {_percent(rest)}"] * (rest >= _MIN_PERCENT)
    return f"Place {items[0]}", ", ".join(items[1:]) or map_size


def _percent(probability: float) -> str:
    return f"{100 * probability:.0f} %" if probability >= _MIN_PERCENT else "< 1 %"


def _dot_radius(places: Sequence[Tuple[float, float]], unit: float) -> float:
    """Radius of the dots, pixels: they are visible, but most neighbours do not overlap."""
    if len(places) < 2:
        return 5 * unit
    spacing = np.median(cKDTree(places).query(places, 2)[0][:, 1])
    return float(np.clip(0.3 * spacing, 1.6 * unit, 5 * unit))


def _disc(image: np.ndarray, centre: Tuple[float, float], radius: float, colour: Colour) -> None:
    """Draws a disc; cv2.circle() draws small ones as squares."""
    corners = np.round((np.asarray(centre) - 0.5 + radius * _CIRCLE) * 2**_SUBPIXELS).astype(np.int32)
    cv2.fillConvexPoly(image, corners, colour, cv2.LINE_AA, _SUBPIXELS)


def _subpixels(point: Tuple[float, float]) -> Tuple[int, int]:
    """Fixed-point coordinates for OpenCV, where (0, 0) is the centre of the first pixel, not its corner."""
    x, y = (round((value - 0.5) * 2**_SUBPIXELS) for value in point)
    return x, y


def _mixed(colour: Colour, other: Colour, share: float) -> Colour:
    """A mixture of two colours; share: of the other, 0 to 1."""
    red, green, blue = (round(one + share * (two - one)) for one, two in zip(colour, other))
    return red, green, blue


def _around(centre: Tuple[float, float], radius: float) -> Box:
    return centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius


def _beside(centre: Tuple[float, float], gap: float, size: Tuple[float, float]) -> List[Box]:
    """Boxes of a size to the right, to the left, above and below a point."""
    (x, y), (width, height) = centre, size
    lefts_tops = [
        (x + gap, y - height / 2),
        (x - gap - width, y - height / 2),
        (x - width / 2, y - gap - height),
        (x - width / 2, y + gap),
    ]
    return [(left, top, left + width, top + height) for left, top in lefts_tops]


def _inside(box: Box, width: float, height: float) -> Box:
    """The box, moved into the image."""
    right = min(max(-box[0], 0.0), width - box[2])
    down = min(max(-box[1], 0.0), height - box[3])
    return box[0] + right, box[1] + down, box[2] + right, box[3] + down


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


@lru_cache(maxsize=None)
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold" if bold else "DejaVuSans"
    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/{name}.ttf", max(size, 6))

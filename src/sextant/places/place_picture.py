# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The overview of a map with its places as dots, and in colour those where the robot may be.

Below it stand the answer in words and the scale of the colours.
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
from sextant.places.probability_scale import Colour, probability_bar, probability_colour

Box = Tuple[float, float, float, float]  # left, top, right, bottom

PAPER, INK, FAINT = (255, 255, 255), (33, 37, 41), (108, 117, 125)
PLACE, TRAIL = (92, 104, 116), (20, 110, 140)
LABELLED = 0.05  # probability from which a place's id is written, if there is room
LABELS = 8  # at most
LINE, RING = 1.5, 5.5  # around hypotheses, and around the best one; pixels in a picture of 800
_SAID = 0.005  # probability from which it is said in numbers
_SUBPIXELS = 4  # bits of OpenCV's coordinates
_ANGLES = np.linspace(0.0, 2 * np.pi, 36, endpoint=False)
_CIRCLE = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


class Hypothesis(NamedTuple):
    """A photo's id, and how probable it is that the robot is there."""

    id: int
    probability: float


class Radii(NamedTuple):
    """Of the dots, in pixels of the overview."""

    place: float
    hypothesis: float
    best: float


class PlacePicture:
    """Draws answers upon the overview of one map; RGB pictures of one size."""

    def __init__(self, place_map: PlaceMap, max_side: int = 1600):
        """:param max_side: pixels of the overview's longer side, at most

        :raises OSError: the overview cannot be read
        :raises ValueError: it is no picture
        """
        self.backdrop = backdrop(place_map, max_side)  # without anything on it
        height, width = self.backdrop.shape[:2]
        self._unit = max(width, height) / READABLE  # pixels that are one in a picture of 800
        self._layout = _Layout(width, height, self._unit)
        scale = width / place_map.overview.width, height / place_map.overview.height
        self._at: Dict[int, Tuple[float, float]] = {
            photo.id: (photo.x * scale[0] + self._layout.left, photo.y * scale[1])
            for photo in place_map.photos
        }
        places = [self._at[photos[0].id] for photos in place_map.places()]
        self._dot = _dot_radius(places, self._unit)
        radii = (self._dot, self._radius(False), self._radius(True))
        self.radii = Radii(*(radius / scale[0] for radius in radii))
        self._count = len(places)
        self._empty = self._drawn_places(places)

    def has(self, number: int) -> bool:
        """Whether the map has a photo of this id."""
        return number in self._at

    def likely(self, answer: Sequence[Hypothesis]) -> List[Hypothesis]:
        """Those that are possible and in the map, the likeliest first."""
        possible = [each for each in answer if each.probability > 0 and self.has(each.id)]
        return sorted(possible, key=lambda each: -each.probability)

    def at(self, number: int) -> Tuple[float, float]:
        """x and y in the picture of the photo of this id."""
        return self._at[number]

    def draw(self, answer: Optional[Sequence[Hypothesis]] = None, trail: Sequence[int] = ()) -> np.ndarray:
        """uint8 (height, width, 3), RGB.

        :param answer: None: nothing was said yet. Empty, or no probability above 0: the robot is nowhere that
            the map knows. What the map does not have is left out
        :param trail: ids of the best hypotheses up to this answer, the oldest first
        """
        picture = self._empty.copy()
        likely = self.likely(answer or ())
        self._draw_trail(picture, [self._at[number] for number in trail if self.has(number)])
        for each in likely[::-1]:
            self._draw_hypothesis(picture, each, each is likely[0])
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        self._write_ids(draw, likely)
        self._write_answer(draw, *words_of(answer, likely, self._count))
        return np.array(image)

    def _drawn_places(self, places: Sequence[Tuple[float, float]]) -> np.ndarray:
        layout = self._layout
        picture = np.full((layout.height, layout.width, 3), PAPER, np.uint8)
        height, width = self.backdrop.shape[:2]
        picture[:height, layout.left : layout.left + width] = self.backdrop
        for place in places:
            _disc(picture, place, self._dot + 0.8 * self._unit, PAPER)
        for place in places:
            _disc(picture, place, self._dot, PLACE)
        layout.draw_scale(picture)
        return picture

    def _draw_trail(self, picture: np.ndarray, points: Sequence[Tuple[float, float]]) -> None:
        colours = trail_colours(len(points))
        for i, point in enumerate(points):
            colour, thickness = colours[i], max(1, round((1 + 2.5 * i / len(points)) * self._unit))
            if i + 1 < len(points) and points[i + 1] != point:
                ends = [_subpixels(each) for each in (point, points[i + 1])]
                cv2.line(picture, *ends, colour, thickness, cv2.LINE_AA, _SUBPIXELS)
            _disc(picture, point, max(self._dot, 2.2 * self._unit), colour)

    def _draw_hypothesis(self, picture: np.ndarray, hypothesis: Hypothesis, is_best: bool) -> None:
        at, radius, line = self._at[hypothesis.id], self._radius(is_best), LINE * self._unit
        if is_best:
            _disc(picture, at, radius + RING * self._unit, INK)
            _disc(picture, at, radius + RING * self._unit - line, PAPER)
        _disc(picture, at, radius + line, INK)
        _disc(picture, at, radius, probability_colour(hypothesis.probability))

    def _radius(self, is_best: bool) -> float:
        """Of a hypothesis; hypotheses are larger than places, the best one is the largest."""
        return max(1.5 * self._dot, 5 * self._unit) * (1.4 if is_best else 1.0)

    def _write_ids(self, draw: ImageDraw.ImageDraw, likely: Sequence[Hypothesis]) -> None:
        """Beside the dots, the likeliest first, where neither dot nor id is in the way."""
        unit, font = self._unit, _font(round(13 * self._unit), True)
        outer = [self._radius(False) + LINE * unit] * len(likely)
        outer[:1] = [self._radius(True) + RING * unit] * len(outer[:1])
        taken = [_around(self._at[each.id], radius) for each, radius in zip(likely, outer)]
        for each, radius in list(zip(likely, outer))[:LABELS]:
            width, height = font.getbbox(str(each.id), anchor="lt")[2:]
            boxes = _beside(self._at[each.id], radius + 3 * unit, (width + 6 * unit, height + 6 * unit))
            boxes = [_inside(box, self._layout.width - 1, self._layout.top - 1) for box in boxes]
            free = [box for box in boxes if not any(_overlap(box, other) for other in taken)]
            if free and each.probability >= LABELLED:
                taken.append(free[0])
                draw.rounded_rectangle(free[0], 3 * unit, PAPER, FAINT)
                middle = ((free[0][0] + free[0][2]) / 2, (free[0][1] + free[0][3]) / 2)
                draw.text(middle, str(each.id), INK, font, anchor="mm")

    def _write_answer(self, draw: ImageDraw.ImageDraw, headline: str, detail: str) -> None:
        layout = self._layout
        for text, rows, size, colour in ((headline, 0.9, 16, INK), (detail, 2.7, 13, FAINT)):
            font = _font(round(size * self._unit), colour == INK)
            too_wide = max(1.0, font.getlength(text) / (layout.scale_left - 2 * layout.margin))
            font = _font(int(size * self._unit / too_wide), colour == INK)
            draw.text((layout.margin, layout.top + rows * layout.margin), text, colour, font)


class _Layout:
    """Where things are: the overview above, a strip with words and the scale below; pixels."""

    def __init__(self, width: int, height: int, unit: float):
        self.margin = round(12 * unit)
        self.width = max(width, round(520 * unit))  # narrower ones have no room for words
        self.left = (self.width - width) // 2  # of the overview
        self.top = height  # of the strip
        self.height = height + round(56 * unit)
        self._scale_width, self._unit = round(180 * unit), unit
        self.scale_left = self.width - self.margin - self._scale_width

    def draw_scale(self, picture: np.ndarray) -> None:
        """The colours with their probabilities, in the strip's right half."""
        width, height = self._scale_width, round(12 * self._unit)
        left, top = self.scale_left, self.top + self.margin
        picture[self.top, :] = _mixed(FAINT, PAPER, 0.6)
        picture[top : top + height, left : left + width] = probability_bar(width, height)
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        font = _font(round(11 * self._unit), False)
        for percent, anchor in ((0, "lt"), (50, "mt"), (100, "rt")):
            at = left + (width - 1) * percent / 100
            draw.line([(at, top + height), (at, top + height + 3 * self._unit)], FAINT)
            draw.text((at, top + height + 5 * self._unit), f"{percent} %", FAINT, font, anchor=anchor)
        picture[:] = np.asarray(image)


def trail_colours(count: int) -> List[Colour]:
    """The older the paler; the oldest is the first."""
    return [_mixed(TRAIL, PAPER, 0.85 * (count - i) / (count + 1)) for i in range(count)]


def words_of(
    answer: Optional[Sequence[Hypothesis]], likely: Sequence[Hypothesis], places: int
) -> Tuple[str, str]:
    """The answer in two lines.

    :param likely: those of the answer that the map has and that are possible, the likeliest first
    :param places: how many the map has
    """
    of_map = f"{places} places on this map" if places != 1 else "1 place on this map"
    if answer is None:
        return "Nothing recognized yet", of_map
    if not any(each.probability > 0 for each in answer):
        return "Nowhere: no place is recognized", of_map
    if not likely:
        return "Places that this map does not have", of_map
    rest = 1 - sum(each.probability for each in likely)
    said = [f"{each.id}: {_percent(each.probability)}" for each in likely[:3]]
    said += [f"{len(likely) - 3} more"] * (len(likely) > 3)
    if rest > 0.5:
        return f"Probably none of these: {_percent(rest)}", "place " + ", ".join(said)
    said += [f"none of these: {_percent(rest)}"] * (rest >= _SAID)
    return f"Place {said[0]}", ", ".join(said[1:]) or of_map


def _percent(probability: float) -> str:
    return f"{100 * probability:.0f} %" if probability >= _SAID else "< 1 %"


def _dot_radius(places: Sequence[Tuple[float, float]], unit: float) -> float:
    """Pixels: large enough to be seen, small enough that the neighbours stay apart."""
    if len(places) < 2:
        return 5 * unit
    apart = np.median(cKDTree(places).query(places, 2)[0][:, 1])
    return float(np.clip(0.3 * apart, 1.6 * unit, 5 * unit))


def _disc(picture: np.ndarray, centre: Tuple[float, float], radius: float, colour: Colour) -> None:
    """Not by cv2.circle(), which makes squares of small ones."""
    corners = np.round((np.asarray(centre) - 0.5 + radius * _CIRCLE) * 2**_SUBPIXELS).astype(np.int32)
    cv2.fillConvexPoly(picture, corners, colour, cv2.LINE_AA, _SUBPIXELS)


def _subpixels(point: Tuple[float, float]) -> Tuple[int, int]:
    """OpenCV counts from the middle of the first pixel, the map from its edge."""
    x, y = (round((value - 0.5) * 2**_SUBPIXELS) for value in point)
    return x, y


def _mixed(colour: Colour, other: Colour, share: float) -> Colour:
    """:param share: of the other"""
    red, green, blue = (round(one + share * (two - one)) for one, two in zip(colour, other))
    return red, green, blue


def _around(centre: Tuple[float, float], radius: float) -> Box:
    return centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius


def _beside(centre: Tuple[float, float], gap: float, size: Tuple[float, float]) -> List[Box]:
    """Boxes right, left, above and below of a point."""
    (x, y), (width, height) = centre, size
    lefts_tops = [
        (x + gap, y - height / 2),
        (x - gap - width, y - height / 2),
        (x - width / 2, y - gap - height),
        (x - width / 2, y + gap),
    ]
    return [(left, top, left + width, top + height) for left, top in lefts_tops]


def _inside(box: Box, width: float, height: float) -> Box:
    """The box, moved so that it is in the picture."""
    right = min(max(-box[0], 0.0), width - box[2])
    down = min(max(-box[1], 0.0), height - box[3])
    return box[0] + right, box[1] + down, box[2] + right, box[3] + down


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


@lru_cache(maxsize=None)
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold" if bold else "DejaVuSans"
    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/{name}.ttf", max(size, 6))

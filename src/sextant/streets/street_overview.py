# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders an aerial image of a simulated street."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

from sextant.simulation.uprights import Upright
from sextant.streets.street import LENGTH, WIDTH, Street

MARGIN = 16.0  # around the block, metres
DEPTH = 7.0  # of a house behind its front, metres
ROOF, RIDGE, CROWN = (150, 116, 104), (128, 96, 86), (74, 96, 66)  # colours, RGB
LOW = 2.0  # lower objects (bushes, parked cars) are not drawn, metres
OPAQUE = 0.85  # opacity of roofs and crowns


class AerialImage(NamedTuple):
    """A north-up aerial image; the street's y axis is north."""

    image: np.ndarray  # uint8 (height, width, 3) RGB
    resolution: float  # metres per pixel
    corner: Tuple[float, float]  # lower left corner, metres

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Pixels, int32 (n, 2), of points (n, 2) on the ground in metres."""
        right, up = (np.asarray(points, float) - self.corner).T / self.resolution
        return np.int32(np.rint([right, len(self.image) - up]).T)


def aerial_image(street: Street, resolution: float = 0.1) -> AerialImage:
    """Renders the ground with roofs and tree crowns, seen from above.

    :param resolution: metres per pixel
    """
    columns, rows = (round((side + 2 * MARGIN) / resolution) for side in (LENGTH, WIDTH))
    x = np.float32((np.arange(columns) + 0.5) * resolution - MARGIN)
    y = np.float32(rows * resolution - MARGIN - (np.arange(rows) + 0.5) * resolution)
    ground = street.ground.seen(*np.meshgrid(x, y), np.full(rows, resolution, np.float32))
    image = np.repeat(np.clip(ground, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
    aerial = AerialImage(image, resolution, (-MARGIN, -MARGIN))
    drawn = image.copy()
    for upright in sorted(street.uprights, key=lambda each: each.height):
        if upright.height > LOW:
            (_roof if upright.mask is None else _crown)(aerial, drawn, upright)
    return aerial._replace(image=cv2.addWeighted(drawn, OPAQUE, image, 1 - OPAQUE, 0))


def _roof(aerial: AerialImage, image: np.ndarray, upright: Upright) -> None:
    """Draws the roof of a house behind its front."""
    along = upright.right - upright.left
    back = DEPTH * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    left, right = upright.left, upright.right
    cv2.fillPoly(image, [aerial.pixels([left, right, right + back, left + back])], ROOF, cv2.LINE_AA)
    ridge = map(tuple, aerial.pixels([left + back / 2, right + back / 2]).tolist())
    cv2.line(image, *ridge, RIDGE, 3, cv2.LINE_AA)


def _crown(aerial: AerialImage, image: np.ndarray, upright: Upright) -> None:
    """Draws the crown of a tree."""
    centre = tuple(aerial.pixels([(upright.left + upright.right) / 2])[0].tolist())
    radius = np.linalg.norm(upright.right - upright.left) / 2
    cv2.circle(image, centre, round(radius / aerial.resolution), CROWN, -1, cv2.LINE_AA)

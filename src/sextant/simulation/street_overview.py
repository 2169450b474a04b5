# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated street from above, as an aerial picture has it."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

from sextant.simulation.street import LENGTH, WIDTH, Street, Upright

MARGIN = 16.0  # metres around the walk
DEPTH = 7.0  # metres of a house, of which the street knows only the front
ROOF, RIDGE, CROWN = (150, 116, 104), (128, 96, 86), (74, 96, 66)
LOW = 2.0  # metres: bushes and parked cars
OPAQUE = 0.85  # of what is drawn on the ground


class AerialPicture(NamedTuple):
    """North, the street's y, is up."""

    image: np.ndarray  # uint8 (height, width, 3) RGB
    resolution: float  # metres a pixel
    corner: Tuple[float, float]  # of the lower left one, metres

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Of points (n, 2) on the ground; int32 (n, 2)."""
        right, up = (np.asarray(points, float) - self.corner).T / self.resolution
        return np.int32(np.rint([right, len(self.image) - up]).T)


def aerial_picture(street: Street, resolution: float = 0.1) -> AerialPicture:
    """The ground with roofs and crowns."""
    columns, rows = (round((side + 2 * MARGIN) / resolution) for side in (LENGTH, WIDTH))
    x = np.float32((np.arange(columns) + 0.5) * resolution - MARGIN)
    y = np.float32(rows * resolution - MARGIN - (np.arange(rows) + 0.5) * resolution)
    ground = street.ground.seen(*np.meshgrid(x, y), np.full(rows, resolution, np.float32))
    image = np.repeat(np.clip(ground, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
    picture = AerialPicture(image, resolution, (-MARGIN, -MARGIN))
    drawn = image.copy()
    for upright in sorted(street.uprights, key=lambda each: each.height):
        if upright.height > LOW:
            (_roof if upright.mask is None else _crown)(picture, drawn, upright)
    return picture._replace(image=cv2.addWeighted(drawn, OPAQUE, image, 1 - OPAQUE, 0))


def _roof(picture: AerialPicture, image: np.ndarray, upright: Upright) -> None:
    along = upright.right - upright.left
    back = DEPTH * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    left, right = upright.left, upright.right
    cv2.fillPoly(image, [picture.pixels([left, right, right + back, left + back])], ROOF, cv2.LINE_AA)
    ridge = picture.pixels([left + back / 2, right + back / 2]).tolist()
    cv2.line(image, ridge[0], ridge[1], RIDGE, 3, cv2.LINE_AA)


def _crown(picture: AerialPicture, image: np.ndarray, upright: Upright) -> None:
    centre = picture.pixels([(upright.left + upright.right) / 2])[0].tolist()
    radius = np.linalg.norm(upright.right - upright.left) / 2
    cv2.circle(image, centre, round(radius / picture.resolution), CROWN, -1, cv2.LINE_AA)

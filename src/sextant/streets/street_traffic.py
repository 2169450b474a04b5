# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Textures of parked cars and of pedestrians of a simulated street, each with its random seed."""

import cv2
import numpy as np

from sextant.streets import street_snow
from sextant.streets.street_surface import TEXELS, Texture, rough_noise

CAR_SNOW = 0.12  # depth of the snow on cars, metres


def car(seed: int, season: str) -> Texture:
    """Texture of a parked car from its side."""
    rng = np.random.default_rng(seed)
    width, height = 4.2, 1.5
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    grey = np.full((rows, columns), rng.uniform(20, 230), np.float32)
    grey += np.linspace(18, -18, rows, dtype=np.float32)[:, None] + 2.5 * rough_noise(rng, rows, columns)
    mask = np.zeros((rows, columns), np.uint8)
    size = np.array([columns, rows])
    body = np.array([[0, 0.5], [0.13, 0.45], [0.88, 0.45], [0.99, 0.52], [1, 0.84], [0, 0.84]])
    roof = np.array([[0.15, 0.45], [0.3, 0.02], [0.68, 0], [0.88, 0.45]])
    cv2.fillPoly(mask, [(part * size).astype(np.int32) for part in (body, roof)], 255)
    for left, right in ((0.2, 0.47), (0.49, 0.82)):  # windows
        glass = [[left, 0.42], [max(left, 0.32), 0.07], [min(right, 0.66), 0.07], [right, 0.42]]
        cv2.fillPoly(grey, [(np.array(glass) * size).astype(np.int32)], 45.0)
    for x in (0.3, 0.48, 0.7):  # joints of the doors
        cv2.line(grey, (int(x * columns), int(0.45 * rows)), (int(x * columns), int(0.8 * rows)), 30.0, 2)
    y = int(0.52 * rows)
    for x in (0.36, 0.54):  # handles
        cv2.line(grey, (int(x * columns), y), (int((x + 0.04) * columns), y), 25.0, 3)
    grey[int(0.78 * rows) :] *= 0.5
    _wheels(grey, mask, 0.82, 0.18)
    return _parked(grey, mask, width, height, season)


def van(seed: int, season: str) -> Texture:
    """Texture of a parked delivery van from its side."""
    rng = np.random.default_rng(seed)
    width, height = 5.2, rng.uniform(2.1, 2.6)
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    grey = np.full((rows, columns), rng.uniform(20, 230), np.float32)
    grey += np.linspace(18, -18, rows, dtype=np.float32)[:, None] + 2.5 * rough_noise(rng, rows, columns)
    mask, size = np.zeros((rows, columns), np.uint8), np.array([columns, rows])
    body = np.array([[0, 0.03], [0.76, 0], [0.9, 0.4], [1, 0.5], [1, 0.9], [0, 0.9]])
    glass = np.array([[0.7, 0.1], [0.77, 0.1], [0.86, 0.4], [0.7, 0.42]])
    cv2.fillPoly(mask, [(body * size).astype(np.int32)], 255)
    cv2.fillPoly(grey, [(glass * size).astype(np.int32)], 40.0)
    for x in (0.38, 0.67, 0.88):  # joints of the doors
        cv2.line(grey, (int(x * columns), int(0.08 * rows)), (int(x * columns), int(0.88 * rows)), 35.0, 2)
    cv2.putText(
        grey,
        "".join(rng.choice(list("ABCDEFGHIKLMNOPRSTUVW"), 5)),
        (int(0.04 * columns), int(0.45 * rows)),
        cv2.FONT_HERSHEY_DUPLEX,
        rng.uniform(0.5, 1.0) * TEXELS / 30,
        float(rng.uniform(20, 230)),
        TEXELS // 24,
    )
    _wheels(grey, mask, 0.88, 0.13)
    return _parked(grey, mask, width, height, season)


def _wheels(grey: np.ndarray, mask: np.ndarray, low: float, radius: float) -> None:
    """Draws the wheels in place; height of their centre and radius as fractions of the rows."""
    rows, columns = grey.shape
    for x in (0.2, 0.8):
        hub = (int(x * columns), int(low * rows))
        for part, tone in ((1.0, 25.0), (0.11 / 0.18, 150.0), (0.07 / 0.18, 90.0), (0.03 / 0.18, 180.0)):
            cv2.circle(mask, hub, int(part * radius * rows), 255, -1)
            cv2.circle(grey, hub, int(part * radius * rows), tone, -1)


def _parked(grey: np.ndarray, mask: np.ndarray, width: float, height: float, season: str) -> Texture:
    if season == "snow":
        street_snow.on_outline(grey, mask, int(CAR_SNOW * TEXELS))
    return Texture(np.clip(grey, 0, 255), mask, width, height)


def person(seed: int) -> Texture:
    """Texture of a pedestrian from the front."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(1.5, 1.9)
    rows, columns = int(height * TEXELS), int(0.7 * TEXELS)
    mask, grey = np.zeros((rows, columns), np.uint8), np.zeros((rows, columns), np.float32)
    size = np.array([columns, rows])
    head = [*(np.array([0.5, 0.07]) * size).astype(int)], (int(0.14 * columns), int(0.07 * rows))
    stride = rng.uniform(0, 0.14)
    coat = [[0.3, 0.14], [0.7, 0.14], [0.88, 0.5], [0.76, 0.52], [0.7, 0.62]]
    coat += [[0.3, 0.62], [0.24, 0.52], [0.12, 0.5]]
    legs = [
        [[0.31, 0.6], [0.5, 0.6], [0.48 - stride, 1.0], [0.3 - stride, 1.0]],
        [[0.5, 0.6], [0.69, 0.6], [0.7 + stride, 1.0], [0.52 + stride, 1.0]],
    ]
    for outline in (coat, *legs):
        tone = float(rng.uniform(15, 200))
        for image, value in ((mask, 255), (grey, tone)):
            cv2.fillPoly(image, [(np.array(outline) * size).astype(np.int32)], value)
    for image, value in ((mask, 255), (grey, float(rng.uniform(60, 170)))):
        cv2.ellipse(image, tuple(head[0]), head[1], 0, 0, 360, value, -1)
    return Texture(np.clip(grey + 9 * rough_noise(rng, rows, columns), 0, 255), mask, 0.7, height)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What stands along a simulated street: facades, trees and cars, as grey textures with seeds of their own.

Brightness is 0 to 255 in the light of a cloudy day. A texture's `look` is what people change from day to day:
blinds, posters; everything else of a facade stays.
"""

from typing import List, NamedTuple, Optional, Tuple

import cv2
import numpy as np

TEXELS = 48  # a metre
SEASONS = ("summer", "autumn", "winter")
LEAVES = {"summer": (6.0, 75.0), "autumn": (2.7, 140.0), "winter": (0.0, 0.0)}  # bunches a twig, brightness
SNOW = 225.0


class Texture(NamedTuple):
    """A picture of something upright, `width` x `height` metres; the lower edge is on the ground."""

    grey: np.ndarray  # float32 (rows, columns)
    mask: Optional[np.ndarray]  # uint8 (rows, columns), 255 where it is; None: everywhere
    width: float
    height: float


def noise(rng: np.random.Generator, rows: int, columns: int, grain: float) -> np.ndarray:
    """Smooth noise of deviation 1, float32 (rows, columns); grain: its size in pixels."""
    shape = (int(rows / grain) + 4, int(columns / grain) + 4)
    return cv2.resize(
        rng.normal(size=shape).astype(np.float32), (columns, rows), interpolation=cv2.INTER_CUBIC
    )


def facade(seed: int, width: float, height: float, look: int) -> Texture:
    """The front of a house, metres."""
    rng, look_rng = np.random.default_rng(seed), np.random.default_rng([seed, look])
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    base = rng.uniform(60, 190)
    grey = np.full((rows, columns), base, np.float32)
    grey += 8 * noise(rng, rows, columns, TEXELS) + 5 * noise(rng, rows, columns, 0.2 * TEXELS)
    surface = (_bricks, _panels, _plaster)[rng.integers(3)]
    surface(rng, grey)
    _windows(rng, look_rng, grey, float(np.clip(base + rng.uniform(-70, 70), 5, 250)))
    _door(rng, grey)
    _sign(rng, grey)
    _poster(rng, look_rng, grey)
    return Texture(np.clip(grey, 0, 255), None, width, height)


def tree(seed: int, season: str, look: int) -> Texture:
    """A tree as it is in a season."""
    rng, look_rng = np.random.default_rng(seed), np.random.default_rng([seed, look])
    width, height = rng.uniform(2.5, 5), rng.uniform(4, 8)
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    mask = np.zeros((rows, columns), np.uint8)
    twigs = _branches(rng, mask)
    grey = rng.uniform(40, 90) + 8 * noise(rng, rows, columns, 4)
    bunches, tone = LEAVES[season]
    for x, y in twigs:
        for _ in range(int(bunches + look_rng.random()) if bunches else 0):
            centre = (int(x + look_rng.normal(0, 0.3 * TEXELS)), int(y + look_rng.normal(0, 0.3 * TEXELS)))
            radius = int(look_rng.uniform(0.05, 0.2) * TEXELS)
            cv2.circle(grey, centre, radius, float(tone + look_rng.normal(0, 25)), -1)
            cv2.circle(mask, centre, radius, 255, -1)
    if season == "winter":
        grey[cv2.subtract(mask, np.roll(mask, 2, axis=0)) > 0] = SNOW  # on top of every branch
    return Texture(np.clip(grey, 0, 255), mask, width, height)


def car(seed: int) -> Texture:
    """A parked car, seen from its side."""
    rng = np.random.default_rng(seed)
    width, height = 4.2, 1.5
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    grey = np.full((rows, columns), rng.uniform(20, 230), np.float32)
    mask = np.zeros((rows, columns), np.uint8)
    size = np.array([columns, rows])
    cv2.rectangle(mask, (0, int(0.45 * rows)), (columns, int(0.85 * rows)), 255, -1)
    roof = np.array([[0.15, 0.45], [0.3, 0], [0.7, 0], [0.88, 0.45]])
    glass = np.array([[0.2, 0.42], [0.32, 0.06], [0.68, 0.06], [0.83, 0.42]])
    cv2.fillPoly(mask, [(roof * size).astype(np.int32)], 255)
    cv2.fillPoly(grey, [(glass * size).astype(np.int32)], 40.0)
    for x in (0.2, 0.8):
        hub = (int(x * columns), int(0.82 * rows))
        for radius, tone in ((0.18, 25.0), (0.09, 170.0)):
            cv2.circle(mask, hub, int(radius * rows), 255, -1)
            cv2.circle(grey, hub, int(radius * rows), tone, -1)
    return Texture(grey, mask, width, height)


def _bricks(rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = int(0.12 * TEXELS) + 1, int(0.4 * TEXELS)
    for number, y in enumerate(range(0, grey.shape[0], rows)):
        grey[y] -= 25
        for x in range(number % 2 * columns // 2, grey.shape[1], columns):
            grey[y : y + rows, x : x + columns] += rng.normal(0, 6)
            grey[y : y + rows, x] -= 20


def _panels(rng: np.random.Generator, grey: np.ndarray) -> None:
    for x in range(0, grey.shape[1], int(rng.uniform(0.5, 1.4) * TEXELS)):
        grey[:, x : x + 2] -= 35


def _plaster(rng: np.random.Generator, grey: np.ndarray) -> None:
    grey += 6 * noise(rng, *grey.shape, 3)


def _windows(rng: np.random.Generator, look_rng: np.random.Generator, grey: np.ndarray, frame: float) -> None:
    rows, columns = grey.shape
    storey, gap = rng.uniform(2.7, 3.6) * TEXELS, rng.uniform(0.6, 2.0) * TEXELS
    width, height = rng.uniform(0.8, 1.8) * TEXELS, rng.uniform(1.0, 1.8) * TEXELS
    panes = (int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    for y in np.arange(rows - 0.9 * TEXELS - height, 0.3 * TEXELS, -storey):
        for x in np.arange(gap * rng.uniform(0.4, 1.0), columns - 0.2 * TEXELS - width, width + gap):
            if rng.random() < 0.88:
                _window(look_rng, grey, (int(x), int(y), int(x + width), int(y + height)), frame, panes)


def _window(
    look_rng: np.random.Generator,
    grey: np.ndarray,
    box: Tuple[int, int, int, int],
    frame: float,
    panes: Tuple[int, int],
) -> None:
    left, top, right, bottom = box
    bar = max(2, int(0.08 * TEXELS))
    cv2.rectangle(grey, (left - bar, top - bar), (right + bar, bottom + bar), frame, -1)
    dark = look_rng.uniform(20, 110)
    grey[top:bottom, left:right] = np.linspace(dark + look_rng.uniform(0, 50), dark, bottom - top)[:, None]
    if look_rng.random() < 0.4:  # a blind
        grey[top : top + int((bottom - top) * look_rng.uniform(0.2, 0.8)), left:right] = look_rng.uniform(
            100, 220
        )
    for i in range(1, panes[0]):
        x = left + i * (right - left) // panes[0]
        cv2.line(grey, (x, top), (x, bottom), frame, bar // 2 + 1)
    for i in range(1, panes[1]):
        y = top + i * (bottom - top) // panes[1]
        cv2.line(grey, (left, y), (right, y), frame, bar // 2 + 1)


def _door(rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = grey.shape
    left = rng.uniform(0.5 * TEXELS, max(0.6 * TEXELS, columns - 2 * TEXELS))
    width = rng.uniform(0.9, 1.6) * TEXELS
    top = rows - 2.3 * TEXELS
    cv2.rectangle(grey, (int(left), int(top)), (int(left + width), rows), float(rng.uniform(20, 230)), -1)
    inner = [(left + 0.15 * width, top + 0.2 * TEXELS), (left + 0.85 * width, top + 1.1 * TEXELS)]
    cv2.rectangle(grey, *[tuple(map(int, corner)) for corner in inner], float(rng.uniform(20, 230)), 3)


def _sign(rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = grey.shape
    left, top = rng.uniform(0.1, 0.5) * columns, rows - rng.uniform(2.6, 3.4) * TEXELS
    word = "".join(rng.choice(list("ABCDEFGHIKLMNOPRSTUVW"), 6))
    paper, ink = rng.uniform(20, 230, 2)
    if rng.random() > 0.6:
        return
    corners = [(left, top), (left + 0.4 * columns, top + 0.6 * TEXELS)]
    cv2.rectangle(grey, *[tuple(map(int, corner)) for corner in corners], float(paper), -1)
    at = (int(left + 0.05 * columns), int(top + 0.48 * TEXELS))
    cv2.putText(grey, word, at, cv2.FONT_HERSHEY_DUPLEX, 0.4 * TEXELS / 22, float(ink), 2)


def _poster(rng: np.random.Generator, look_rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = grey.shape
    left, top = int(rng.uniform(0.1, 0.8) * columns), max(0, int(rows - 2.0 * TEXELS))
    if rng.random() > 0.5:
        return
    poster = look_rng.uniform(30, 220) + 40 * noise(look_rng, TEXELS, int(0.7 * TEXELS), 0.15 * TEXELS)
    part = grey[top : top + TEXELS, left : left + poster.shape[1]]
    part[:] = poster[: part.shape[0], : part.shape[1]]


def _branches(rng: np.random.Generator, mask: np.ndarray) -> List[Tuple[float, float]]:
    """Draws a trunk and what grows of it; returns where the twigs end."""
    rows, columns = mask.shape
    twigs = []
    growing = [(columns / 2, float(rows), 0.0, 0.28 * rows, rng.uniform(0.15, 0.35) * TEXELS, 5)]
    while growing:
        x, y, angle, length, thickness, depth = growing.pop()
        end = (x + length * np.sin(angle), y - length * np.cos(angle))
        cv2.line(mask, (int(x), int(y)), (int(end[0]), int(end[1])), 255, max(1, int(thickness)))
        if depth <= 2:
            twigs.append(end)
        for _ in range(int(rng.integers(2, 4)) if depth else 0):
            turned = angle + rng.normal(0, 0.5)
            growing.append((*end, turned, length * rng.uniform(0.6, 0.8), 0.6 * thickness, depth - 1))
    return twigs

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Textures of facades of a simulated street, each with its random seed.

`look` is the random seed of blinds and posters, which change from day to day.
"""

from typing import List, Tuple

import cv2
import numpy as np

from sextant.streets import street_snow
from sextant.streets.street_surface import TEXELS, Texture, rough_noise, smooth_noise

BAR = int(0.08 * TEXELS)  # width of the frame of a window, texels
LIGHTS = {"bare": 0.4, "snow": 0.4}  # fraction of the windows that are lit from inside, on dark days
SILL_SNOW = 0.16  # depth of snow on sills, metres


def facade(seed: int, width: float, height: float, look: int, season: str) -> Texture:
    """Texture of a house front; width and height in metres."""
    rng, look_rng = np.random.default_rng(seed), np.random.default_rng([seed, look])
    rows, columns = int(height * TEXELS), int(width * TEXELS)
    base = rng.uniform(60, 190)
    grey = np.full((rows, columns), base, np.float32)
    grey += 8 * smooth_noise(rng, rows, columns, TEXELS) + 5 * smooth_noise(rng, rows, columns, 0.2 * TEXELS)
    surface = (_bricks, _panels, _plaster)[rng.integers(3)]
    surface(rng, grey)
    _plinth(rng, grey)
    eaves = _roof(rng, grey)
    frame = float(np.clip(base + rng.uniform(-70, 70), 5, 250))
    windows, panes = _windows(rng, grey.shape, eaves)
    for window in windows:
        _window(look_rng, grey, window, frame, panes, LIGHTS.get(season, 0.0))
    _pipe(rng, grey[eaves:])
    _door(rng, grey)
    _sign(rng, grey)
    _poster(rng, look_rng, grey)
    if season in street_snow.ROOF:
        street_snow.on_roof(look_rng, grey[: eaves - int(0.1 * TEXELS)], season)
    if season == "snow":
        sills = street_snow.ledges_of(windows, BAR)
        street_snow.on_ledges(look_rng, grey, [*sills, (0, columns, eaves)], SILL_SNOW)
        street_snow.at_foot(look_rng, grey)
    return Texture(np.clip(grey, 0, 255), None, width, height)


def _bricks(rng: np.random.Generator, grey: np.ndarray) -> None:
    y, x = np.arange(grey.shape[0]), np.arange(grey.shape[1])
    row, across = y // int(0.085 * TEXELS), 0.26 * TEXELS
    column = ((x[None] + (row % 2)[:, None] * across / 2) / across).astype(np.int32)
    tones = rng.normal(0, 14, (row.max() + 1, column.max() + 1)).astype(np.float32)
    joint = float(rng.choice([-30, 28]))
    joints = (np.diff(row, prepend=-1) != 0)[:, None] | (np.diff(column, axis=1, prepend=-1) != 0)
    grey += np.where(joints, joint, tones[row[:, None], column]) + 12 * rough_noise(rng, *grey.shape)


def _panels(rng: np.random.Generator, grey: np.ndarray) -> None:
    """Boards with wood grain."""
    rows, columns = grey.shape
    grey += 7 * cv2.resize(rough_noise(rng, rows // 16, columns), (columns, rows)) + 9 * rough_noise(
        rng, rows, columns
    )
    for x in range(0, columns, int(rng.uniform(0.12, 0.5) * TEXELS)):
        grey[:, x : x + 2] -= 40
        grey[:, x + 2 :] += rng.normal(0, 4)


def _plaster(rng: np.random.Generator, grey: np.ndarray) -> None:
    grey += 15 * rough_noise(rng, *grey.shape)
    for _ in range(int(rng.integers(3, 12))):  # cracks and stains that run down
        x, y = rng.uniform(0, grey.shape[1]), rng.uniform(0, grey.shape[0])
        path = (x, y) + np.cumsum(rng.normal((0, 7), (4, 4), (int(rng.integers(5, 25)), 2)), axis=0)
        cv2.polylines(grey, [path.astype(np.int32)], False, float(grey.mean() - rng.uniform(20, 45)), 1)


def _plinth(rng: np.random.Generator, grey: np.ndarray) -> None:
    """Stones at the foot of the wall."""
    top = grey.shape[0] - int(rng.uniform(0.2, 0.6) * TEXELS)
    stones = grey[top:]
    stones[:] = rng.uniform(60, 150) + 16 * rough_noise(rng, *stones.shape)
    for x in range(0, stones.shape[1], int(0.45 * TEXELS)):
        at = x + int(rng.uniform(0, 0.2) * TEXELS)
        stones[:, at : at + 2] -= 35
    stones[:2] -= 30


def _roof(rng: np.random.Generator, grey: np.ndarray) -> int:
    """Tiles above a gutter; returns the row below it."""
    rows, columns = int(rng.uniform(0.1, 0.25) * grey.shape[0]), grey.shape[1]
    gutter = int(0.1 * TEXELS)
    tile_rows, tile_columns = int(0.3 * TEXELS), int(0.22 * TEXELS)
    y, x = np.arange(rows)[:, None], np.arange(columns)[None]
    tones = rng.normal(rng.uniform(50, 120), 14, (rows // tile_rows + 1, columns // tile_columns + 1))
    roof = tones[y // tile_rows, x // tile_columns] + 9 * rough_noise(rng, rows, columns)
    roof += 14 * np.sin(2 * np.pi * x / tile_columns) - 40 * (y % tile_rows < 3)
    grey[:rows] = roof
    grey[rows : rows + gutter] = rng.uniform(40, 200)
    grey[rows + gutter : rows + 3 * gutter] *= 0.75  # the shade of the eaves
    return rows + gutter


def _windows(
    rng: np.random.Generator, shape: Tuple[int, int], eaves: int
) -> Tuple[List[Tuple[int, int, int, int]], Tuple[int, int]]:
    """Left, top, right and bottom of the windows, and the columns and rows of panes of each."""
    rows, columns = shape
    storey, gap = rng.uniform(2.7, 3.6) * TEXELS, rng.uniform(0.6, 2.0) * TEXELS
    width, height = rng.uniform(0.8, 1.8) * TEXELS, rng.uniform(1.0, 1.8) * TEXELS
    panes = (int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    boxes = [
        (int(x), int(y), int(x + width), int(y + height))
        for y in np.arange(rows - 0.9 * TEXELS - height, eaves + 0.3 * TEXELS, -storey)
        for x in np.arange(gap * rng.uniform(0.4, 1.0), columns - 0.2 * TEXELS - width, width + gap)
        if rng.random() < 0.88
    ]
    return boxes, panes


def _window(
    look_rng: np.random.Generator,
    grey: np.ndarray,
    box: Tuple[int, int, int, int],
    frame: float,
    panes: Tuple[int, int],
    lights: float,
) -> None:
    """Draws a window; lights: probability that it is lit from inside."""
    left, top, right, bottom = box
    cv2.rectangle(grey, (left - BAR, top - BAR), (right + BAR, bottom + BAR), frame, -1)
    dark = look_rng.uniform(20, 110)
    if lights and look_rng.random() < lights:
        dark = look_rng.uniform(170, 230)
    glass = grey[top:bottom, left:right]
    glass[:] = np.linspace(dark + look_rng.uniform(0, 50), dark, len(glass))[:, None]
    glass += look_rng.uniform(3, 14) * smooth_noise(look_rng, *glass.shape, 0.15 * TEXELS)  # reflections
    if look_rng.random() < 0.4:  # a blind
        blind = glass[: int(len(glass) * look_rng.uniform(0.2, 0.8))]
        blind[:] = look_rng.uniform(100, 220)
        blind[:: int(0.05 * TEXELS)] -= 25
    for i in range(1, panes[0]):
        x = left + i * (right - left) // panes[0]
        cv2.line(grey, (x, top), (x, bottom), frame, BAR // 2 + 1)
    for i in range(1, panes[1]):
        y = top + i * (bottom - top) // panes[1]
        cv2.line(grey, (left, y), (right, y), frame, BAR // 2 + 1)
    sill = grey[bottom + BAR : bottom + 2 * BAR, left - BAR : right + BAR]
    sill[:] = np.clip(frame + 25, 0, 255)
    grey[bottom + 2 * BAR : bottom + 3 * BAR, left - BAR : right + BAR] *= 0.7


def _pipe(rng: np.random.Generator, grey: np.ndarray) -> None:
    """Rain pipe from the gutter to the ground."""
    x, width = int(rng.choice([0.04, 0.95]) * grey.shape[1]), int(0.09 * TEXELS)
    grey[:, x : x + width] = rng.uniform(60, 190) + 40 * np.sin(np.linspace(0, np.pi, width))
    grey[int(1.5 * TEXELS) :: int(2 * TEXELS), x - 2 : x + width + 2] = 60


def _door(rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = grey.shape
    left = rng.uniform(0.5 * TEXELS, max(0.6 * TEXELS, columns - 2 * TEXELS))
    width = rng.uniform(0.9, 1.6) * TEXELS
    top = rows - 2.3 * TEXELS
    cv2.rectangle(grey, (int(left), int(top)), (int(left + width), rows), float(rng.uniform(20, 230)), -1)
    inner = [(left + 0.15 * width, top + 0.2 * TEXELS), (left + 0.85 * width, top + 1.1 * TEXELS)]
    corners = [tuple(map(int, corner)) for corner in inner]
    cv2.rectangle(grey, *corners, float(rng.uniform(20, 230)), int(0.06 * TEXELS))
    door = grey[int(top) :, int(left) : int(left + width)]
    door += 4 * rough_noise(rng, *door.shape)


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
    cv2.putText(grey, word, at, cv2.FONT_HERSHEY_DUPLEX, 0.4 * TEXELS / 22, float(ink), TEXELS // 24)


def _poster(rng: np.random.Generator, look_rng: np.random.Generator, grey: np.ndarray) -> None:
    rows, columns = grey.shape
    left, top = int(rng.uniform(0.1, 0.8) * columns), max(0, int(rows - 2.0 * TEXELS))
    if rng.random() > 0.5:
        return
    poster = look_rng.uniform(30, 220) + 40 * smooth_noise(look_rng, TEXELS, int(0.7 * TEXELS), 0.15 * TEXELS)
    part = grey[top : top + TEXELS, left : left + poster.shape[1]]
    part[:] = poster[: part.shape[0], : part.shape[1]]

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Textures of a building: walls with what hangs on them, posters, markers, pillars, floor and ceiling.

uint8 grey levels; 255 reflects all light. A texture's left and right edges are the centres of its first and
last column.
"""

from typing import Callable, Tuple

import cv2
import numpy as np

import sextant

TEXELS = 160.0  # per metre, of walls
HEIGHT = 2.6  # of walls, metres
WALL, DADO, SKIRTING = 178, 160, 70  # grey levels: of the wall, of its lower part, and of the skirting board
INK, PAPER = 15.0, 232.0  # grey levels of a printed marker
FINE = 4  # pixels per module of a marker before it is put on a wall
PLANE_TEXELS, PLANE_SIDE = 128.0, 512  # of floor and ceiling: per metre, and side of the repeating texture

Painter = Callable[[np.ndarray, np.random.Generator, float], None]


def bare_wall(width: float) -> np.ndarray:
    """A wall without anything on it, the same everywhere (rows, columns). :param width: metres"""
    rows, columns = texels(HEIGHT) + 1, texels(width) + 1
    wall = np.full((rows, columns), WALL, np.uint8)
    wall[-texels(1.0) :] = DADO
    wall[-texels(1.0) : -texels(0.96)] = SKIRTING
    wall[-texels(0.1) :] = SKIRTING
    return wall


def texels(metres: float) -> int:
    """Texels of a length on a wall."""
    return round(metres * TEXELS)


def poster(wall: np.ndarray, rng: np.random.Generator, centre: float) -> None:
    """A poster with a picture, shapes and lines of text. :param centre: column"""
    rows, columns = texels(rng.uniform(0.6, 0.9)), texels(rng.uniform(0.45, 0.65))
    sheet = np.full((rows, columns), rng.uniform(190, 245), np.float32)
    cells = rng.uniform(10, 240, rng.integers(4, 10, 2)).astype(np.float32)
    kind = cv2.INTER_NEAREST if rng.random() < 0.5 else cv2.INTER_CUBIC
    top, left = rows // 10, columns // 10
    size = (columns - 2 * left, rows // 2 - top)
    sheet[top : top + size[1], left : left + size[0]] = cv2.resize(cells, size, interpolation=kind)
    for _ in range(rng.integers(2, 6)):
        at = tuple(rng.integers((0, 0), (columns, rows)).tolist())  # OpenCV 4.5 takes no list
        cv2.circle(sheet, at, int(rng.integers(6, 22)), rng.uniform(10, 240), -1, cv2.LINE_AA)
    for row in range(rows * 6 // 10, rows - 8, int(rng.integers(9, 16))):
        words = "".join(rng.choice(list("aeioknrstmhlp  "), 24))
        write(sheet, words, (6, row), rng.uniform(0.3, 0.5))
    cv2.rectangle(sheet, (0, 0), (columns - 1, rows - 1), rng.uniform(20, 120), 3)
    paste(wall, np.clip(sheet, 0, 255).astype(np.uint8), centre, texels(rng.uniform(0.8, 1.0)))


def door(wall: np.ndarray, rng: np.random.Generator, centre: float) -> None:
    """A closed door with its frame, handle and number. :param centre: column"""
    leaf = np.full((texels(2.02), texels(0.96)), 105, np.uint8)
    cv2.rectangle(leaf, (0, 0), (leaf.shape[1] - 1, leaf.shape[0] - 1), 60, 8)
    cv2.circle(leaf, (texels(0.86), texels(1.0)), 6, 225, -1, cv2.LINE_AA)
    cv2.rectangle(leaf, (texels(0.35), texels(0.3)), (texels(0.61), texels(0.4)), 220, -1)
    write(leaf, str(rng.integers(100, 400)), (texels(0.37), texels(0.385)), 0.5)
    paste(wall, leaf, centre, wall.shape[0] - leaf.shape[0])


def board(wall: np.ndarray, rng: np.random.Generator, centre: float) -> None:
    """A pinboard with sheets of paper. :param centre: column"""
    sheet = np.full((texels(0.9), texels(1.3)), 120, np.uint8)
    for _ in range(rng.integers(5, 12)):
        paper = np.full((texels(0.26), texels(0.19)), int(rng.integers(180, 250)), np.uint8)
        for row in range(6, paper.shape[0] - 4, int(rng.integers(4, 8))):
            paper[row : row + 2, 4 : int(rng.integers(10, paper.shape[1] - 2))] = 60
        across, down = rng.uniform((0.1, 0.0), (0.9, 0.6)) * sheet.shape[::-1]
        paste(sheet, paper, across, int(down))
    cv2.rectangle(sheet, (0, 0), (sheet.shape[1] - 1, sheet.shape[0] - 1), 80, 6)
    paste(wall, sheet, centre, texels(0.8))


def shelf(wall: np.ndarray, rng: np.random.Generator, centre: float) -> None:
    """Shelves with books. :param centre: column"""
    sheet = np.full((texels(1.1), texels(1.2)), 90, np.uint8)
    for bottom in range(texels(0.34), sheet.shape[0], texels(0.36)):
        at = texels(0.03)
        while at < sheet.shape[1] - texels(0.08):
            wide, high = texels(rng.uniform(0.025, 0.06)), texels(rng.uniform(0.16, 0.3))
            sheet[bottom - high : bottom, at : at + wide - 1] = rng.integers(30, 225)
            at += wide
        sheet[bottom : bottom + texels(0.02)] = 60
    paste(wall, sheet, centre, texels(1.4))


PAINTERS: Tuple[Painter, ...] = (poster, poster, board, shelf, door)


def paste(wall: np.ndarray, sheet: np.ndarray, centre: float, top: int) -> None:
    """Puts a sheet on a wall, in place; what does not fit is cut off.

    :param centre: column of its middle. :param top: its first row
    """
    left = round(centre - 0.5 * sheet.shape[1])
    first, last = max(left, 0), min(left + sheet.shape[1], wall.shape[1])
    rows = min(sheet.shape[0], wall.shape[0] - top)
    if first < last:
        wall[top : top + rows, first:last] = sheet[:rows, first - left : last - left]


def write(sheet: np.ndarray, words: str, at: Tuple[int, int], size: float) -> None:
    """Writes dark letters, in place.

    :param at: column and row of their lower left corner. :param size: scale of the font
    """
    cv2.putText(sheet, words, at, cv2.FONT_HERSHEY_SIMPLEX, size, 40, 1, cv2.LINE_AA)


def print_marker(wall: np.ndarray, family: str, number: int, size: float, at: Tuple[float, float]) -> None:
    """Puts a printed marker with a white rim on a wall, in place, exactly at its place.

    :param size: edge length, metres
    :param at: column and row of its centre
    """
    modules, begin, end = sextant.marker_image(family, number)
    sheet = np.float32(np.pad(np.where(modules < 128, INK, PAPER), 1, constant_values=PAPER))
    sheet = cv2.resize(sheet, None, fx=FINE, fy=FINE, interpolation=cv2.INTER_NEAREST)
    scale = size * TEXELS / (FINE * (end - begin))
    middle = FINE * (1 + 0.5 * (begin + end)) - 0.5  # of the marker, in the sheet
    to_wall = np.array([[scale, 0, at[0] - scale * middle], [0, scale, at[1] - scale * middle]])
    size_of_wall = wall.shape[::-1]
    painted = cv2.warpAffine(sheet, to_wall, size_of_wall)
    opaque = cv2.warpAffine(np.ones_like(sheet), to_wall, size_of_wall)
    wall[:] = np.rint(painted + (1 - opaque) * wall).astype(np.uint8)


def pillar(bands: int, tone: float) -> np.ndarray:
    """A round pillar with light bands (rows, columns). :param tone: grey level"""
    across = np.linspace(-0.98, 0.98, 48, dtype=np.float32)
    round_ = np.tile(tone * (0.55 + 0.45 * np.sqrt(1 - across**2)), (256, 1))
    for band in range(bands):
        round_[40 + 50 * band : 56 + 50 * band] *= 1.5
    return np.clip(round_, 0, 255).astype(np.uint8)


def floor_texture() -> np.ndarray:
    """Tiles of half a metre, (PLANE_SIDE, PLANE_SIDE), repeating."""
    rng = np.random.default_rng(11)
    tones = np.kron(rng.normal(118, 9, (8, 8)), np.ones((64, 64)))
    tones[::64], tones[:, ::64] = 70, 70
    return np.clip(tones + rng.normal(0, 4, tones.shape), 0, 255).astype(np.uint8)


def ceiling_texture() -> np.ndarray:
    """Panels of half a metre with a lamp every 2 m along x and y, (PLANE_SIDE, PLANE_SIDE), repeating."""
    tones = np.full((PLANE_SIDE, PLANE_SIDE), 205, np.uint8)
    tones[::64], tones[:, ::64] = 150, 150
    for x in range(0, PLANE_SIDE, 256):
        tones[32:96, x + 16 : x + 144] = 255
        tones[288:352, x + 16 : x + 144] = 255
    return tones

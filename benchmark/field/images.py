# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images with known markers: rendered ones, photos, and views of a camera that moves in front of a photo."""

from pathlib import Path
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Tuple

import cv2
import numpy as np
from libapriltag import apriltag_detector
from real_data import Photos

import sextant
from markers.detector_speed import true_corners
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.room_markers import default_map

TAGS = "tag36h11"
SIZES = {"640 x 480": (640, 480), "1280 x 720": (1280, 720)}
NEAR = 0.25  # sides; distance between the centres of a detected and a known marker
STEP = 8.0  # pixels an image by which the camera in front of a photo moves
ZOOM = 0.15  # relative change of a photo's scale


class KnownImage(NamedTuple):
    """An image and the centre and side of the markers in it, pixels. There may be more, of the same ids."""

    grey: np.ndarray
    markers: List[Tuple[int, np.ndarray, float]]  # id, centre (2,), side
    ids: FrozenSet[int]  # of all markers of the scene

    def count(self, found: list) -> int:
        """Number of known markers among detections, each with an id and corners (4, 2)."""
        return sum(
            any(each.id == id and _distance(each, centre) < NEAR * side for each in found)
            for id, centre, side in self.markers
        )

    def wrong(self, found: list) -> int:
        """Number of detections with an id that no marker of the scene has."""
        return sum(each.id not in self.ids for each in found)


def _distance(found, centre: np.ndarray) -> float:
    return float(np.linalg.norm(np.asarray(found.corners).mean(axis=0) - centre))


def rendered(size: Tuple[int, int], count: int, seed: int = 1, **camera) -> Iterator[KnownImage]:
    """A drive in the simulated room: images and all markers that face the camera and are inside the image.

    :param camera: fields of DriveParams with other values
    """
    drive = SimulatedDrive(DriveParams(width=size[0], height=size[1], seed=seed, **camera), default_map(TAGS))
    model = sextant.CameraModel(drive.calibration)
    for frame in drive.frames(count):
        corners = {id: each for id, each in true_corners(drive, model, frame).items() if each is not None}
        yield KnownImage(frame.image, known_inside(corners, size), frozenset(range(len(drive.map.markers))))


def known_inside(corners: Dict[int, np.ndarray], size: Tuple[int, int]) -> list:
    """Markers, as in KnownImage, whose corners (4, 2) are clockwise and inside an image."""
    return [
        (id, each.mean(axis=0), side_of(each))
        for id, each in corners.items()
        if (each > 0).all() and (each < np.array(size) - 1).all() and cv2.contourArea(_float(each), True) > 0
    ]


def side_of(corners: np.ndarray) -> float:
    """Mean side (pixels) of corners (4, 2)."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).mean())


def _float(corners: np.ndarray) -> np.ndarray:
    return np.asarray(corners, dtype=np.float32)


def tag_photos(data: Path) -> Dict[str, KnownImage]:
    """The crowded photos with AprilTags, by name. :raises OSError: they are not there"""
    photos = Photos(data / "markers/photos")
    if not photos.outdoors():
        raise FileNotFoundError(f"{photos.folder} has no photos with lists of their tags")
    return {name: _known_photo(photos.image(name), tags) for name, tags in photos.outdoors().items()}


def _known_photo(image: np.ndarray, tags: list) -> KnownImage:
    markers = [(id, corners.mean(axis=0), side_of(corners)) for id, corners in tags]
    return KnownImage(_grey(image), markers, frozenset(id for id, _ in tags))


def _grey(image: np.ndarray) -> np.ndarray:
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def views_of(photo: KnownImage, count: int, size: Tuple[int, int], scale: float) -> Iterator[KnownImage]:
    """What a camera sees that moves parallel to a photo and to and fro, along a figure of eight.

    :param scale: pixels of the image for a pixel of the photo
    """
    height, width = photo.grey.shape
    room = np.maximum(0.5 * np.array([width, height]) - 0.4 * np.array(size) / scale, 20.0)
    for k in range(count):
        t = k * STEP / scale / (2.2 * room.max())
        centre = 0.5 * np.array([width, height]) + room * [np.sin(t), np.sin(2 * t)]
        zoom = scale * (1 + ZOOM * np.sin(0.7 * t))
        M = np.c_[zoom * np.eye(2), 0.5 * np.array(size) - zoom * centre]
        grey = cv2.warpAffine(photo.grey, M, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        yield KnownImage(grey, _moved(photo.markers, M, zoom, size), photo.ids)


def _moved(markers: list, M: np.ndarray, zoom: float, size: Tuple[int, int]) -> list:
    moved = [(id, M[:, :2] @ centre + M[:, 2], zoom * side) for id, centre, side in markers]
    limit = np.array(size)
    return [
        (id, at, side)
        for id, at, side in moved
        if (at > 0.7 * side).all() and (at < limit - 0.7 * side).all()
    ]


def blurred(image: np.ndarray, length: int, angle: float) -> np.ndarray:
    """Image of a camera that moves by length pixels in a direction (radians) during its exposure."""
    steps = np.linspace(-0.5 * length, 0.5 * length, 4 * length + 1)
    kernel = np.zeros((length + 3, length + 3), np.float32)
    for x, y in zip(steps * np.cos(angle), steps * np.sin(angle)):
        _splat(kernel, 0.5 * (length + 2) + x, 0.5 * (length + 2) + y)
    return cv2.filter2D(image, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)


def _splat(kernel: np.ndarray, x: float, y: float) -> None:
    i, j = int(x), int(y)
    u, v = x - i, y - j
    kernel[j : j + 2, i : i + 2] += np.outer([1 - v, v], [1 - u, u])


def darkened(image: np.ndarray, brightness: float) -> np.ndarray:
    """The image with another brightness, rounded to grey levels."""
    return np.round(brightness * image).astype(np.uint8)


def libapriltag(decimate: float = 1.0, min_margin: float = 0.0):
    """Function that finds tag36h11 in an image with libapriltag itself.

    :param min_margin: minimum decision margin of the tags, grey levels
    """
    find = apriltag_detector(TAGS, decimate)
    return lambda image: [tag for tag in find(image) if tag.decision_margin >= min_margin]

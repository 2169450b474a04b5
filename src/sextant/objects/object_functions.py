# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detection and localization of objects in single images, without ROS; also sextant.detect_objects() and
sextant.locate_objects()."""

import os
import threading
from functools import lru_cache
from typing import Dict, List, NamedTuple, Optional

import numpy as np

import sextant
from sextant.objects.depth_encodings import metres_of
from sextant.objects.object_kinds import KINDS, ObjectKind
from sextant.objects.object_locator import ObjectLocator, ObjectLocatorParams
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams

LOADED = 4  # networks that stay in memory
_LOCK = threading.Lock()  # of the networks, which are not thread-safe


class FoundObject(NamedTuple):
    """An object in an image."""

    class_name: str  # its class
    score: float  # [0, 1]
    box: np.ndarray  # (4,) left, top, right, bottom, pixels; (0, 0) is the corner of the first pixel
    position: Optional[np.ndarray] = None  # (2,) in the robot's frame, metres; None: not located
    covariance: Optional[np.ndarray] = None  # (2, 2) of the position, square metres


def detect_objects(image: np.ndarray, model: str = "", **settings) -> List[FoundObject]:
    """Objects in a colour image, the one with the highest score first. May be called from any thread.

    :param image: uint8 (height, width, 3), RGB
    :param model: ONNX file; empty: the network that comes with Sextant
    :param settings: other fields of YoloParams, for instance confidence=0.5
    :raises OSError: the model cannot be read
    :raises ValueError: it cannot be used, or the image is not uint8 (height, width, 3)
    """
    path = str(model or shipped_model())
    settings = {name: tuple(each) if isinstance(each, list) else each for name, each in settings.items()}
    try:
        params = YoloParams(model=path, **settings)
    except TypeError as error:
        raise ValueError(f"settings: {error}") from None
    with _LOCK:
        detector = _detector(params, os.stat(path).st_mtime_ns)
        found = detector.detect(image)
    names = (detector.classes[number] for number in found.classes)
    return [FoundObject(*each) for each in zip(names, found.scores.tolist(), found.boxes)]


def locate_objects(
    image: np.ndarray,
    depth: np.ndarray,
    camera: "sextant.CameraModel",
    T_base_camera: np.ndarray,
    depth_camera: Optional["sextant.CameraModel"] = None,
    T_camera_depth: Optional[np.ndarray] = None,
    kinds: Optional[Dict[str, ObjectKind]] = None,
    model: str = "",
    **settings,
) -> List[FoundObject]:
    """Objects in a colour image with their positions, where the depth image shows them.

    :param image: uint8 (height, width, 3), RGB
    :param depth: (height, width) uint16 millimetres or float32 metres; 0 or NaN: unknown
    :param camera: of the colour image
    :param T_base_camera: (4, 4) from the colour camera's optical frame to the robot's frame (z up), metres
    :param depth_camera: of the depth image; None: the depth image is aligned with the colour image
    :param T_camera_depth: (4, 4) from the depth to the colour camera's optical frame; None: they are the same
    :param kinds: shape and radius by class name; None: those of the ball task
    :param model: as in detect_objects(), and settings
    :raises OSError: the model cannot be read
    :raises ValueError: an image does not fit its camera, or as detect_objects()
    """
    found = detect_objects(image, model, **settings)
    known = KINDS if kinds is None else kinds
    _check_size(image, camera)
    T = np.eye(4) if T_camera_depth is None else T_camera_depth
    locator = ObjectLocator(ObjectLocatorParams(), camera, depth_camera or camera, T)
    which = [number for number, each in enumerate(found) if each.class_name in known]
    boxes = np.array([found[number].box for number in which]).reshape(-1, 4)
    places = locator.locate(
        metres_of(depth), boxes, [known[found[number].class_name] for number in which], T_base_camera
    )
    for number, place in zip(which, places):
        if place is not None:
            found[number] = found[number]._replace(position=place.position, covariance=place.covariance)
    return found


def _check_size(image: np.ndarray, camera: "sextant.CameraModel") -> None:
    size = (image.shape[1], image.shape[0])
    if size != camera.size:
        sizes = f"{size[0]} × {size[1]} pixels, its camera {camera.size[0]} × {camera.size[1]}"
        raise ValueError(f"the image has {sizes}")


@lru_cache(maxsize=LOADED)
def _detector(params: YoloParams, changed: int) -> YoloDetector:
    """A detector of the content of the model's file at the time of its last change, nanoseconds."""
    del changed  # a part of the key
    return YoloDetector(params)

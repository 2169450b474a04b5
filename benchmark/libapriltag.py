# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""libapriltag itself, called through its C interface with its own defaults, for comparison."""

import ctypes
from ctypes import POINTER, Structure, c_bool, c_double, c_float, c_int, c_int32, c_size_t, c_ubyte
from ctypes.util import find_library
from typing import Callable, List, NamedTuple

import numpy as np

CORNERS = [3, 2, 1, 0]  # indices of its corners, which start at the bottom left, in the order of Detection
CENTRE = 0.5  # pixels; its origin is the corner of the first pixel


class _Detector(Structure):
    """The first fields of apriltag_detector_t, as in libapriltag 0.10 to 3.4."""

    _fields_ = [
        ("nthreads", c_int),
        ("quad_decimate", c_float),
        ("quad_sigma", c_float),
        ("refine_edges", c_bool),
        ("decode_sharpening", c_double),
    ]


class _Image(Structure):
    _fields_ = [("width", c_int32), ("height", c_int32), ("stride", c_int32), ("buf", POINTER(c_ubyte))]


class _Detection(Structure):
    _fields_ = [
        ("family", ctypes.c_void_p),
        ("id", c_int),
        ("hamming", c_int),
        ("decision_margin", c_float),
        ("H", ctypes.c_void_p),
        ("c", c_double * 2),
        ("p", (c_double * 2) * 4),
    ]


class _Array(Structure):
    _fields_ = [
        ("size_of_each", c_size_t),
        ("size", c_int),
        ("capacity", c_int),
        ("data", POINTER(POINTER(_Detection))),
    ]


class Tag(NamedTuple):
    """A tag as libapriltag reports it."""

    id: int
    corners: np.ndarray  # (4, 2), the order and the pixels of sextant.Detection
    hamming: int
    decision_margin: float


def apriltag_detector(
    family: str, decimate: float = 2.0, max_hamming: int = 2
) -> Callable[[np.ndarray], List[Tag]]:
    """Returns a function that finds the tags in an image (height, width) uint8, with one thread.

    :param decimate: its quad_decimate; 2 is its default
    :raises OSError: there is no libapriltag
    """
    library = _library()
    detector = library.apriltag_detector_create()
    detector.contents.quad_decimate, detector.contents.nthreads = decimate, 1
    create = getattr(library, f"{family}_create")
    create.restype = ctypes.c_void_p
    library.apriltag_detector_add_family_bits(detector, create(), max_hamming)

    def find(image: np.ndarray) -> List[Tag]:
        grey = np.ascontiguousarray(image)
        view = _Image(grey.shape[1], grey.shape[0], grey.strides[0], grey.ctypes.data_as(POINTER(c_ubyte)))
        found = library.apriltag_detector_detect(detector, ctypes.byref(view))
        tags = [_tag(found.contents.data[i].contents) for i in range(found.contents.size)]
        library.apriltag_detections_destroy(found)
        return tags

    return find


def _tag(detection: _Detection) -> Tag:
    corners = np.array([list(corner) for corner in detection.p])[CORNERS] - CENTRE
    return Tag(detection.id, corners, detection.hamming, detection.decision_margin)


def _library() -> ctypes.CDLL:
    library = ctypes.CDLL(find_library("apriltag") or "libapriltag.so.3")
    library.apriltag_detector_create.restype = POINTER(_Detector)
    library.apriltag_detector_detect.restype = POINTER(_Array)
    library.apriltag_detector_detect.argtypes = [POINTER(_Detector), POINTER(_Image)]
    library.apriltag_detections_destroy.argtypes = [POINTER(_Array)]
    library.apriltag_detector_add_family_bits.argtypes = [POINTER(_Detector), ctypes.c_void_p, c_int]
    return library

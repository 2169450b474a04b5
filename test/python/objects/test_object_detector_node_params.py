# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What parameters of the node become for the library, and which are refused."""

import numpy as np
import pytest
from made_yolo import constant_network

from sextant.base.strict_params import parse_params
from sextant.nodes.objects.object_detector_node_params import ObjectDetectorParams
from sextant.objects.colour_detector import ColourParams
from sextant.objects.object_kinds import KINDS
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloParams

CUP = {"cup": {"hue": 150, "hue_tolerance": 10, "min_saturation": 100, "min_value": 50}}


def params(**values):
    return parse_params(ObjectDetectorParams, values, "/object_detector")


def test_defaults_are_those_of_the_library():
    assert (params().network, params().colours) == (YoloParams(), ColourParams())
    assert list(params().colours.ranges) == list(KINDS)


def test_a_name_that_both_detectors_have_is_set_in_both():
    assert (params(max_objects=7).network.max_objects, params(max_objects=7).colours.max_objects) == (7, 7)


def test_colours_need_no_model():
    assert params(detector="colour").create_detector().classes == list(KINDS)
    detector = params(detector="colour", ranges=CUP, min_area=60, max_objects=1).create_detector()
    image = np.zeros((100, 100, 3), np.uint8)
    for low, high in ((5, 15), (20, 27), (40, 80)):
        image[low:high, low:high] = (200, 0, 200)
    assert detector.classes == ["cup"]
    assert detector.detect(image).boxes.tolist() == [[40, 40, 80, 80]]


def test_a_network_has_what_was_set(tmp_path):
    answer = np.zeros((1, 6, 84), np.float32)
    answer[0, :, 0], answer[0, :, 1] = (32, 32, 20, 20, 0.3, 0), (33, 32, 20, 20, 0, 0.2)
    model = constant_network(tmp_path / "net.onnx", [answer])
    detector = params(model=model, backend="opencv", classes=["a", "b"], confidence=0.1).create_detector()
    image = np.zeros((64, 64, 3), np.uint8)
    assert detector.classes == ["a", "b"] and len(detector.detect(image).boxes) == 2
    values = {"model": model, "backend": "opencv", "classes": ["a", "b"], "confidence": 0.1}
    assert len(params(**values, class_agnostic=True).create_detector().detect(image).boxes) == 1
    assert (
        len(params(**values, class_agnostic=True, max_overlap=0.99).create_detector().detect(image).boxes)
        == 2
    )
    assert len(params(**values, max_objects=1).create_detector().detect(image).boxes) == 1


@pytest.mark.skipif(not shipped_model().exists(), reason="no model is shipped")
def test_without_a_model_it_is_the_one_that_is_shipped():
    assert params(backend="opencv").create_detector().classes == list(KINDS)


@pytest.mark.parametrize(
    "values, reason",
    [
        ({"detector": "nose"}, "/object_detector/detector: must be one of network, colour, is 'nose'"),
        ({"backend": "tpu"}, "/object_detector/backend: must be one of auto, onnxruntime, opencv, is 'tpu'"),
        ({"threads": -1}, r"/object_detector/threads: must be within \[0, 256\]"),
        ({"confidence": 1.0}, r"/object_detector/confidence: must be within \[0.01, 0.99\]"),
        ({"classes": "ball"}, "/object_detector/classes: must be a list"),
        ({"ranges": {"cup": {**CUP["cup"], "hue": 190}}}, "/object_detector/ranges: ranges/cup/hue: must be"),
        ({"min_fill": 2.0}, r"/object_detector/min_fill: must be within \[0, 1\]"),
        ({"modell": "x"}, "/object_detector/modell: unknown parameter; did you mean model"),
    ],
)
def test_what_cannot_be_is_refused_with_its_full_name(values, reason):
    with pytest.raises(ValueError, match=reason):
        params(**values)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detectors in ONNX files: made ones with known outputs, and invalid ones."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from made_yolo import ConvolvedDetector, constant_network

from sextant.objects.yolo_detector import YoloDetector, YoloParams

needs_onnxruntime = pytest.mark.skipif(
    importlib.util.find_spec("onnxruntime") is None, reason="no onnxruntime (optional)"
)
BACKENDS = ["opencv", pytest.param("onnxruntime", marks=needs_onnxruntime)]
NAMES = ["ball", "pillar", "cat"]
PLACES = 64 + 16 + 4  # of 64 × 64 pixels


def answer(*rows):
    """A full export's (1, 7, places) with boxes x, y, width, height, class, score."""
    made = np.zeros((1, 4 + len(NAMES), PLACES), np.float32)
    for place, (*box, number, score) in enumerate(rows):
        made[0, :4, place], made[0, 4 + number, place] = box, score
    return made


def detector(model, backend="opencv", **settings):
    return YoloDetector(YoloParams(str(model), backend, **settings), 1)


def noise(width=96, height=96, seed=3):
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), np.uint8)


@pytest.mark.parametrize("backend", BACKENDS)
class TestEveryBackend:
    def test_boxes_are_pixels_of_the_picture(self, tmp_path, backend):
        """64 × 48 of the input's 64 × 64 are the image's 640 × 480."""
        rows = (32, 32, 20, 10, 0, 0.9), (10, 12, 8, 16, 2, 0.6), (50, 40, 5, 5, 1, 0.39)
        network = detector(constant_network(tmp_path / "net.onnx", [answer(*rows)], names=NAMES), backend)
        found = network.detect(noise(640, 480))
        assert (network.classes, network.size) == (NAMES, (64, 64))
        assert found.boxes == pytest.approx(np.array([[220, 190, 420, 290], [60, 0, 140, 120]]), abs=1e-3)
        assert found.scores == pytest.approx([0.9, 0.6]) and found.classes.tolist() == [0, 2]
        assert list(network.seconds) == ["letter box", "network", "decoding"]
        assert all(0 < seconds < 5 for seconds in network.seconds.values())

    def test_boxes_that_leave_the_picture_are_as_far_apart_as_in_it(self, tmp_path, backend):
        """Their intersection over union is 0.47, but 1 where they are clipped."""
        rows = (24, 24, 80, 80, 0, 0.9), (40, 40, 80, 80, 0, 0.8)
        network = detector(constant_network(tmp_path / "net.onnx", [answer(*rows)], names=NAMES), backend)
        found = network.detect(noise(64, 64))
        assert found.scores == pytest.approx([0.9, 0.8])
        assert found.boxes == pytest.approx(np.array([[0, 0, 64, 64], [0, 0, 64, 64]]), abs=1e-3)

    def test_parameters_select_the_detections(self, tmp_path, backend):
        rows = (
            (32, 32, 20, 20, 0, 0.9),
            (33, 32, 20, 20, 1, 0.8),
            (32, 33, 20, 20, 0, 0.7),
            (9, 9, 8, 8, 2, 0.2),
        )
        model = constant_network(tmp_path / "net.onnx", [answer(*rows)], names=NAMES)
        for settings, expected in (
            ({}, [0.9, 0.8]),
            ({"class_agnostic": True}, [0.9]),
            ({"max_overlap": 0.95}, [0.9, 0.8, 0.7]),
            ({"confidence": 0.15}, [0.9, 0.8, 0.2]),
            ({"confidence": 0.15, "max_objects": 1}, [0.9]),
            ({"confidence": 0.95}, []),
        ):
            assert detector(model, backend, **settings).detect(noise()).scores == pytest.approx(
                expected
            ), settings

    def test_boxes_and_scores_of_64_classes_apart(self, tmp_path, backend):
        boxes, scores = np.zeros((1, 64, PLACES)), np.full((1, 64, PLACES), -9.0)
        boxes[0, [1, 17, 33, 49], 0], scores[0, 63, 0] = 40.0, 2.0  # one cell of 8 pixels to every side
        model = constant_network(tmp_path / "net.onnx", [boxes, scores], names=[str(k) for k in range(64)])
        found = detector(model, backend).detect(noise(64, 64))
        assert found.boxes == pytest.approx(np.array([[0, 0, 12, 12]]), abs=1e-4)
        assert found.classes.tolist() == [63]

    def test_a_network_of_another_number_of_classes_is_refused(self, tmp_path, backend):
        model = constant_network(tmp_path / "net.onnx", [answer()])
        with pytest.raises(
            ValueError, match=r"net.onnx: outputs 1×7×84; 2 classes and 64×64 pixels need 1×6×84"
        ):
            detector(model, backend, classes=("a", "b"))

    def test_a_network_with_outputs_that_are_not_finite_is_refused(self, tmp_path, backend):
        model = constant_network(tmp_path / "net.onnx", [answer((1, 1, 1, 1, 1, np.nan))], names=NAMES)
        with pytest.raises(ValueError, match=r"net.onnx: outputs are not finite"):
            detector(model, backend)

    @pytest.mark.parametrize("kept", [0.02, 0.5, 0.9, 0.999])
    def test_a_file_that_is_cut_short_is_refused(self, tmp_path, backend, kept):
        whole = Path(ConvolvedDetector(NAMES).write_cut(tmp_path / "whole.onnx")).read_bytes()
        (tmp_path / "net.onnx").write_bytes(whole[: int(kept * len(whole))])
        with pytest.raises(ValueError, match="net.onnx: is no ONNX file"):
            detector(tmp_path / "net.onnx", backend)


@needs_onnxruntime
@pytest.mark.parametrize("write", [ConvolvedDetector.write_cut, ConvolvedDetector.write_grids])
def test_both_runtimes_return_the_same(tmp_path, write):
    model = write(ConvolvedDetector(NAMES), tmp_path / "net.onnx")
    one, other = (
        detector(model, name, max_overlap=1.0).detect(noise()) for name in ("opencv", "onnxruntime")
    )
    assert len(one.boxes) > 20
    assert_same(one, other)


@needs_onnxruntime
def test_a_full_export_detects_what_the_cut_graph_detects(tmp_path):
    made = ConvolvedDetector(NAMES)
    models = made.write_cut(tmp_path / "cut.onnx"), made.write_full(tmp_path / "full.onnx")
    one, other = (detector(model, "onnxruntime").detect(noise()) for model in models)
    assert len(one.boxes) > 10
    assert_same(one, other)


def assert_same(one, other):
    assert one.classes.tolist() == other.classes.tolist()
    assert one.scores == pytest.approx(other.scores, abs=1e-3)
    assert one.boxes == pytest.approx(other.boxes, abs=1e-3)


# ---- what the model takes, and its classes ----------------------------------------------------------------


def test_an_input_asked_for_as_240_is_256(tmp_path):
    places = 32 * 32 + 16 * 16 + 8 * 8
    made = np.zeros((1, 7, places), np.float32)
    open_sizes = constant_network(tmp_path / "open.onnx", [made], (1, 3, None, None), NAMES)
    fixed = constant_network(tmp_path / "fixed.onnx", [made], (1, 3, 256, 256), NAMES)
    assert detector(fixed, size=240).size == detector(fixed).size == (256, 256)
    with pytest.raises(ValueError, match="size is 320, but .*fixed.onnx takes a width of 256"):
        detector(fixed, size=320)
    with pytest.raises(ValueError, match="size must be set: .*open.onnx takes any width"):
        detector(open_sizes)


@needs_onnxruntime
def test_a_model_of_any_size_takes_what_is_asked(tmp_path):
    made = np.zeros((1, 7, 32 * 32 + 16 * 16 + 8 * 8), np.float32)
    model = constant_network(tmp_path / "net.onnx", [made], (1, 3, None, None), NAMES)
    assert detector(model, "onnxruntime", size=240).size == (256, 256)
    with pytest.raises(
        ValueError, match="net.onnx: outputs 1×7×1344; 3 classes and 160×160 pixels need 1×7×525"
    ):
        detector(model, "onnxruntime", size=160)


@pytest.mark.parametrize(
    "taken, reason",
    [
        ((1, 1, 64, 64), "takes 1 channel; it must take red, green and blue"),
        ((1, 3, 60, 64), "takes a height of 60; it must be a multiple of 32"),
        ((2, 3, 64, 64), r"takes 2×3×64×64; it must take 1×\(1 or 3\)×height×width, float32"),
    ],
)
def test_what_takes_something_else_is_refused(tmp_path, taken, reason):
    model = constant_network(tmp_path / "net.onnx", [answer()], taken, NAMES)
    with pytest.raises(ValueError, match="net.onnx: " + reason):
        detector(model)


@pytest.mark.parametrize(
    "names, classes, reason",
    [
        (None, (), "net.onnx: contains no class names: set classes"),
        (NAMES, ("a", "b"), "classes are 2 names, but .*net.onnx has 3: ball, pillar, cat"),
        ("{0: 'ball', 2: 'cat'}", (), "net.onnx: its class names cannot be read: {0: 'ball', 2"),
        ("ball, cat", (), "net.onnx: its class names cannot be read: ball, cat"),
        ("5", (), "net.onnx: its class names cannot be read: 5"),
        ("{0: 'ball'}", (), "net.onnx: outputs 1×7×84; 1 classes and 64×64 pixels need 1×5×84"),
    ],
)
def test_classes_that_cannot_be_are_refused(tmp_path, names, classes, reason):
    model = constant_network(tmp_path / "net.onnx", [answer()], names=names)
    with pytest.raises(ValueError, match=reason):
        detector(model, classes=classes)


def test_names_of_the_settings_count(tmp_path):
    model = constant_network(tmp_path / "net.onnx", [answer()], names=NAMES)
    assert detector(model, classes=("a", "b", "c")).classes == ["a", "b", "c"]


@pytest.mark.parametrize(
    "settings, reason",
    [
        ({"model": ""}, "model is empty, it must be an ONNX file"),
        ({"backend": "tpu"}, "backend: must be one of auto, onnxruntime, opencv, is 'tpu'"),
        ({"confidence": 0.0}, "confidence: must be within .*, is 0.0"),
        ({"max_overlap": 1.5}, "max_overlap: must be within .*, is 1.5"),
        ({"size": -1}, "size: must be within .*, is -1"),
        ({"max_objects": 0}, "max_objects: must be within .*, is 0"),
    ],
)
def test_settings_that_cannot_be_are_refused(settings, reason):
    with pytest.raises(ValueError, match=reason):
        YoloDetector(YoloParams(**{"model": "net.onnx", **settings}))


def test_a_file_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(OSError, match="no.onnx"):
        detector(tmp_path / "no.onnx")

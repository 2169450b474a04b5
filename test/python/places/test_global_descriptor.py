# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Vectors of whole pictures, by networks whose answer has a closed form."""

import dataclasses
import importlib.util
import re
import sys
from pathlib import Path

import cv2
import numpy as np
import onnx
import pytest
from made_network import CELLS, pooling_network, projection_network, root_network, written
from onnx import TensorProto, helper

from sextant.places.global_descriptor import GlobalDescriptor, GlobalDescriptorParams

WITHOUT_ONNXRUNTIME = importlib.util.find_spec("onnxruntime") is None
BACKENDS = [
    "opencv",
    pytest.param(
        "onnxruntime", marks=pytest.mark.skipif(WITHOUT_ONNXRUNTIME, reason="no onnxruntime (optional)")
    ),
]
PLAIN = {"mean": (0.0, 0.0, 0.0), "std": (1.0, 1.0, 1.0)}
GREY = {"channels": "grey", "mean": (0.0,), "std": (1.0,)}


def noise(size=(96, 64), seed=1):
    return np.random.default_rng(seed).integers(0, 256, (size[1], size[0], 3), np.uint8)


def unit(vector):
    return vector / np.linalg.norm(vector)


def cells(image):
    """What pooling_network() makes of it."""
    means = cv2.resize(image.astype(np.float32), (CELLS, CELLS), interpolation=cv2.INTER_AREA)
    return unit(np.atleast_3d(means).transpose(2, 0, 1).ravel())


@pytest.mark.parametrize("backend", BACKENDS)
class TestEveryBackend:
    def test_a_vector_is_what_the_network_makes(self, tmp_path, backend):
        model = pooling_network(tmp_path / "net.onnx")
        descriptor = GlobalDescriptor(GlobalDescriptorParams(model, backend, **PLAIN))
        vector = descriptor.describe(noise())
        assert descriptor.size == (96, 64)
        assert vector.dtype == np.float32 and vector == pytest.approx(cells(noise()[:, :, ::-1]), abs=1e-6)
        assert np.linalg.norm(vector) == pytest.approx(1.0, abs=1e-6)

    def test_means_and_deviations_are_of_channels_from_0_to_1(self, tmp_path, backend):
        matrix = np.random.default_rng(2).normal(size=(5, 3)).astype(np.float32)
        settings = GlobalDescriptorParams(
            projection_network(tmp_path / "net.onnx", matrix), backend, 40, 30, "BGR"
        )
        vector = GlobalDescriptor(settings).describe(noise((40, 30)))
        colour = (noise((40, 30)).mean((0, 1)) / 255 - [0.485, 0.456, 0.406]) / [0.229, 0.224, 0.225]
        assert vector == pytest.approx(unit(matrix @ colour), abs=1e-5)

    def test_the_same_gives_the_same(self, tmp_path, backend):
        matrix = np.random.default_rng(3).normal(size=(64, 3)).astype(np.float32)
        settings = GlobalDescriptorParams(
            projection_network(tmp_path / "net.onnx", matrix), backend, 320, 240
        )
        vectors = [
            GlobalDescriptor(settings, threads).describe(noise((640, 480)))
            for threads in (1, 1, 4)
            for _ in range(3)
        ]
        assert all(np.array_equal(vector, vectors[0]) for vector in vectors)

    def test_a_network_that_makes_no_number_is_refused(self, tmp_path, backend):
        model = root_network(tmp_path / "net.onnx")
        with pytest.raises(ValueError, match="net.onnx: its output is not finite"):
            GlobalDescriptor(GlobalDescriptorParams(model, backend, mean=(1.0, 1.0, 1.0))).describe(noise())

    def test_a_network_that_makes_a_picture_is_refused(self, tmp_path, backend):
        nodes = [helper.make_node("Relu", ["image"], ["vector"])]
        model = written(tmp_path / "net.onnx", nodes, (1, 3, 32, 48), (1, 3, 32, 48))
        with pytest.raises(ValueError, match="net.onnx: its output is 1×3×32×48, it must be one vector"):
            GlobalDescriptor(GlobalDescriptorParams(model, backend))

    def test_a_network_that_cannot_be_run_is_refused(self, tmp_path, backend):
        nodes = [helper.make_node("Reshape", ["image", "shape"], ["vector"])]
        weights = [("shape", np.array([1, 7], np.int64))]
        model = written(tmp_path / "net.onnx", nodes, (1, 3, 8, 8), weights=weights)
        with pytest.raises(ValueError, match=r"net.onnx: .* cannot run it \("):
            GlobalDescriptor(GlobalDescriptorParams(model, backend))


@pytest.fixture
def pooling(tmp_path):
    return pooling_network(tmp_path / "net.onnx")


def test_an_image_of_any_size_is_made_to_fit(pooling):
    descriptor = GlobalDescriptor(GlobalDescriptorParams(pooling, **PLAIN))
    image = cv2.GaussianBlur(noise((480, 640)), (0, 0), 20)
    assert descriptor.describe(image) == pytest.approx(cells(image[:, :, ::-1]), abs=2e-3)  # of bytes


def test_grey_is_three_channels_that_are_the_same(pooling):
    descriptor = GlobalDescriptor(GlobalDescriptorParams(pooling))
    grey = noise()[:, :, 0]
    assert np.array_equal(descriptor.describe(grey), descriptor.describe(cv2.merge([grey] * 3)))


def test_a_network_of_one_channel_sees_grey(tmp_path):
    model = pooling_network(tmp_path / "net.onnx", channels=1)
    descriptor = GlobalDescriptor(GlobalDescriptorParams(model, **GREY))
    grey = cv2.cvtColor(noise(), cv2.COLOR_BGR2GRAY)
    for image in (grey, noise()):
        assert descriptor.describe(image) == pytest.approx(cells(grey), abs=1e-6)


def test_an_image_of_which_the_network_makes_zeros_has_no_direction(pooling):
    black = np.zeros((64, 96), np.uint8)
    assert not GlobalDescriptor(GlobalDescriptorParams(pooling, **PLAIN)).describe(black).any()


@pytest.mark.parametrize(
    "image", [np.zeros((8, 8), np.float32), np.zeros((8, 8, 4), np.uint8), np.zeros(8, np.uint8)]
)
def test_what_is_no_image_is_refused(pooling, image):
    with pytest.raises(ValueError, match="must be uint8, grey or BGR"):
        GlobalDescriptor(GlobalDescriptorParams(pooling)).describe(image)


@pytest.mark.parametrize(
    "changed, reason",
    [
        ({"model": ""}, "model is empty, it must be an ONNX file"),
        ({"backend": "tensorrt"}, "backend: must be one of auto, onnxruntime, opencv, is 'tensorrt'"),
        ({"channels": "HSV"}, "channels: must be one of RGB, BGR, grey, is 'HSV'"),
        ({"width": -1}, r"width: must be within \[0, 4096\], is -1"),
        ({"height": 5000}, r"height: must be within \[0, 4096\], is 5000"),
        ({"mean": (0.5,)}, r"mean: must be one number per channel, is \(0.5,\)"),
        ({"std": (1.0, 0.0, 1.0)}, r"std: each must be within \[1e-06, 1000\], is \(1.0, 0.0, 1.0\)"),
        ({"width": 100}, "width is 100, but .*net.onnx takes 96"),
        (GREY, "net.onnx: takes 3 channels; grey is 1"),
    ],
)
def test_settings_that_cannot_be_are_refused(pooling, changed, reason):
    with pytest.raises(ValueError, match=reason):
        GlobalDescriptor(GlobalDescriptorParams(**{"model": pooling, **changed}))


def test_a_network_for_any_size_needs_one(tmp_path):
    model = projection_network(tmp_path / "net.onnx", np.ones((2, 3), np.float32))
    with pytest.raises(ValueError, match="height must be set: .*net.onnx takes any"):
        GlobalDescriptor(GlobalDescriptorParams(model, width=64))


def two_inputs(path):
    nodes = [
        helper.make_node("Add", ["image", "other"], ["sum"]),
        helper.make_node("Flatten", ["sum"], ["vector"]),
    ]
    written(path, nodes, (1, 3, 8, 8), more_inputs=[("other", (1, 3, 8, 8))])


def two_outputs(path):
    pooling_network(path)
    model = onnx.load(str(path))
    model.graph.output.append(helper.make_tensor_value_info("cells", TensorProto.FLOAT, (1, 3, 8, 8)))
    onnx.save(model, str(path))


def channels_last(path):
    written(path, [helper.make_node("Flatten", ["image"], ["vector"])], (1, 64, 96, 3))


def half_precision(path):
    nodes = [helper.make_node("Flatten", ["image"], ["vector"])]
    written(path, nodes, (1, 3, 8, 8), elements=TensorProto.FLOAT16)


def torn(path):
    written(path, [helper.make_node("Conv", ["image", "filter"], ["vector"], kernel_shape=[1, 1])])


def weights_elsewhere(path):
    projection_network(path, np.ones((400, 3), np.float32))
    model = onnx.load(str(path))
    onnx.external_data_helper.convert_model_to_external_data(model, location="weights")
    onnx.save(model, str(path))


@pytest.mark.parametrize(
    "write, reason",
    [
        (lambda path: path.write_bytes(b"no network"), "net.onnx: is no ONNX file"),
        (lambda path: path.write_bytes(b""), "net.onnx: is no ONNX file, or there is no network in it"),
        (two_inputs, r"net.onnx: has 2 inputs \(image, other\); it must have one"),
        (two_outputs, r"net.onnx: has 2 outputs \(vector, cells\); it must have one"),
        (channels_last, r"net.onnx: takes 1×64×96×3; it must take 1×\(1 or 3\)×height×width, float32"),
        (half_precision, "must take .*, float32"),
        (torn, "net.onnx: its Conv works on filter, which is not there"),
        (weights_elsewhere, "net.onnx: its weights are in another file"),
    ],
)
def test_a_file_that_is_no_such_network_is_refused(tmp_path, write, reason):
    write(tmp_path / "net.onnx")
    with pytest.raises(ValueError, match=reason):
        GlobalDescriptor(GlobalDescriptorParams(str(tmp_path / "net.onnx")))


def test_a_file_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        GlobalDescriptor(GlobalDescriptorParams(str(tmp_path / "net.onnx")))


def test_an_operator_that_opencv_lacks_is_named_with_what_to_do(tmp_path):
    nodes = [helper.make_node("Det", ["image"], ["vector"])]
    model = written(tmp_path / "net.onnx", nodes, (1, 3, 8, 8))
    reason = "net.onnx: OpenCV's dnn lacks the operator Det; install onnxruntime: python3 -m pip install"
    with pytest.raises(ValueError, match=reason):
        GlobalDescriptor(GlobalDescriptorParams(model, "opencv"))


def test_without_onnxruntime_opencv_is_taken(pooling, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "onnxruntime", None)  # cannot be imported
    assert len(GlobalDescriptor(GlobalDescriptorParams(pooling)).describe(noise())) == 3 * CELLS * CELLS
    with pytest.raises(
        ValueError, match="backend is onnxruntime: .*; install onnxruntime: python3 -m pip install"
    ):
        GlobalDescriptor(GlobalDescriptorParams(pooling, "onnxruntime"))


def test_the_page_names_every_setting():
    page = (Path(__file__).resolve().parents[3] / "doc/how_to/place_networks.md").read_text()
    table = page.partition("| field |")[2].partition("\n\n")[0]
    named = [name for line in table.splitlines()[2:] for name in re.findall(r"`(\w+)`", line.split("|")[1])]
    assert named == [field.name for field in dataclasses.fields(GlobalDescriptorParams)]

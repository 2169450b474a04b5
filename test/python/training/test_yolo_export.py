# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Networks in ONNX files, run by OpenCV, against PyTorch; and what they cost."""

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is optional: apt install python3-torch")

from sextant.objects.yolo_model import YoloModel  # noqa: E402
from sextant.training.yolo_export import export, exported_weights  # noqa: E402
from sextant.training.yolo_network import YoloNetwork  # noqa: E402

NAMES = ["ball", "goal", "cat"]


@pytest.fixture(scope="module")
def network():
    torch.manual_seed(3)
    made = YoloNetwork(len(NAMES))
    for each in made.modules():
        if isinstance(each, torch.nn.BatchNorm2d):
            each.running_mean.normal_(0.0, 0.1)
            each.running_var.uniform_(0.5, 2.0)
    return made.eval()


def test_an_exported_network_takes_images_of_any_size(network, tmp_path):
    export(network, tmp_path / "net.onnx", 64, NAMES)
    for size in (0, 64, 128):
        model = YoloModel(str(tmp_path / "net.onnx"), "opencv", (), size, 1)
        assert (model.classes, model.size) == (NAMES, (size or 64,) * 2)
        image = np.random.default_rng(size).random((1, 3, *model.size), np.float32)
        with torch.no_grad():
            expected = network(torch.from_numpy(image)).numpy()
        np.testing.assert_allclose(model.run(image)[0], expected, atol=1e-4)


def test_an_exported_network_has_all_weights(network, tmp_path):
    export(network, tmp_path / "net.onnx", 64, NAMES)
    found = exported_weights(tmp_path / "net.onnx")
    for name, each in network.state_dict().items():
        if not name.endswith("num_batches_tracked"):
            np.testing.assert_array_equal(found[name].numpy(), each.numpy())


@pytest.mark.parametrize(("kind", "size", "most"), [("small", 160, 0.5), ("large", 256, 2.0)])
def test_operations_of_an_image(kind, size, most):
    """Two for each multiplication of a convolution, 1e9."""
    made, counts = YoloNetwork(4, kind).eval(), []

    def count(layer, _inputs, output):
        counts.append(2e-9 * output.numel() * layer.weight[0].numel())

    for each in made.modules():
        if isinstance(each, torch.nn.Conv2d):
            each.register_forward_hook(count)
    with torch.no_grad():
        made(torch.zeros(1, 3, size, size))
    assert 0.7 * most < sum(counts) <= most

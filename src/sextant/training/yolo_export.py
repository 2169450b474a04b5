# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Export of a trained network to ONNX. Needs PyTorch."""

import io
import warnings
from inspect import signature
from pathlib import Path
from typing import List

import onnx
import torch

from sextant.base.atomic_file import atomic_file
from sextant.base.onnx_trim import trimmed
from sextant.training.yolo_network import YoloNetwork


def export(network: YoloNetwork, path: Path, size: int, names: List[str]) -> None:
    """Writes an ONNX file with an input of one image, size × size pixels, and the class names as metadata.

    :raises OSError: the file cannot be written
    """
    exported, image = io.BytesIO(), torch.zeros(1, 3, size, size)
    # From PyTorch 2.9 on, the default exporter needs onnxscript; 1.13 has no such option.
    by_tracing = {"dynamo": False} if "dynamo" in signature(torch.onnx.export).parameters else {}
    # Sizes become constants of the graph: OpenCV's dnn computes none.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", torch.jit.TracerWarning)
        warnings.simplefilter("ignore", DeprecationWarning)  # of the older exporter
        torch.onnx.export(
            network.eval(), image, exported, opset_version=12, input_names=["images"],
            output_names=["output"], **by_tracing,
        )  # fmt: skip
    # Without copies of equal weights, which OpenCV 4.6 does not read.
    model = trimmed(onnx.load_from_string(exported.getvalue()), ["output"], (1, 3, size, size))
    entry = model.metadata_props.add()
    entry.key, entry.value = "names", repr(dict(enumerate(names)))
    with atomic_file(path, "wb") as file:
        file.write(model.SerializeToString())

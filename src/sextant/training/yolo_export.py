# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a trained network to an ONNX file, and reads its weights from there. Needs PyTorch."""

import io
import warnings
from inspect import signature
from pathlib import Path
from typing import Dict, List

import onnx
import torch
from onnx import numpy_helper
from torch import Tensor

from sextant.base.atomic_file import atomic_file
from sextant.base.onnx_model import load_model
from sextant.training.yolo_network import YoloNetwork

SIDES = {2: "height", 3: "width"}  # of the input image, which may have any size


def export(network: YoloNetwork, path: Path, size: int, names: List[str]) -> None:
    """Writes an ONNX file with an input of one image of any size, and class names and usual size as metadata.
    Normalizations stay separate, so that another training can start from it.

    :param size: side of the images that it was trained with, pixels
    :raises OSError: the file cannot be written
    """
    exported, image = io.BytesIO(), torch.zeros(1, 3, size, size)
    # From PyTorch 2.9 on, the default exporter needs onnxscript; 1.13 has no such option.
    by_tracing = {"dynamo": False} if "dynamo" in signature(torch.onnx.export).parameters else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of the older exporter
        torch.onnx.export(
            network.eval(), image, exported, opset_version=12, input_names=["images"],
            output_names=["output"], dynamic_axes={"images": SIDES}, do_constant_folding=False,
            training=torch.onnx.TrainingMode.PRESERVE, **by_tracing,
        )  # fmt: skip
    model = onnx.load_from_string(exported.getvalue())
    for key, value in {"names": repr(dict(enumerate(names))), "imgsz": repr([size, size])}.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value
    with atomic_file(path, "wb") as file:
        file.write(model.SerializeToString())


def exported_weights(path: Path) -> Dict[str, Tensor]:
    """Weights of a network that export() wrote, by their names in YoloNetwork.

    :raises OSError, ValueError: see load_model()
    """
    graph = load_model(str(path)).graph
    weights = {each.name: torch.tensor(numpy_helper.to_array(each)) for each in graph.initializer}
    for node in graph.node:  # equal weights are written once
        if node.op_type == "Identity" and node.input[0] in weights:
            weights[node.output[0]] = weights[node.input[0]]
    return weights

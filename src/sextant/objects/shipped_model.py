# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The network that comes with Sextant, trained by train_object_detector on simulated images."""

from pathlib import Path


def shipped_model() -> Path:
    """Path of the ONNX file; its classes are those of sextant.objects.object_kinds.KINDS."""
    return Path(__file__).resolve().parent / "models/objects.onnx"

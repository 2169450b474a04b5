# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A YOLO network in an ONNX file, with its metadata."""

from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from sextant.base.onnx_model import ImageInput, load_model, model_info, open_network
from sextant.objects.detections import Detections
from sextant.objects.yolo_heads import HeadOutputs, cut_at_heads, find_heads, metadata_value
from sextant.objects.yolo_output import HeadLayout, decoded, decoded_heads

MULTIPLE = 32  # pixels; exporters round the input size up: 240 is exported as 256
IGNORED = {
    "segment": "masks are ignored, the boxes are used",
    "pose": "keypoints are ignored, the boxes are used",
    "obb": "oriented boxes are replaced by the upright boxes around them",
}  # by task in the metadata


class YoloModel:
    """Runs a network and decodes its outputs. Not thread-safe.

    A network whose heads are known is cut there, and its boxes are decoded here, whatever follows there.
    The outputs of others are decoded as they are.
    """

    def __init__(self, path: str, backend: str, classes: Sequence[str], size: int, threads: int):
        """:param classes: names; empty: from the model. :param size: of the input, pixels; 0: from the model

        :raises OSError: the file cannot be read
        :raises ValueError: the model cannot be used, and what to do
        """
        self._path = path
        model = load_model(path)
        info = model_info(path, model, may_be_half=True)
        self._metadata = info.metadata
        task = info.metadata.get("task", "")
        self.notes: List[str] = [IGNORED[task]] if task in IGNORED else []  # for the user
        self.classes = self._class_names(classes)  # in the order of the network's scores
        self.size = self._input_size(info.input, size)  # width and height of the input, pixels
        heads = find_heads(model, task)
        if heads and heads.classes != len(self.classes):
            self._refuse_classes(heads, classes)
            heads = None
        self._one_to_one = bool(heads and heads.is_one_to_one)
        self._layout = heads and self._head_layout(heads)
        content = self._cut(model, heads) if heads else None
        self._network = open_network(path, backend, threads, content)

    @property
    def is_end_to_end(self) -> bool:
        """Whether the network predicts each object once, so that suppression would only remove neighbours."""
        return self._one_to_one or bool(metadata_value(self._metadata, "end2end"))

    @property
    def is_interpolated(self) -> bool:
        """Whether it was trained with images that were reduced by linear interpolation, not by means."""
        return self._metadata.get("author") == "Ultralytics"

    def run(self, blob: np.ndarray) -> List[np.ndarray]:
        """Outputs for float32 (1, 3, height, width), RGB in [0, 1].

        :raises ValueError: the network cannot be run
        """
        return self._network(blob)

    def decoded(self, outputs: List[np.ndarray], threshold: float) -> Detections:
        """Detections in pixels of the input, with scores from the threshold on, the highest first.

        :raises ValueError: the outputs do not fit
        """
        try:
            if self._layout:
                return decoded_heads(outputs[0][0], self.size, self._layout, threshold)
            return decoded(outputs, self.size, len(self.classes), threshold)
        except ValueError as error:
            raise ValueError(f"{self._path}: {error}") from None

    def _refuse_classes(self, heads: HeadOutputs, given: Sequence[str]) -> None:
        """Heads with more outputs than classes may be of an open vocabulary: the network is run whole."""
        count = len(self.classes)
        if given or heads.classes < count:
            what = f"detects {heads.classes} classes, there are {count} class names"
            raise ValueError(f"{self._path}: {what}")
        self.notes.append(f"the network is run as a whole: its heads have {heads.classes} outputs")

    def _head_layout(self, heads: HeadOutputs) -> HeadLayout:
        angles = heads.angles and ("radians" if self._metadata.get("head") == "OBB26" else "logits")
        return HeadLayout(heads.bins, heads.classes, angles or "", self.is_end_to_end)

    def _cut(self, model: Any, heads: HeadOutputs) -> Optional[bytes]:
        """The network that ends at its heads; None: it has operators that are not known here."""
        try:
            return cut_at_heads(model, heads, self.size).SerializeToString()
        except ValueError as error:
            self.notes.append(f"the network is run as a whole: {error}")
            self._layout = None
            return None

    def _class_names(self, given: Sequence[str]) -> List[str]:
        """Class names from the parameters or the model."""
        known = self._written_names()
        if given and known and len(given) != len(known):
            listed = ", ".join(known)
            raise ValueError(f"classes are {len(given)} names, but {self._path} has {len(known)}: {listed}")
        classes = list(given) or known
        if not classes:
            raise ValueError(f"{self._path}: contains no class names: set classes")
        return classes

    def _written_names(self) -> List[str]:
        """Class names from the model; empty: it has none."""
        written = self._metadata.get("names", "")
        names = metadata_value(self._metadata, "names")
        try:
            return [str(names[i]) for i in range(len(names))] if written else []
        except (KeyError, TypeError):
            what = f"its class names cannot be read: {written[:80]}"
            raise ValueError(f"{self._path}: {what}") from None

    def _input_size(self, taken: ImageInput, size: int) -> Tuple[int, int]:
        if taken.channels not in (0, 3):
            raise ValueError(
                f"{self._path}: takes {taken.channels} channel; it must take red, green and blue"
            )
        usual = metadata_value(self._metadata, "imgsz")  # height and width
        height, width = usual if isinstance(usual, list) and len(usual) == 2 else (0, 0)
        return self._side("width", taken.width, size, width), self._side("height", taken.height, size, height)

    def _side(self, name: str, fixed: int, given: int, usual: int) -> int:
        """One side of the input.

        :param fixed: pixels in the model, 0: any. :param given: by the user, 0: none
        :param usual: of its export, if it takes any
        """
        asked = -(-given // MULTIPLE) * MULTIPLE
        if fixed % MULTIPLE:
            what = f"takes a {name} of {fixed}; it must be a multiple of {MULTIPLE}"
            raise ValueError(f"{self._path}: {what}")
        if fixed and asked not in (0, fixed):
            raise ValueError(f"size is {given}, but {self._path} takes a {name} of {fixed}")
        found = fixed or asked or usual
        if not isinstance(found, int) or found <= 0 or found % MULTIPLE:
            raise ValueError(f"size must be set: {self._path} takes any {name}")
        return found

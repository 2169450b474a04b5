# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""One learned vector of a whole picture, by a network that the user brings; see doc/place_networks.md."""

from dataclasses import dataclass
from typing import Tuple

import cv2
import numpy as np

from sextant.base.onnx_model import BACKENDS, ImageInput, only, open_network, read_model
from sextant.base.strict_params import ParamError, StrictParams, each, one_of, param, within

LARGEST = 4096  # pixels
BACKEND_NAMES = ("auto", *BACKENDS)
IMAGENET_MEAN, IMAGENET_STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)  # of R, G, B

# how many there are, and how they are made of BGR and of grey; None: as it is
CHANNELS = {
    "RGB": (3, cv2.COLOR_BGR2RGB, cv2.COLOR_GRAY2RGB),
    "BGR": (3, None, cv2.COLOR_GRAY2BGR),
    "grey": (1, cv2.COLOR_BGR2GRAY, None),
}


@dataclass(frozen=True)
class GlobalDescriptorParams(StrictParams):
    """Which network, and what it takes: (pixel / 255 - mean) / std of every channel."""

    model: str = ""  # ONNX file
    backend: str = param("auto", one_of(*BACKEND_NAMES))  # auto: onnxruntime where it is installed
    width: int = param(0, within(0, LARGEST))  # pixels; 0: as the model says
    height: int = param(0, within(0, LARGEST))  # pixels; 0: as the model says
    channels: str = param("RGB", one_of(*CHANNELS))
    mean: Tuple[float, ...] = param(IMAGENET_MEAN, each(within(-1000, 1000)))  # one a channel
    std: Tuple[float, ...] = param(IMAGENET_STD, each(within(1e-6, 1000)))  # one a channel

    def __post_init__(self) -> None:
        for name in ("mean", "std"):  # lists have no hash
            object.__setattr__(self, name, tuple(getattr(self, name)))
        super().__post_init__()
        count = CHANNELS[self.channels][0]
        for name in ("mean", "std"):
            if len(getattr(self, name)) != count:
                raise ParamError(name, "must be one number a channel", getattr(self, name))


class GlobalDescriptor:
    """Makes one vector of a picture, always the same of the same. Not thread-safe."""

    def __init__(self, params: GlobalDescriptorParams, threads: int = 0):
        """:param threads: 0: as many as OpenCV has

        :raises OSError: the model cannot be read
        :raises ValueError: a setting out of range, or no model of one image to one vector, and what to do
        """
        if not params.model:
            raise ValueError("model is empty, it must be an ONNX file")
        self._params = params
        facts = read_model(params.model)
        only(params.model, "output", facts.outputs)
        self.size = _size(params, facts.input)  # width and height, pixels
        self._network = open_network(params.model, params.backend, threads or cv2.getNumThreads())
        noise = np.random.default_rng(0).integers(0, 256, (*self.size[::-1], 3), np.uint8)
        made = self._network(self._blob(noise))[0]
        if made.size < 2 or made.size != max(made.shape):
            shape = "×".join(str(size) for size in made.shape)
            reason = f"{params.model}: makes {shape} of a picture, it must make one vector"
            raise ValueError(f"{reason}; does it end in pooling?")

    def describe(self, image: np.ndarray) -> np.ndarray:
        """A float32 vector (d,) of length 1; of length 0, where the model makes nothing but zeros.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :raises ValueError: it is not; or the model makes what is no number of it
        """
        if image.dtype != np.uint8 or image.ndim not in (2, 3) or image.shape[2:] not in ((), (3,)):
            raise ValueError(f"a picture is {image.dtype} {image.shape}, it must be uint8, grey or BGR")
        vector = self._network(self._blob(image))[0].ravel().astype(np.float64)
        length = np.linalg.norm(vector)
        if not np.isfinite(length):
            raise ValueError(
                f"{self._params.model}: makes what is no number of a picture; mean, std right?"
            )
        return (vector / (length or 1.0)).astype(np.float32)

    def _blob(self, image: np.ndarray) -> np.ndarray:
        count, of_bgr, of_grey = CHANNELS[self._params.channels]
        small = cv2.resize(image, self.size, interpolation=cv2.INTER_AREA)
        conversion = of_bgr if image.ndim == 3 else of_grey
        if conversion is not None:
            small = cv2.cvtColor(small, conversion)
        parts = small.reshape(self.size[1], self.size[0], count) / 255.0
        normal = (parts - self._params.mean) / self._params.std
        return np.ascontiguousarray(normal.transpose(2, 0, 1)[np.newaxis], np.float32)


def _size(params: GlobalDescriptorParams, taken: ImageInput) -> Tuple[int, int]:
    """Width and height of what the model takes."""
    count = CHANNELS[params.channels][0]
    if taken.channels not in (0, count):
        raise ValueError(f"{params.model}: takes {taken.channels} channels; {params.channels} is {count}")
    for name, wanted, fixed in (
        ("width", params.width, taken.width),
        ("height", params.height, taken.height),
    ):
        if wanted and fixed and wanted != fixed:
            raise ValueError(f"{name} is {wanted}, but {params.model} takes {fixed}")
        if not wanted and not fixed:
            raise ValueError(f"{name} must be set: {params.model} takes any")
    return params.width or taken.width, params.height or taken.height

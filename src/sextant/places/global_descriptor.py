# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Global image descriptor by a network that the user supplies; see doc/how_to/place_networks.md."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Tuple

import cv2
import numpy as np

from sextant.base.onnx_model import BACKENDS, ImageInput, only, open_network, read_model
from sextant.base.strict_params import Check, ParamError, StrictParams, each, one_of, param, within

MAX_SIDE = 4096  # maximum width and height of the input, pixels
BACKEND_NAMES = ("auto", *BACKENDS)
IMAGENET_MEAN, IMAGENET_STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)  # of R, G, B

# number of channels, OpenCV's conversions from BGR and from grey; None: no conversion
CHANNELS = {
    "RGB": (3, cv2.COLOR_BGR2RGB, cv2.COLOR_GRAY2RGB),
    "BGR": (3, None, cv2.COLOR_GRAY2BGR),
    "grey": (1, cv2.COLOR_BGR2GRAY, None),
}


@dataclass(frozen=True)
class GlobalDescriptorParams(StrictParams):
    """The network and its input, which is (pixel / 255 - mean) / std per channel."""

    model: str = ""  # ONNX file
    backend: str = param(
        "auto", "inference library; auto: onnxruntime if installed, else opencv", one_of(*BACKEND_NAMES)
    )
    width: int = param(0, "input width of the network; 0: that of the model", within(0, MAX_SIDE), "px")
    height: int = param(0, "input height of the network; 0: that of the model", within(0, MAX_SIDE), "px")
    channels: str = param("RGB", "channels of the input and their order", one_of(*CHANNELS))
    mean: Tuple[float, ...] = param(
        IMAGENET_MEAN,
        "subtracted from pixel values in [0, 1]",
        Check("one per channel", each(within(-1000, 1000))),
    )
    std: Tuple[float, ...] = param(
        IMAGENET_STD, "the differences are divided by it", Check("one per channel", each(within(1e-6, 1000)))
    )

    def __post_init__(self) -> None:
        for name in ("mean", "std"):  # lists are not hashable, and the parameters are a cache key
            object.__setattr__(self, name, tuple(getattr(self, name)))
        super().__post_init__()
        count = CHANNELS[self.channels][0]
        for name in ("mean", "std"):
            if len(getattr(self, name)) != count:
                raise ParamError(name, "must be one number per channel", getattr(self, name))


class GlobalDescriptor:
    """Computes one vector per image, deterministically. Not thread-safe."""

    def __init__(self, params: GlobalDescriptorParams, threads: int = 0):
        """:param threads: number of threads; 0: as many as OpenCV uses

        :raises OSError: the model cannot be read
        :raises ValueError: a parameter is out of range, or the model does not map one image to one vector
        """
        if not params.model:
            raise ValueError("model is empty, it must be an ONNX file")
        self._params = params
        model = read_model(params.model)
        only(params.model, "output", model.outputs)
        self.size = _size(params, model.input)  # width and height, pixels
        self._network = open_network(params.model, params.backend, threads or cv2.getNumThreads())
        # a trial run, as the file need not declare the shape of the output
        noise = np.random.default_rng(0).integers(0, 256, (*self.size[::-1], 3), np.uint8)
        output = self._network(self._blob(noise))[0]
        if output.size < 2 or output.size != max(output.shape):
            shape = "×".join(str(size) for size in output.shape)
            reason = f"{params.model}: its output is {shape}, it must be one vector"
            raise ValueError(f"{reason}; does the network end in pooling?")

    def describe(self, image: np.ndarray) -> np.ndarray:
        """Returns a float32 unit vector (d,); zeros if the model's output is zero.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :raises ValueError: for any other image, or if the output is not finite
        """
        if image.dtype != np.uint8 or image.ndim not in (2, 3) or image.shape[2:] not in ((), (3,)):
            raise ValueError(f"the image is {image.dtype} {image.shape}, it must be uint8, grey or BGR")
        vector = self._network(self._blob(image))[0].ravel().astype(np.float64)
        length = np.linalg.norm(vector)
        if not np.isfinite(length):
            raise ValueError(f"{self._params.model}: its output is not finite; are mean and std right?")
        return (vector / (length or 1.0)).astype(np.float32)

    def _blob(self, image: np.ndarray) -> np.ndarray:
        """The network's input, float32 (1, channels, height, width)."""
        count, from_bgr, from_grey = CHANNELS[self._params.channels]
        small = cv2.resize(image, self.size, interpolation=cv2.INTER_AREA)
        conversion = from_bgr if image.ndim == 3 else from_grey
        if conversion is not None:
            small = cv2.cvtColor(small, conversion)
        values = small.reshape(self.size[1], self.size[0], count) / 255.0
        normalized = (values - self._params.mean) / self._params.std
        return np.ascontiguousarray(normalized.transpose(2, 0, 1)[np.newaxis], np.float32)


def cached_descriptor(params: GlobalDescriptorParams) -> GlobalDescriptor:
    """The global descriptor, cached by this process until its file changes.

    :raises: as GlobalDescriptor()
    """
    status = Path(params.model).stat()
    return _loaded(params, (status.st_size, status.st_mtime_ns, status.st_ctime_ns), cv2.getNumThreads())


@lru_cache(maxsize=1)
def _loaded(params: GlobalDescriptorParams, _state: Tuple[int, int, int], threads: int) -> GlobalDescriptor:
    return GlobalDescriptor(params, threads)


def _size(params: GlobalDescriptorParams, model_input: ImageInput) -> Tuple[int, int]:
    """Width and height of the model's input, pixels."""
    count = CHANNELS[params.channels][0]
    if model_input.channels not in (0, count):
        raise ValueError(
            f"{params.model}: takes {model_input.channels} channels; {params.channels} is {count}"
        )
    for name in ("width", "height"):
        wanted, fixed = getattr(params, name), getattr(model_input, name)
        if wanted and fixed and wanted != fixed:
            raise ValueError(f"{name} is {wanted}, but {params.model} takes {fixed}")
        if not wanted and not fixed:
            raise ValueError(f"{name} must be set: {params.model} takes any")
    return params.width or model_input.width, params.height or model_input.height

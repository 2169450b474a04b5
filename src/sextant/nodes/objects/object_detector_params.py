# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node object_detector, and the detector that they mean."""

from dataclasses import dataclass
from typing import Any, Callable, Dict, List

from sextant.base.onnx_model import BACKENDS
from sextant.base.strict_params import one_of, param, within
from sextant.objects.colour_detector import RANGES, ColourDetector, ColourSettings, ranges_of
from sextant.objects.detection import Detector
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloSettings

_YOLO, _COLOUR = YoloSettings(), ColourSettings()


def _ranges(value: Dict[str, Any]) -> str:
    """For parse_params()."""
    try:
        ranges_of(value)
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ObjectDetectorParams:
    """How objects are found."""

    detector: str = param("network", one_of("network", "colour"))
    most: int = param(_YOLO.most, within(1, 10000))
    model: str = param("")  # ONNX file; empty: the one that comes with Sextant
    backend: str = param(_YOLO.backend, one_of("auto", *BACKENDS))
    threads: int = param(1, within(0, 256))  # of the network; 0: as many as there are cores
    classes: List[str] = param([])  # empty: as the model names them
    size: int = param(_YOLO.size, within(0, 4096))
    confidence: float = param(_YOLO.confidence, within(0.01, 0.99))
    overlap: float = param(_YOLO.overlap, within(0.01, 1.0))
    class_agnostic: bool = param(_YOLO.class_agnostic)
    ranges: Dict[str, Dict[str, Any]] = param(
        {name: colours._asdict() for name, colours in RANGES.items()}, _ranges
    )
    least_area: int = param(_COLOUR.least_area, within(1, 1000000))
    least_fill: float = param(_COLOUR.least_fill, within(0.0, 1.0))

    def opened(self) -> Detector:
        """The detector, ready.

        :raises OSError: the model cannot be read
        :raises ValueError: it cannot be used, and what to do
        """
        detectors: Dict[str, Callable[[], Detector]] = {"network": self._network, "colour": self._colours}
        return detectors[self.detector]()

    def _network(self) -> YoloDetector:
        settings = YoloSettings(
            self.model or str(shipped_model()), self.backend, tuple(self.classes), self.size,
            self.confidence, self.overlap, self.class_agnostic, self.most,
        )  # fmt: skip
        return YoloDetector(settings, self.threads)

    def _colours(self) -> ColourDetector:
        settings = ColourSettings(ranges_of(self.ranges), self.least_area, self.least_fill, self.most)
        return ColourDetector(settings)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node object_detector, and the detector that they mean."""

from dataclasses import dataclass, replace
from typing import Any, Callable, Dict

from sextant.base.strict_params import StrictParams, nested, one_of, param, within
from sextant.objects.colour_detector import RANGES, ColourDetector, ColourParams, ranges_of
from sextant.objects.detection import Detector
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams


def _ranges(value: Dict[str, Any]) -> str:
    """For parse_params()."""
    try:
        ranges_of(value)
    except ValueError as error:
        return str(error)
    return ""


@dataclass(frozen=True)
class ObjectDetectorParams(StrictParams):
    """How objects are found."""

    detector: str = param("network", one_of("network", "colour"))
    threads: int = param(1, within(0, 256))  # of the network; 0: as many as there are cores
    network: YoloParams = nested(YoloParams)  # without a model: the one that comes with Sextant
    ranges: Dict[str, Dict[str, Any]] = param(
        {name: colours._asdict() for name, colours in RANGES.items()}, _ranges
    )
    colours: ColourParams = nested(ColourParams, only=("least_area", "least_fill", "most"))

    def opened(self) -> Detector:
        """The detector, ready.

        :raises OSError: the model cannot be read
        :raises ValueError: it cannot be used, and what to do
        """
        detectors: Dict[str, Callable[[], Detector]] = {"network": self._network, "colour": self._colours}
        return detectors[self.detector]()

    def _network(self) -> YoloDetector:
        model = self.network.model or str(shipped_model())
        return YoloDetector(replace(self.network, model=model), self.threads)

    def _colours(self) -> ColourDetector:
        return ColourDetector(replace(self.colours, ranges=ranges_of(self.ranges)))

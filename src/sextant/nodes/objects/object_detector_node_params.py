# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node object_detector, and creation of its detector."""

from dataclasses import dataclass, replace

from sextant.base.strict_params import StrictParams, nested, one_of, param, within
from sextant.objects.colour_detector import ColourDetector, ColourParams
from sextant.objects.detections import Detector
from sextant.objects.shipped_model import shipped_model
from sextant.objects.yolo_detector import YoloDetector, YoloParams


@dataclass(frozen=True)
class ObjectDetectorParams(StrictParams):
    """Parameters of the node and of both detectors."""

    detector: str = param("network", "detection method", one_of("network", "colour"))
    threads: int = param(1, "threads of the network; 0: one per core", within(0, 256))
    network: YoloParams = nested(YoloParams)  # without a model: Sextant's own
    colours: ColourParams = nested(ColourParams)

    def create_detector(self) -> Detector:
        """Create the detector.

        :raises OSError: the model cannot be read
        :raises ValueError: the model does not fit, and what to do
        """
        if self.detector == "colour":
            return ColourDetector(self.colours)
        model = self.network.model or str(shipped_model())
        return YoloDetector(replace(self.network, model=model), self.threads)

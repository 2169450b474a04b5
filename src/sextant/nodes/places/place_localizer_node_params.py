# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the node place_localizer, and their conversion to those of the library."""

from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from sextant.base.strict_params import (
    ParamError,
    StrictParams,
    nested,
    not_empty,
    one_of,
    param,
    required,
    within,
)
from sextant.place_maps.place_map_file import read_place_map
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import VOTES
from sextant.places.place_method_params import PlaceMethodParams


@dataclass(frozen=True)
class PlaceLocalizerNodeParams(StrictParams):
    """Private parameters of the node."""

    map_file: str = required(
        "[place map](../how_to/place_map.md); its index is cached beside it as `MAP.index`", not_empty
    )
    wait_for_map: float = param(
        0.0, "maximum time to wait for the map file, if another node writes it", within(0.0, 3600.0), "s"
    )
    method: PlaceMethodParams = nested(PlaceMethodParams)
    use_odometry: bool = param(
        False,
        "subscribe to `odom`: predict the belief with the distance that odometry measures between two images",
    )
    use_rough_pose: bool = param(
        False,
        "subscribe to `rough_pose` and `rough_fix`: photos outside of the [region of a rough pose]"
        "(../how_to/places.md#rough-pose) are improbable",
    )
    same_camera: bool = param(
        False,
        "the map's photos were taken by the camera of the images, with the same size: the matches measure "
        "the heading of `pose`",
    )
    initialpose: str = param(
        "never", "when `initialpose` is published automatically", one_of("never", "relocalized")
    )
    compressed: bool = param(False, "subscribe to `image/compressed` instead of `image`")
    rate: float = param(
        0.0,
        "maximum rate of images whose place is recognized; others are dropped; 0: no limit",
        within(0.0, 1000.0),
        "Hz",
    )
    jobs: int = param(
        1, "number of processes that compute the descriptors of the map's photos", within(1, 256)
    )
    scheduler: str = param("", "`tcp://HOST:PORT` of a Dask cluster that computes them; empty: none")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.use_rough_pose and self.method.localization.mode == VOTES:
            raise ParamError("use_rough_pose", "is not possible with mode votes", self.use_rough_pose)

    def place_indexer(self, report: Callable[[str], None]) -> PlaceIndexer:
        """Reads the map.

        :param report: called with progress messages
        :raises OSError, ValueError: as sextant.place_maps.place_map_file.read_place_map()
        """
        path = Path(self.map_file)
        params = self.method.index_params()
        return PlaceIndexer(path, read_place_map(path), params, self.jobs, self.scheduler, report)

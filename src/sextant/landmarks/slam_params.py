# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of landmark SLAM by the flat names that the nodelet sextant/LandmarkSlam has for them.

Their defaults and ranges are those of the core; what the core does not know is in NodeletParams.
"""

from dataclasses import dataclass, field, make_dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any, Dict, List, Mapping, Tuple, Union

import numpy as np
import yaml

import sextant
from sextant.base.strict_params import Check, not_empty, one_of, param, parse_params, within

_FILTER = ("scale_sigma", "scale_drift", "clock_sigma")
_ODOMETRY = ("turn_by_turn", "turn_by_way", "way_by_way", "way_by_turn", "aside_by_way")
_ASSOCIATION = ("gate", "doubt", "margin", "density", "new_margin", "effort")
_SENSOR = ("max_range", "min_range", "field_of_view", "detection", "phantom", "width", "separation")

# Where in LandmarkSlamSettings a parameter is.
CORE_FIELDS: Dict[str, str] = {
    **{name: f"slam.filter.{name}" for name in _FILTER},
    **{name: f"timeline.odometry.{name}" for name in _ODOMETRY},
    **{name: f"timeline.{name}" for name in ("lag", "clock_offset")},
    **{name: f"slam.association.{name}" for name in _ASSOCIATION},
    **{f"candidate_{name}": f"slam.candidates.{name}" for name in ("gate", "sightings", "memory")},
    **{name: f"slam.sensor.{name}" for name in _SENSOR},
    **{f"match_{name}": f"slam.matching.{name}" for name in ("gate", "certainty", "present")},
    **{name: f"slam.{name}" for name in ("lost_after", "read_only")},
    **{name: f"markers.{name}" for name in ("decided", "corner_sigma", "tilt_sigma")},
}


def _three_or_none(values: List[float]) -> str:
    return "" if len(values) in (0, 3) else "must be x, y (m) and heading (rad)"


def _three_sigmas(values: List[float]) -> str:
    good = len(values) == 3 and all(0.0 < value <= 1000.0 for value in values)
    return "" if good else "must be three deviations within (0, 1000], of x, y (m) and heading (rad)"


def _topics(values: List[str]) -> str:
    return "" if all(values) and len(set(values)) == len(values) else "must be topics, none of them twice"


_START: Check = one_of("origin", "map", "unknown")


@dataclass(frozen=True)
class NodeletParams:
    """What the core does not know. Of no use offline: map_file, tf_output, transform_timeout."""

    cameras: List[str] = param([], _topics)  # topics of sextant/MarkerArray, one a camera
    map_file: str = param("")
    marker_map_file: str = param("")  # where printed markers hang
    start: str = param("origin", _START)  # where the robot is in a map that is there
    start_pose: List[float] = param([], _three_or_none)  # x, y, heading: metres, radians; empty: 0 0 0
    pose_sigma: List[float] = param([0.001] * 3, _three_sigmas)  # its deviations, metres and radians
    map_frame: str = param("map", not_empty)  # of a map that is begun
    odom_frame: str = param("")
    base_frame: str = param("")  # empty: odometry's child_frame_id
    tf_output: str = param("none", one_of("none", "map_to_odom", "map_to_base"))
    transform_timeout: float = param(0.1, within(0.0, 10.0))  # seconds


@dataclass
class LandmarkSlamSettings:
    """All of them, as the core and the library have them."""

    slam: "sextant.LandmarkSlamParams" = field(default_factory=sextant.LandmarkSlamParams)
    timeline: "sextant.LandmarkTimelineParams" = field(default_factory=sextant.LandmarkTimelineParams)
    markers: "sextant.MarkerLandmarkParams" = field(default_factory=sextant.MarkerLandmarkParams)
    nodelet: NodeletParams = field(default_factory=NodeletParams)
    told: Tuple[str, ...] = ()  # names of those that were told

    def validate(self) -> None:
        """:raises ValueError: names the first one out of range, and what is allowed"""
        for part in (self.slam, self.timeline, self.markers):
            part.validate()

    @property
    def start_pose(self) -> np.ndarray:
        """(3,) x, y, heading: metres, radians."""
        return np.array(self.nodelet.start_pose or [0.0] * 3, dtype=float)

    @property
    def start_covariance(self) -> np.ndarray:
        """(3, 3) of x, y, heading."""
        return np.diag(np.square(self.nodelet.pose_sigma))


def _flat() -> type:
    """A dataclass of all parameters, for parse_params()."""
    default = LandmarkSlamSettings()
    values = {name: attrgetter(path)(default) for name, path in CORE_FIELDS.items()}
    fields = [(name, type(value), param(value)) for name, value in values.items()]
    return make_dataclass("LandmarkSlamNodeParams", fields, bases=(NodeletParams,), frozen=True)


_FLAT = _flat()
NAMES = tuple(_FLAT.__dataclass_fields__)  # of all parameters


def settings_of(values: Mapping[str, Any], where: str) -> LandmarkSlamSettings:
    """Of parameters by name.

    :param where: they were told, for messages
    :raises ValueError: "where: name: reason" for one that is unknown, of a wrong type or out of range
    """
    flat = parse_params(_FLAT, values, where, ": ")
    nodelet = {name: getattr(flat, name) for name in NodeletParams.__dataclass_fields__}
    settings = LandmarkSlamSettings(nodelet=NodeletParams(**nodelet), told=tuple(values))
    for name, path in CORE_FIELDS.items():
        part, _, attribute = path.rpartition(".")
        setattr(attrgetter(part)(settings), attribute, getattr(flat, name))
    try:
        settings.validate()
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    return settings


def read_settings(path: Union[str, Path]) -> LandmarkSlamSettings:
    """Of a YAML file, as `rosparam load` takes it into the nodelet's namespace; what it does not name has its
    default.

    :raises OSError: it cannot be read
    :raises ValueError: as settings_of(), or the file is no YAML
    """
    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    values = {} if values is None else values
    if not isinstance(values, dict) or not all(isinstance(name, str) for name in values):
        raise ValueError(f"{path}: write `name: value`, a parameter a line")
    return settings_of(values, str(path))

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses and cameras of a map's photos, in a file beside the map."""

# frame: map                                      # tf frame, that of the map
# cameras:                                        # fields of sensor_msgs/CameraInfo
# - {width: 640, height: 480, rectified: false, distortion_model: plumb_bob, D: [...], K: [...],
#   R: [...], P: [...]}
# photos:                                         # the optical frame (z forward): metres, x y z w
#   hall_12.300.jpg: {camera: 0, position: [1.0, 2.0, 0.4], orientation: [-0.5, 0.5, -0.5, 0.5]}

from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Sequence

import numpy as np
import yaml

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.geometry.poses import quaternion_of

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times faster, if PyYAML has it
_SHAPES = {"K": (3, 3), "R": (3, 3), "P": (3, 4)}


class PhotoCamera(NamedTuple):
    """Camera of photos."""

    calibration: "sextant.CameraCalibration"  # lens and image size
    rectified: bool = False  # whether the photos are rectified images

    def model(self) -> "sextant.CameraModel":
        """The projection.

        :raises ValueError: the calibration is invalid
        """
        return sextant.CameraModel(self.calibration, self.rectified)


class PosedPhoto(NamedTuple):
    """Camera and pose of a photo."""

    camera: PhotoCamera  # that took it
    T_map_camera: np.ndarray  # (4, 4) of the optical frame, metres


class PhotoPoses(NamedTuple):
    """Photos with known poses."""

    frame: str  # tf frame
    photos: Dict[str, PosedPhoto]  # by image, as named in the map


def poses_path(map_path: Path) -> Path:
    """Path of the file beside a map."""
    return map_path.with_name(map_path.name + ".poses")


def write_photo_poses(path: Path, poses: PhotoPoses) -> None:
    """Writes the file atomically.

    :raises OSError: it cannot be written
    """
    cameras: List[Dict[str, Any]] = []
    photos = {}
    for image, photo in poses.photos.items():
        camera = _camera_table(photo.camera)
        if camera not in cameras:
            cameras.append(camera)
        T = photo.T_map_camera
        photos[image] = {
            "camera": cameras.index(camera),
            "position": T[:3, 3].tolist(),
            "orientation": quaternion_of(T[:3, :3]).tolist(),
        }
    table = {"frame": poses.frame, "cameras": cameras, "photos": photos}
    with atomic_file(path) as file:
        yaml.safe_dump(table, file, default_flow_style=None, sort_keys=False, width=1000, allow_unicode=True)


def _camera_table(camera: PhotoCamera) -> Dict[str, Any]:
    lens = camera.calibration
    table = {"width": lens.width, "height": lens.height, "rectified": camera.rectified}
    table.update(distortion_model=lens.distortion_model, D=[float(value) for value in lens.D])
    return {**table, **{name: np.ravel(getattr(lens, name)).tolist() for name in _SHAPES}}


def read_photo_poses(path: Path) -> PhotoPoses:
    """Reads the file.

    :raises OSError: it cannot be read
    :raises ValueError: "file: reason"
    """
    try:
        table = _fields(yaml.load(path.read_text(encoding="utf-8"), _LOADER), "the file", _FILE)
        cameras = [_camera(each, f"camera {i}") for i, each in enumerate(table["cameras"])]
        photos = {image: _photo(each, image, cameras) for image, each in table["photos"].items()}
        return PhotoPoses(table["frame"], photos)
    except UnicodeDecodeError:
        raise ValueError(f"{path}: is not UTF-8 text") from None
    except yaml.YAMLError as error:
        raise ValueError(f"{path}: is not YAML: {getattr(error, 'problem', error)}") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


_FILE = {"frame": str, "cameras": list, "photos": dict}
_CAMERA = {
    "width": int, "height": int, "rectified": bool, "distortion_model": str, "D": list, "K": list, "R": list,
    "P": list,
}  # fmt: skip
_PHOTO = {"camera": int, "position": list, "orientation": list}


def _fields(table: Any, what: str, types: Dict[str, type]) -> Dict[str, Any]:
    """Checks that a table has these fields and no others."""
    if not isinstance(table, dict) or set(table) != set(types):
        raise ValueError(f"{what} must have the fields {', '.join(types)} and no others")
    for name, kind in types.items():
        if type(table[name]) is not kind:  # bool is an int, too
            raise ValueError(f"{what}: {name} is {table[name]!r}, it must be of type {kind.__name__}")
    return table


def _numbers(values: Sequence[Any], what: str, count: int) -> np.ndarray:
    good = all(type(value) in (int, float) and np.isfinite(value) for value in values)
    if not good or len(values) != count:
        raise ValueError(f"{what} must be {count} finite numbers")
    return np.array(values, float)


def _camera(table: Any, what: str) -> PhotoCamera:
    table = _fields(table, what, _CAMERA)
    lens = sextant.CameraCalibration()
    lens.width, lens.height = table["width"], table["height"]
    lens.distortion_model = table["distortion_model"]
    lens.D = _numbers(table["D"], f"{what}: D", len(table["D"])).tolist()
    for name, shape in _SHAPES.items():
        setattr(lens, name, _numbers(table[name], f"{what}: {name}", shape[0] * shape[1]).reshape(shape))
    camera = PhotoCamera(lens, table["rectified"])
    try:
        camera.model()
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    return camera


def _photo(table: Any, image: Any, cameras: List[PhotoCamera]) -> PosedPhoto:
    table = _fields(table, f"photo {image}", _PHOTO)
    if not 0 <= table["camera"] < len(cameras):
        raise ValueError(f"photo {image}: there is no camera {table['camera']}")
    position = _numbers(table["position"], f"photo {image}: position", 3)
    orientation = _numbers(table["orientation"], f"photo {image}: orientation", 4)
    try:
        T = sextant.pose_from_quaternion(position, orientation)
    except ValueError as error:
        raise ValueError(f"photo {image}: {error}") from None
    return PosedPhoto(cameras[table["camera"]], np.array(T))

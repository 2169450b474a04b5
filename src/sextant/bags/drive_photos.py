# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Selects photos of a recorded drive with known poses by distance and turn."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from sextant.bags.bag_cameras import one_info
from sextant.bags.bag_file import BagError, BagFile
from sextant.bags.bag_params import BagParams
from sextant.bags.camera_topics import COMPRESSED, IMAGE, CameraTopic, choose_image_topic
from sextant.bags.drive_depth import PhotoView, read_drive_depth
from sextant.bags.mounts import Mount, find_mounts
from sextant.bags.recorded_poses import read_frame, read_poses
from sextant.bags.stamped_values import stamped_values
from sextant.bags.stamps import Losses
from sextant.bags.transforms import read_transforms
from sextant.base.strict_params import StrictParams, above_zero, param, within
from sextant.geometry.poses import MAX_GAP, interpolated_poses
from sextant.images.sharpness import sharpness
from sextant.messages.camera_messages import camera_from_info
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name
from sextant.messages.image_messages import colour_compressed, colour_image
from sextant.place_maps.keyframe_selection import keyframe_candidates, view_yaw
from sextant.place_maps.photo_poses import PhotoCamera

JPEG_QUALITY = 95

_DECODERS: Dict[str, Callable[[Any], np.ndarray]] = {IMAGE: colour_image, COMPRESSED: colour_compressed}


@dataclass(frozen=True)
class PhotoParams(StrictParams):
    """Parameters of the selection of photos, and the source of their poses."""

    image: str = ""  # image topic; empty: that of the only camera
    depth: str = ""  # topic of depth images; empty: none
    depth_scale: float = param(1.0, "factor that corrects the depths", within(0.5, 2))
    pose: str = ""  # topic of poses of the base; empty: from tf
    frame: str = "map"  # map frame in tf; a pose topic has its own frame_id
    distance: float = param(1.0, "distance between photos", above_zero(1e5), "m")
    turn: float = param(float(np.radians(30.0)), "turn between photos", above_zero(2 * np.pi), "rad")
    every: int = 1  # consider every n-th image
    base_frame: str = BagParams.base_frame  # frame of the robot
    mounts: Dict[str, np.ndarray] = field(default_factory=dict)  # as in BagParams

    def __post_init__(self) -> None:
        super().__post_init__()
        self.reading()

    def reading(self) -> BagParams:
        """The parameters of the reading of the bag."""
        return BagParams(base_frame=self.base_frame, mounts=self.mounts, every=self.every)


class BasePath(NamedTuple):
    """Poses of the base on drives."""

    frame: str  # their frame_id
    stamps: np.ndarray  # (n,) int64 nanoseconds, increasing
    poses: np.ndarray  # (n, 4, 4) T_frame_base, metres

    def at(self, stamps: Sequence[int]) -> Dict[int, np.ndarray]:
        """Interpolated T_frame_base (4, 4) by stamp, where it is known."""
        poses = interpolated_poses(self.stamps, self.poses, np.array(stamps, dtype=np.int64), MAX_GAP)
        return {stamp: T for stamp, T in zip(stamps, poses) if T is not None}


class DrivePhoto(NamedTuple):
    """A photo with the pose of its camera."""

    name: str  # file name, unique among drives
    stamp: int  # nanoseconds
    T_map_camera: np.ndarray  # (4, 4) of the optical frame, metres
    jpeg: bytes  # encoded image
    depth: Optional[bytes] = None  # of encoded_depth(); None: unknown

    @property
    def position(self) -> Tuple[float, float]:
        """Position of the camera, metres."""
        return tuple(self.T_map_camera[:2, 3].tolist())

    @property
    def yaw(self) -> Optional[float]:
        """Direction of the camera, radians; None: it points up or down."""
        return view_yaw(self.T_map_camera)


@dataclass(frozen=True)
class DrivePhotos:
    """Photos of one bag."""

    frame: str  # frame_id of the positions
    paths: List[np.ndarray]  # each (n, 2): positions of the camera without gaps, metres
    photos: List[DrivePhoto]  # with poses, in order of time
    camera: Optional[PhotoCamera] = None  # that took them; None: the bag has no calibration
    warnings: Tuple[str, ...] = ()  # notes on the reading


def read_drive_photos(path: str, params: PhotoParams, base_path: Optional[BasePath] = None) -> DrivePhotos:
    """Reads a bag without a master. Of photos from almost the same pose the sharpest is selected.

    :param base_path: of the base; None: by tf or the topic of the parameters
    :raises BagError: the bag, its images, its poses or the mount cannot be used, and what to do
    """
    with BagFile(path) as bag:
        topic, notes = choose_image_topic(bag, params.image)
        read = stamped_values(bag, topic.topic, _camera_frame)
        stamps = list(read.values)[:: params.every]
        tree = read_transforms(bag)
        optical = frame_name(read.first.header.frame_id)
        mounts = find_mounts(bag, {topic.camera: optical}, params.reading(), tree)
        if base_path:
            frame, T_map_base, more = base_path.frame, base_path.at(stamps), []
        else:
            frame, T_map_base, more = _base_poses(path, params, stamps)
        poses = _camera_poses(stamps, T_map_base, mounts.by_camera[topic.camera])
        if not poses:
            raise bag.error(f"no image of {topic.topic} has a pose", "were both recorded at the same time?")
        photos, losses = _photos(bag, topic, poses, params)
        camera, unknown = _camera(bag, topic)
        if params.depth:
            view = camera and PhotoView(camera.model(), optical, tree)
            photos, unmeasured = _with_depth(bag, params, photos, view)
            unknown = [*unknown, *unmeasured]
    if len(poses) < len(stamps):
        more = [*more, f"{len(stamps) - len(poses)} of {len(stamps)} images have no pose"]
    warnings = [*notes, *read.notes, *mounts.notes, *more, *losses, *unknown]
    return DrivePhotos(frame, _paths(stamps, poses), photos, camera, tuple(dict.fromkeys(warnings)))


class DriveCameraView(NamedTuple):
    """The camera of the images of a bag."""

    camera: Optional[PhotoCamera]  # None: the bag has no calibration
    mount: Mount  # T_base_camera (4, 4) at a stamp
    warnings: Tuple[str, ...]  # notes on the reading


def read_camera_view(path: str, params: PhotoParams) -> DriveCameraView:
    """Calibration and mount of the camera of the images.

    :raises BagError: the bag, its images or the mount cannot be used, and what to do
    """
    with BagFile(path) as bag:
        topic, notes = choose_image_topic(bag, params.image)
        first = bag.first(topic.topic, whole=True)
        if first is None:
            raise bag.error(f"no message on {topic.topic} can be read", "record again")
        optical = frame_name(first.header.frame_id)
        mounts = find_mounts(bag, {topic.camera: optical}, params.reading(), read_transforms(bag))
        camera, unknown = _camera(bag, topic)
    return DriveCameraView(camera, mounts.by_camera[topic.camera], (*notes, *mounts.notes, *unknown))


def _camera_frame(message: Any, first: Any) -> str:
    frame, expected = (frame_name(each.header.frame_id) for each in (message, first))
    if frame != expected:
        raise DamagedMessage(f"its frame is '{frame}', the first one's '{expected}'")
    return frame


def _base_poses(
    path: str, params: PhotoParams, stamps: Sequence[int]
) -> Tuple[str, Dict[int, np.ndarray], List[str]]:
    """The frame, T_frame_base (4, 4) by stamp where known, and warnings."""
    if not params.pose:
        known, notes = read_frame(path, params.frame, params.base_frame, stamps)
        return frame_name(params.frame), known, notes
    read = read_poses(path, params.pose)
    return read.frame, BasePath(read.frame, read.stamps, read.poses).at(stamps), list(read.warnings)


def _camera_poses(
    stamps: Sequence[int], T_map_base: Dict[int, np.ndarray], mount: Mount
) -> Dict[int, np.ndarray]:
    """T_map_camera (4, 4) by stamp, where T_map_base and the mount are known."""
    parts = ((stamp, T_map_base.get(stamp), mount(stamp)) for stamp in stamps)
    return {
        stamp: T_base @ T_camera
        for stamp, T_base, T_camera in parts
        if not (T_base is None or T_camera is None)
    }


def _photos(
    bag: BagFile, topic: CameraTopic, poses: Dict[int, np.ndarray], params: PhotoParams
) -> Tuple[List[DrivePhoto], List[str]]:
    """The sharpest image of each pick by stamp, and notes on messages that cannot be read."""
    stamps, name = list(poses), photo_prefix(bag, topic)
    picks = keyframe_candidates(list(poses.values()), params.distance, params.turn)
    pick_of = {stamps[i]: number for number, pick in enumerate(picks) for i in pick}
    best: Dict[int, Tuple[float, DrivePhoto]] = {}
    losses = Losses()
    for recorded in bag.messages([topic.topic]):
        try:
            message = recorded.message()
            stamp = message.header.stamp.to_nsec()
            if stamp not in pick_of:
                continue
            image = _DECODERS[topic.type](message)
        except DamagedMessage as error:
            losses.lost(topic.topic, str(error))
            continue
        losses.used(topic.topic)
        sharp, pick = sharpness(image), pick_of[stamp]
        if pick not in best or sharp > best[pick][0]:
            best[pick] = sharp, _photo(f"{name}_{stamp / 1e9:.3f}.jpg", stamp, image, poses[stamp])
    losses.check(bag, topic.topic)
    return [best[pick][1] for pick in sorted(best)], losses.notes()


def _camera(bag: BagFile, topic: CameraTopic) -> Tuple[Optional[PhotoCamera], List[str]]:
    """The camera by its camera_info, and a note if that cannot be used; None without a usable one."""
    if not bag.find(topic.info_topic):
        return None, []
    try:
        camera = camera_from_info(one_info(bag, topic.info_topic), topic.rectified)
    except ValueError as error:
        return None, [f"{topic.info_topic} is not used, so there are no metric poses: {error}"]
    except BagError as error:
        return None, [f"there are no metric poses: {error}"]
    return PhotoCamera(camera.calibration, camera.rectified), []


def photo_prefix(bag: BagFile, topic: CameraTopic) -> str:
    """Prefix of the file names of this bag and camera."""
    camera = topic.info_topic.split("/")[:-1]
    return "_".join([Path(bag.path).stem, *filter(None, camera)])


def _photo(name: str, stamp: int, image: np.ndarray, T_map_camera: np.ndarray) -> DrivePhoto:
    _, jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return DrivePhoto(name, stamp, T_map_camera, jpeg.tobytes())


def _with_depth(
    bag: BagFile, params: PhotoParams, photos: List[DrivePhoto], view: Optional[PhotoView]
) -> Tuple[List[DrivePhoto], List[str]]:
    """The photos with the depth that was recorded with them, and notes."""
    if view is None:
        raise bag.error("depth is of no use without a camera_info of the images", "record it, too")
    stamps = [photo.stamp for photo in photos]
    found, notes = read_drive_depth(bag, params.depth, stamps, view, params.depth_scale)
    return [photo._replace(depth=found.get(photo.stamp)) for photo in photos], notes


def _paths(stamps: Sequence[int], poses: Dict[int, np.ndarray]) -> List[np.ndarray]:
    """Positions, split where poses are unknown in between."""
    paths: List[List[np.ndarray]] = [[]]
    for stamp in stamps:
        if stamp in poses:
            paths[-1].append(poses[stamp][:2, 3])
        elif paths[-1]:
            paths.append([])
    return [np.array(path) for path in paths if path]

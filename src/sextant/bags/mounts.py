# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Poses of the cameras on the robot."""

from typing import Callable, Dict, List, NamedTuple, Optional

import numpy as np

from sextant.bags.bag_file import BagFile, listed
from sextant.bags.bag_params import BagParams
from sextant.bags.transforms import TransformTree
from sextant.messages.frame_name import frame_name

Mount = Callable[[int], Optional[np.ndarray]]  # T_base_camera (4, 4) at a stamp, None if unknown

NAME_MOUNTS = "name the mounts of the cameras' frames (T_base_camera), or the base_frame that tf has"


class Mounts(NamedTuple):
    """T_base_camera of every camera."""

    by_camera: Dict[str, Mount]  # by name of the camera
    camera_is_base: bool  # whether there is no robot frame: odometry must not be used
    notes: List[str]  # warnings


def find_mounts(bag: BagFile, frames: Dict[str, str], params: BagParams, tree: TransformTree) -> Mounts:
    """Mounts of params.mounts or tf. A single camera of a bag without tf is the base itself.

    :param frames: optical frame by camera
    :raises BagError: a frame is not connected with the base, or several cameras would be the base
    """
    if params.camera_is_base:
        return _camera_is_base(bag, list(frames))
    return _on_the_base(bag, frames, params, tree)


def _on_the_base(bag: BagFile, frames: Dict[str, str], params: BagParams, tree: TransformTree) -> Mounts:
    base = frame_name(params.base_frame)
    given = {frame_name(frame): np.array(T, dtype=float) for frame, T in params.mounts.items()}
    _check_given(bag, given, frames)
    found = {camera: mount_of(bag, frame, base, given, tree) for camera, frame in frames.items()}
    missing = [camera for camera in sorted(found) if found[camera] is None]
    if not missing:
        return Mounts(found, False, [])
    if len(frames) > 1 or tree.frames:
        wanted = ", ".join(f"'{frames[camera]}' ({camera})" for camera in missing)
        what = f"tf does not connect '{base}' with {wanted}; its frames are: {listed(tree.frames)}"
        raise bag.error(what, NAME_MOUNTS)
    note = (
        f"no tf was recorded, and no mount is named: the camera of {missing[0]} is taken as the base itself"
    )
    return _camera_is_base(bag, missing, note + ", and odometry is not used")


def _camera_is_base(bag: BagFile, cameras: List[str], *notes: str) -> Mounts:
    if len(cameras) > 1:
        raise bag.error(f"it has several cameras: {', '.join(sorted(cameras))}", "name the topic of one")
    return Mounts({cameras[0]: _constant(np.eye(4))}, True, list(notes))


def _check_given(bag: BagFile, given: Dict[str, np.ndarray], frames: Dict[str, str]) -> None:
    unknown = sorted(set(given) - set(frames.values()))
    if unknown:
        there = ", ".join(f"'{frame}'" for frame in sorted(set(frames.values())))
        raise bag.error(
            f"no camera has the frame '{unknown[0]}', named in mounts", f"the frames are: {there}"
        )


def _constant(T: np.ndarray) -> Mount:
    return lambda stamp: T


def mount_of(
    bag: BagFile, frame: str, base: str, given: Dict[str, np.ndarray], tree: TransformTree
) -> Optional[Mount]:
    """Mount T_base_frame of a frame from given or tf; None if tf does not connect them.

    :param given: T_base_frame by frame
    :raises BagError: tf is not a tree
    """
    if frame in given or frame == base:
        return _constant(given.get(frame, np.eye(4)))
    try:
        chain = tree.chain(base, frame)
    except ValueError as error:
        raise bag.error(str(error), NAME_MOUNTS) from None
    if chain is None:
        return None
    return _constant(chain.at(0)) if chain.is_static else chain.at

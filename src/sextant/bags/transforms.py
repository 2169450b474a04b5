# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the frame tree of recorded tf without a listener."""

from typing import Dict, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from sextant.bags.bag_file import BagFile
from sextant.geometry.poses import interpolated_poses, pose_of_fields
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name

TF_GAP = 10.0  # seconds between two interpolated transforms: length of tf2's buffer

Edge = Tuple[str, str]  # parent, child


class _Series:
    """T_parent_child at stamps, or static."""

    def __init__(self) -> None:
        self._stamps: List[int] = []
        self._poses: List[np.ndarray] = []
        self._sorted: Optional[Tuple[np.ndarray, np.ndarray]] = None
        self.static: Optional[np.ndarray] = None

    def add(self, stamp: int, T: np.ndarray) -> None:
        self._stamps.append(stamp)
        self._poses.append(T)
        self._sorted = None

    def at(self, stamp: int, max_gap: float) -> Optional[np.ndarray]:
        if self.static is not None:
            return self.static
        if self._sorted is None:
            stamps, first = np.unique(np.array(self._stamps, dtype=np.int64), return_index=True)
            self._sorted = stamps, np.array(self._poses)[first]
        return interpolated_poses(*self._sorted, np.array([stamp], dtype=np.int64), max_gap)[0]


class Chain(NamedTuple):
    """The path through the tree from one frame to another."""

    up: List[_Series]  # from the common frame down to the target
    down: List[_Series]  # from the common frame down to the source

    @property
    def is_static(self) -> bool:
        """Whether all its transforms are static."""
        return all(series.static is not None for series in (*self.up, *self.down))

    def at(self, stamp: int, max_gap: float = TF_GAP) -> Optional[np.ndarray]:
        """T_target_source (4, 4) at a stamp (nanoseconds); None if tf was not recorded then.

        :param max_gap: maximum time between two interpolated transforms, seconds
        """
        both = [_composed(series, stamp, max_gap) for series in self]
        return None if both[0] is None or both[1] is None else np.linalg.inv(both[0]) @ both[1]


def _composed(edges: List[_Series], stamp: int, max_gap: float) -> Optional[np.ndarray]:
    T = np.eye(4)
    for edge in edges:
        step = edge.at(stamp, max_gap)
        if step is None:
            return None
        T = T @ step
    return T


class TransformTree:
    """All transforms of a recording. Static ones are valid at all stamps, also before their reception."""

    def __init__(self) -> None:
        self._series: Dict[Edge, _Series] = {}
        self._parents: Dict[str, Set[str]] = {}
        self.notes: List[str] = []  # warnings

    @property
    def frames(self) -> List[str]:
        """Names of all frames."""
        return sorted({frame for edge in self._series for frame in edge})

    def add(self, parent: str, child: str, stamp: int, T: np.ndarray, static: bool) -> None:
        """Adds T_parent_child at a stamp in nanoseconds. The last static one is used, as in tf2."""
        series = self._series.setdefault((parent, child), _Series())
        self._parents.setdefault(child, set()).add(parent)
        if not static:
            series.add(stamp, T)
            return
        if series.static is not None and not np.allclose(series.static, T, atol=1e-6):
            self.notes.append(
                f"/tf_static has different transforms of {child} in {parent}: the last one is used"
            )
        series.static = T

    def chain(self, target: str, source: str) -> Optional[Chain]:
        """The path from target to source; None if they are not connected.

        :raises ValueError: a frame on the path has several parents
        """
        above_source = self._climb(source, target)
        if above_source[-1] == target:
            return Chain([], self._edges(above_source))
        above_target = self._climb(target, source)
        common = next((frame for frame in above_target if frame in above_source), None)
        if common is None:
            return None
        paths = [path[: path.index(common) + 1] for path in (above_target, above_source)]
        return Chain(*map(self._edges, paths))

    def _climb(self, frame: str, until: str) -> List[str]:
        path = [frame]
        while path[-1] != until and path[-1] in self._parents:
            parents = self._parents[path[-1]]
            if len(parents) > 1:
                raise ValueError(f"tf has several parents of {path[-1]}: {', '.join(sorted(parents))}")
            parent = next(iter(parents))
            if parent in path:
                raise ValueError(f"tf has a loop at {parent}")
            path.append(parent)
        return path

    def _edges(self, path: List[str]) -> List[_Series]:
        """Transforms from the last frame of the path down to its first."""
        return [self._series[parent, child] for child, parent in zip(path, path[1:])][::-1]


def read_transforms(bag: BagFile, tree: Optional[TransformTree] = None) -> TransformTree:
    """Reads all of /tf and /tf_static, also outside of the part to read, because they are latched.

    :param tree: of earlier bags, to add to
    :raises BagError: as BagFile.messages()
    """
    tree, damaged = TransformTree() if tree is None else tree, 0
    for recorded in bag.messages(bag.topics("tf2_msgs/TFMessage", "tf/tfMessage"), whole=True):
        static = recorded.topic.rstrip("/").endswith("tf_static")
        try:
            transforms = recorded.message().transforms
        except DamagedMessage:
            damaged += 1
            continue
        for each in transforms:
            try:
                T = pose_of_fields(each.transform.translation, each.transform.rotation)
            except ValueError:
                damaged += 1
                continue
            frames = frame_name(each.header.frame_id), frame_name(each.child_frame_id)
            tree.add(*frames, each.header.stamp.to_nsec(), T, static)
    if damaged:
        tree.notes.append(f"{damaged} transforms of tf were skipped: they are damaged or not valid")
    return tree

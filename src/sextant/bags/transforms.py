# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tree of frames that tf recorded, without a listener."""

from typing import Dict, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from sextant.bags.bag_file import BagFile, DamagedMessage
from sextant.geometry.poses import interpolated_poses, pose_of_fields

TF_GAP = 10.0  # seconds between two transforms that are interpolated: what tf2's buffer holds

Edge = Tuple[str, str]  # parent, child


def frame_name(name: str) -> str:
    """As tf2 has it: without tf's leading slash."""
    return name.lstrip("/")


class _Series:
    """T_parent_child, at stamps or for ever."""

    def __init__(self) -> None:
        self._stamps: List[int] = []
        self._poses: List[np.ndarray] = []
        self._sorted: Optional[Tuple[np.ndarray, np.ndarray]] = None
        self.static: Optional[np.ndarray] = None

    def add(self, stamp: int, T: np.ndarray) -> None:
        self._stamps.append(stamp)
        self._poses.append(T)
        self._sorted = None

    def at(self, stamp: int, longest_gap: float) -> Optional[np.ndarray]:
        if self.static is not None:
            return self.static
        if self._sorted is None:
            stamps, first = np.unique(np.array(self._stamps, dtype=np.int64), return_index=True)
            self._sorted = stamps, np.array(self._poses)[first]
        return interpolated_poses(*self._sorted, np.array([stamp], dtype=np.int64), longest_gap)[0]


class Chain(NamedTuple):
    """The way through the tree from one frame to another."""

    up: List[_Series]  # from the common frame down to the target
    down: List[_Series]  # from the common frame down to the source

    @property
    def is_static(self) -> bool:
        """No joint of it moves."""
        return all(series.static is not None for series in (*self.up, *self.down))

    def at(self, stamp: int, longest_gap: float = TF_GAP) -> Optional[np.ndarray]:
        """T_target_source at a stamp (nanoseconds); None where tf was not recorded then.

        :param longest_gap: seconds between two transforms that are interpolated
        """
        both = [_composed(series, stamp, longest_gap) for series in self]
        return None if both[0] is None or both[1] is None else np.linalg.inv(both[0]) @ both[1]


def _composed(edges: List[_Series], stamp: int, longest_gap: float) -> Optional[np.ndarray]:
    T = np.eye(4)
    for edge in edges:
        step = edge.at(stamp, longest_gap)
        if step is None:
            return None
        T = T @ step
    return T


class TransformTree:
    """Every transform of a recording. A static one holds for all time, whenever it was heard."""

    def __init__(self) -> None:
        self._series: Dict[Edge, _Series] = {}
        self._parents: Dict[str, Set[str]] = {}
        self.notes: List[str] = []  # what is odd about it

    @property
    def frames(self) -> List[str]:
        """Names of all frames."""
        return sorted({frame for edge in self._series for frame in edge})

    def add(self, parent: str, child: str, stamp: int, T: np.ndarray, static: bool) -> None:
        """T_parent_child at a stamp in nanoseconds. Of several static ones the last counts, as in tf2."""
        series = self._series.setdefault((parent, child), _Series())
        self._parents.setdefault(child, set()).add(parent)
        if not static:
            series.add(stamp, T)
            return
        if series.static is not None and not np.allclose(series.static, T, atol=1e-6):
            self.notes.append(f"/tf_static says two things of {child} in {parent}: the last one was taken")
        series.static = T

    def chain(self, target: str, source: str) -> Optional[Chain]:
        """The way from target to source, None where the tree has none.

        :raises ValueError: a frame on the way has several parents
        """
        above_source = self._climb(source, target)
        if above_source[-1] == target:
            return Chain([], self._edges(above_source))
        above_target = self._climb(target, source)
        common = next((frame for frame in above_target if frame in above_source), None)
        if common is None:
            return None
        ways = [way[: way.index(common) + 1] for way in (above_target, above_source)]
        return Chain(*map(self._edges, ways))

    def _climb(self, frame: str, until: str) -> List[str]:
        way = [frame]
        while way[-1] != until and way[-1] in self._parents:
            parents = self._parents[way[-1]]
            if len(parents) > 1:
                raise ValueError(f"tf has several parents of {way[-1]}: {', '.join(sorted(parents))}")
            parent = next(iter(parents))
            if parent in way:
                raise ValueError(f"tf goes round in a circle at {parent}")
            way.append(parent)
        return way

    def _edges(self, way: List[str]) -> List[_Series]:
        """From the last frame of the way down to its first."""
        return [self._series[parent, child] for child, parent in zip(way, way[1:])][::-1]


def read_transforms(bag: BagFile, tree: Optional[TransformTree] = None) -> TransformTree:
    """All of /tf and /tf_static, also from outside of the part that is read: they are latched.

    :param tree: of bags before it, which is added to
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
        tree.notes.append(f"{damaged} transforms of tf were left out: they hold no pose, or are damaged")
    return tree

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads odometry and observations of recorded drives in the order of their reception."""

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence

import numpy as np

from sextant.bags.bag_file import BagFile, Recorded, listed
from sextant.bags.camera_topics import MARKERS
from sextant.bags.mounts import Mount, mount_of
from sextant.bags.odometry import ODOMETRY, odometry_topic
from sextant.bags.stamps import Losses, StampOrder
from sextant.bags.transforms import TransformTree, read_transforms
from sextant.landmarks.slam_run import SlamRun
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name
from sextant.messages.landmark_messages import (
    landmark_observations,
    marker_observations,
    planar_pose,
    planar_sensor_pose,
)
from sextant.msg import LandmarkObservations, MarkerArray

LANDMARKS = "sextant/LandmarkObservations"
LONGEST_BREAK = 2.0  # seconds between two bags of one drive; a split recording has a smaller gap
OVERLAP = 1.0  # seconds by which two bags of one drive may overlap

Progress = Callable[[float], None]  # called with the fraction of all bags that is read, 0 to 1


@dataclass(frozen=True)
class LandmarkTopics:
    """Topics to read. Empty: the only topic of its type."""

    odometry: str = ""  # nav_msgs/Odometry
    landmarks: str = ""  # sextant/LandmarkObservations
    cameras: Sequence[str] = ()  # sextant/MarkerArray; empty: all, or none if there are landmarks
    base_frame: str = ""  # empty: odometry's child_frame_id
    mounts: Mapping[str, np.ndarray] = field(default_factory=dict)  # T_base_frame by frame; overrides tf
    start: float = 0.0  # seconds after a bag's first message
    end: float = float("inf")  # seconds after a bag's first message

    def __post_init__(self) -> None:
        """:raises ValueError: start and end are not an interval"""
        if not 0.0 <= self.start < self.end:
            raise ValueError(f"start is {self.start} and end {self.end}, allowed is 0 <= start < end")


def run_on_bags(
    paths: Sequence[str], topics: LandmarkTopics, run: SlamRun, progress: Optional[Progress] = None
) -> List[str]:
    """Runs SLAM on the messages of the bags in the order of their times.

    A bag that begins more than LONGEST_BREAK after the end of the last one is another drive.

    :returns: notes on how the bags were read
    :raises BagError: a bag cannot be read, lacks a topic, or nothing on a topic can be used
    :raises ValueError: two bags overlap in time
    """
    tree, notes, before = TransformTree(), [], None
    for index, path in enumerate(_in_order(paths, topics)):
        with BagFile(path, topics.start, topics.end) as bag:
            if before is not None and bag.start - before > LONGEST_BREAK:
                run.start_drive()
                notes.append(f"{path}: begins {bag.start - before:.0f} s later: read as another drive")
            read = _Drive(bag, topics, run, tree).read(_of_part(progress, index, len(paths)))
            notes += [f"{path}: {note}" for note in read]
            before = bag.end
    return list(dict.fromkeys([*notes, *tree.notes]))


def _of_part(progress: Optional[Progress], index: int, count: int) -> Progress:
    """Progress of one bag as a part of all."""
    return (lambda share: progress((index + share) / count)) if progress else (lambda share: None)


def _in_order(paths: Sequence[str], topics: LandmarkTopics) -> List[str]:
    spans = []
    for path in paths:
        with BagFile(path, topics.start, topics.end) as bag:
            spans.append((bag.start, bag.end, str(path)))
    spans.sort()
    for (_, end, first), (start, _, second) in zip(spans, spans[1:]):
        if start < end - OVERLAP:
            raise ValueError(
                f"{second}: overlaps {first} in time; map one of them, then continue its map with the other"
            )
    return [path for _, _, path in spans]


class _Drive:
    """Reads one bag.

    :raises BagError: a topic does not exist
    """

    def __init__(self, bag: BagFile, topics: LandmarkTopics, run: SlamRun, tree: TransformTree):
        self._bag, self._topics, self._run = bag, topics, run
        self._odometry = odometry_topic(bag, topics.odometry)
        if not self._odometry:
            what = f"it contains no {ODOMETRY}, or --odometry is none"
            raise bag.error(what, f"its topics are: {listed(bag.types)}")
        self._tree = read_transforms(bag, tree)
        self._sources = self._named(LANDMARKS, [topics.landmarks] if topics.landmarks else [])
        if len(self._sources) > 1:
            there = listed(self._sources)
            raise bag.error(f"there are several topics of {LANDMARKS}: {there}", "specify one by --landmarks")
        if topics.cameras or not self._sources:
            self._sources += self._named(MARKERS, topics.cameras)
        if not self._sources:
            what = f"it contains neither landmarks ({LANDMARKS}) nor markers ({MARKERS})"
            raise bag.error(what, f"record them; its topics are: {listed(bag.types)}")
        self._mounts: Dict[str, Optional[Mount]] = {}
        self._order, self._losses = StampOrder(bag), Losses()
        self._base = frame_name(topics.base_frame)

    def _named(self, message_type: str, names: Sequence[str]) -> List[str]:
        """Topics of a type: the named ones, or else all."""
        found = [self._bag.named(name, message_type, message_type) for name in names]
        return found or list(self._bag.topics(message_type))

    def read(self, progress: Progress) -> List[str]:
        """:raises BagError: as run_on_bags()"""
        self._base = self._base or self._child_frame()
        for recorded in self._bag.messages([self._odometry, *self._sources]):
            try:
                message = recorded.message()
                if recorded.topic == self._odometry:
                    self._add_odometry(recorded, message)
                else:
                    self._add_observations(recorded, message)
                self._losses.used(recorded.topic)
            except ValueError as error:
                self._losses.lost(recorded.topic, str(error))
            progress(self._bag.fraction_read(recorded.received))
        for topic in (self._odometry, *self._sources):
            self._losses.check(self._bag, topic)
        unused = {frame_name(name) for name in self._topics.mounts} - set(self._mounts)
        there = listed(self._mounts)
        notes = [
            f"no message has the frame '{name}' of mounts; the frames are: {there}" for name in sorted(unused)
        ]
        return [*self._losses.notes(), *notes]

    def _child_frame(self) -> str:
        first = self._bag.first(self._odometry)
        child = frame_name(first.child_frame_id) if first else ""
        if first and not child:
            what = f"{self._odometry} does not name its child_frame_id"
            raise self._bag.error(what, "specify the frame of the robot by --base-frame")
        return child

    def _add_odometry(self, recorded: Recorded, message: Any) -> None:
        pose, stamp = planar_pose(message.pose.pose), message.header.stamp.to_nsec()
        self._order.check(recorded, stamp)
        if not self._run.odometry(stamp, pose):
            raise DamagedMessage("its stamp is not newer than that of the last one")

    def _add_observations(self, recorded: Recorded, message: Any) -> None:
        self._check_version(recorded.topic, message)
        stamp, frame = message.header.stamp.to_nsec(), frame_name(message.header.frame_id)
        if stamp <= 0:
            raise DamagedMessage("the stamp is zero")
        T = self._T_base_frame(frame, stamp)
        if self._bag.types[recorded.topic] == LANDMARKS:
            observations = landmark_observations(message, T)
        else:
            observations = marker_observations(message, T, self._run.params.markers)
            for marker in message.markers:
                if not marker.size > 0.0:
                    self._losses.lost(
                        f"{recorded.topic}, marker {marker.id}",
                        "it has no size, set marker_size of its detector",
                    )
        self._run.observe(stamp, observations, planar_sensor_pose(T))

    def _check_version(self, topic: str, message: Any) -> None:
        expected = {LANDMARKS: LandmarkObservations, MARKERS: MarkerArray}[self._bag.types[topic]]
        if message._md5sum != expected._md5sum:
            what = f"the messages on {topic} were recorded by another version of Sextant"
            raise self._bag.error(what, "read it with that version")

    def _T_base_frame(self, frame: str, stamp: int) -> np.ndarray:
        if not frame:
            raise DamagedMessage("it has no frame_id")
        if frame not in self._mounts:
            given = {frame_name(name): np.asarray(T) for name, T in self._topics.mounts.items()}
            self._mounts[frame] = mount_of(self._bag, frame, self._base, given, self._tree)
        mount = self._mounts[frame]
        if mount is None:
            there = listed(self._tree.frames)
            raise DamagedMessage(
                f"tf does not connect its frame '{frame}' with '{self._base}': specify its pose by "
                f"--mounts, or another --base-frame; the frames of tf are: {there}"
            )
        T = mount(stamp)
        if T is None:
            raise DamagedMessage("tf was not recorded at its stamp")
        return T

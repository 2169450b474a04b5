# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Odometry and sightings of recorded drives, in the order in which they were recorded."""

from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence

import numpy as np

from sextant.bags.bag_file import BagFile, DamagedMessage, Recorded
from sextant.bags.camera_topics import MARKERS
from sextant.bags.landmark_messages import landmark_sightings, marker_sightings, planar_pose, view_of
from sextant.bags.mounts import Mount, mount_of
from sextant.bags.odometry import ODOMETRY, odometry_topic
from sextant.bags.stamps import Losses, StampOrder
from sextant.bags.transforms import TransformTree, frame_name, read_transforms
from sextant.landmarks.slam_run import SlamRun
from sextant.msg import LandmarkSightings, MarkerArray

LANDMARKS = "sextant/LandmarkSightings"
LONGEST_BREAK = 2.0  # seconds between two bags of one drive; a recorder that splits loses less
OVERLAP = 1.0  # seconds that the next bag may begin before

Progress = Callable[[float], None]  # is told which part of all bags is read, 0 to 1


@dataclass(frozen=True)
class LandmarkTopics:
    """What is read of bags. Empty: the only topic of its type."""

    odometry: str = ""
    landmarks: str = ""
    cameras: Sequence[str] = ()  # of sextant/MarkerArray; empty: all, but where there are landmarks none
    base_frame: str = ""  # empty: odometry's child_frame_id
    mounts: Mapping[str, np.ndarray] = field(default_factory=dict)  # frame: T_base_frame, before tf
    start: float = 0.0  # seconds after a bag's first message
    end: float = float("inf")

    def __post_init__(self) -> None:
        """:raises ValueError: the part to be read is none"""
        if not 0.0 <= self.start < self.end:
            raise ValueError(f"start is {self.start} and end {self.end}, allowed is 0 <= start < end")


def run_on_bags(
    paths: Sequence[str], topics: LandmarkTopics, run: SlamRun, progress: Optional[Progress] = None
) -> List[str]:
    """Tells the run all that the bags say, in the order of the bags' times.

    A bag that begins later than the one before it ended is another drive.

    :returns: what its user should know of how they were read
    :raises BagError: a bag cannot be read, lacks what is needed, or nothing on a topic can be used
    :raises ValueError: two bags are of the same time
    """
    tree, notes, before = TransformTree(), [], None
    for index, path in enumerate(_in_order(paths, topics)):
        with BagFile(path, topics.start, topics.end) as bag:
            if before is not None and bag.start - before > LONGEST_BREAK:
                run.begin_anew()
                notes.append(f"{path}: begins {bag.start - before:.0f} s later: taken for another drive")
            read = _Drive(bag, topics, run, tree).read(_of_part(progress, index, len(paths)))
            notes += [f"{path}: {note}" for note in read]
            before = bag.end
    return list(dict.fromkeys([*notes, *tree.notes]))


def _of_part(progress: Optional[Progress], index: int, count: int) -> Progress:
    """Progress of one bag."""
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
                f"{second}: was recorded while {first} was; map one, and the other from that one's map on"
            )
    return [path for _, _, path in spans]


class _Drive:
    """Reads a bag.

    :raises BagError: a topic is not there
    """

    def __init__(self, bag: BagFile, topics: LandmarkTopics, run: SlamRun, tree: TransformTree):
        self._bag, self._topics, self._run = bag, topics, run
        self._odometry = odometry_topic(bag, topics.odometry)
        if not self._odometry:
            what = f"there is no {ODOMETRY} in it, or none is wanted"
            raise bag.error(what, f"its topics are: {_listing(bag.types)}")
        self._tree = read_transforms(bag, tree)
        self._sources = self._named(LANDMARKS, [topics.landmarks] if topics.landmarks else [])
        if len(self._sources) > 1:
            there = _listing(self._sources)
            raise bag.error(f"there are several topics of {LANDMARKS}: {there}", "name one by --landmarks")
        if topics.cameras or not self._sources:
            self._sources += self._named(MARKERS, topics.cameras)
        if not self._sources:
            what = f"there are neither landmarks ({LANDMARKS}) nor markers ({MARKERS}) in it"
            raise bag.error(what, f"record them, too; its topics are: {_listing(bag.types)}")
        self._mounts: Dict[str, Optional[Mount]] = {}
        self._order, self._losses = StampOrder(bag), Losses()
        self._base = frame_name(topics.base_frame)

    def _named(self, message_type: str, names: Sequence[str]) -> List[str]:
        """Topics of a type: those named, or else all."""
        there = self._bag.topics(message_type)
        found = [self._bag.find(name) for name in names]
        for name, topic in zip(names, found):
            if topic not in there:
                what = f"there is no {message_type} on {name}"
                raise self._bag.error(what, f"topics of it: {_listing(there)}")
        return [str(topic) for topic in found or there]

    def read(self, progress: Progress) -> List[str]:
        """:raises BagError: as run_on_bags()"""
        self._base = self._base or self._child_frame()
        for recorded in self._bag.messages([self._odometry, *self._sources]):
            try:
                message = recorded.message()
                if recorded.topic == self._odometry:
                    self._hear_odometry(recorded, message)
                else:
                    self._hear_sightings(recorded, message)
                self._losses.used(recorded.topic)
            except ValueError as error:
                self._losses.lost(recorded.topic, str(error))
            progress(self._bag.share_read(recorded.received))
        for topic in (self._odometry, *self._sources):
            self._losses.check(self._bag, topic)
        unused = {frame_name(name) for name in self._topics.mounts} - set(self._mounts)
        there = _listing(self._mounts)
        notes = [
            f"nothing is of the frame '{name}', named in mounts; there is {there}" for name in sorted(unused)
        ]
        return [*self._losses.notes(), *notes]

    def _child_frame(self) -> str:
        first = self._bag.first(self._odometry)
        child = frame_name(first.child_frame_id) if first else ""
        if first and not child:
            what = f"{self._odometry} does not name its child_frame_id"
            raise self._bag.error(what, "name the robot's frame by --base-frame")
        return child

    def _hear_odometry(self, recorded: Recorded, message: Any) -> None:
        pose, stamp = planar_pose(message.pose.pose), message.header.stamp.to_nsec()
        self._order.check(recorded, stamp)
        if not self._run.odometry(stamp, pose):
            raise DamagedMessage("a later one came before")

    def _hear_sightings(self, recorded: Recorded, message: Any) -> None:
        self._check_version(recorded.topic, message)
        stamp, frame = message.header.stamp.to_nsec(), frame_name(message.header.frame_id)
        if stamp <= 0:
            raise DamagedMessage("the stamp is zero")
        T = self._T_base_frame(frame, stamp)
        if self._bag.types[recorded.topic] == LANDMARKS:
            sightings = landmark_sightings(message, T)
        else:
            sightings = marker_sightings(message, T, self._run.params.markers)
            for marker in message.markers:
                if not marker.size > 0.0:
                    self._losses.lost(
                        f"{recorded.topic}, marker {marker.id}",
                        "it has no size, tell its detector marker_size",
                    )
        self._run.see(stamp, sightings, view_of(T))

    def _check_version(self, topic: str, message: Any) -> None:
        expected = {LANDMARKS: LandmarkSightings, MARKERS: MarkerArray}[self._bag.types[topic]]
        if message._md5sum != expected._md5sum:
            what = f"the messages on {topic} were recorded by another version of Sextant"
            raise self._bag.error(what, "read it with that version")

    def _T_base_frame(self, frame: str, stamp: int) -> np.ndarray:
        if not frame:
            raise DamagedMessage("it names no frame_id")
        if frame not in self._mounts:
            given = {frame_name(name): np.asarray(T) for name, T in self._topics.mounts.items()}
            self._mounts[frame] = mount_of(self._bag, frame, self._base, given, self._tree)
        mount = self._mounts[frame]
        if mount is None:
            there = _listing(self._tree.frames)
            raise DamagedMessage(
                f"tf does not connect its frame '{frame}' with '{self._base}': name its mount by --mounts, "
                f"or another --base-frame; tf has {there}"
            )
        T = mount(stamp)
        if T is None:
            raise DamagedMessage("tf was not recorded at its stamp")
        return T


def _listing(names: Sequence[str]) -> str:
    return ", ".join(sorted(names)) or "none"

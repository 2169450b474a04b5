# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads odometry and observations of recorded drives in the order of their reception."""

from dataclasses import dataclass, field
from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Union,
)

import numpy as np

import sextant
from sextant.bags.bag_file import BagError, BagFile, Recorded, listed
from sextant.bags.camera_topics import MARKERS
from sextant.bags.mounts import Mount, mount_of
from sextant.bags.odometry import ODOMETRY, odometry_topic
from sextant.bags.stamps import Losses, StampOrder
from sextant.bags.transforms import TransformTree, read_transforms
from sextant.base.strict_params import parse_struct
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

Progress = Callable[[float], None]  # called with the fraction that is done, 0 to 1


@dataclass(frozen=True)
class LandmarkTopics:
    """Topics to read. Empty: the only topic of its type."""

    odometry: str = ""  # nav_msgs/Odometry
    landmarks: str = ""  # sextant/LandmarkObservations
    cameras: Sequence[str] = ()  # sextant/MarkerArray; empty: all, or none if there are landmarks
    base_frame: str = ""  # empty: odometry's child_frame_id
    mounts: Mapping[str, np.ndarray] = field(default_factory=dict)  # T_base_frame by frame; overrides tf
    marker_params: Mapping[str, float] = field(default_factory=dict)  # of sextant.MarkerLandmarkParams
    marker_map: str = ""  # marker map file for ramp_sigma of marker_params; empty: none
    start: float = 0.0  # seconds after a bag's first message
    end: float = float("inf")  # seconds after a bag's first message

    def __post_init__(self) -> None:
        """:raises ValueError: start and end are not an interval"""
        if not 0.0 <= self.start < self.end:
            raise ValueError(f"start is {self.start} and end {self.end}, allowed is 0 <= start < end")


class OdometryReading(NamedTuple):
    """A pose of the robot in the odometry frame."""

    stamp: int  # nanoseconds
    pose: np.ndarray  # (3,) x, y, heading


class SensorScan(NamedTuple):
    """The observations of one message."""

    stamp: int  # nanoseconds
    observations: List["sextant.LabelledObservation"]  # in the robot frame
    T_base_sensor: np.ndarray  # (3,)
    has_markers: bool  # whether it is of printed markers: the sensor misses no other landmark


class RecordedLandmarks(NamedTuple):
    """Odometry and observations of one bag."""

    path: str  # of the bag
    start: float  # seconds, by reception
    end: float  # seconds, by reception
    messages: List[Union[OdometryReading, SensorScan]]  # in the order of their reception
    warnings: Tuple[str, ...]  # how the bag was read


def read_landmarks(path: str, topics: LandmarkTopics, paths: Sequence[str] = ()) -> RecordedLandmarks:
    """Reads a bag.

    :param paths: all bags of a recording that was split: static transforms may only be in an earlier one
    :raises BagError: the bag cannot be read, lacks a topic, or nothing on a topic can be used
    """
    with BagFile(path, topics.start, topics.end) as bag:
        return _Drive(bag, topics, paths).read()


def run_on_recorded(
    recorded: Iterable[RecordedLandmarks], run: SlamRun, progress: Optional[Progress] = None
) -> List[str]:
    """Runs SLAM on the messages of the bags in the order of their times.

    A bag that begins more than LONGEST_BREAK after the end of the last one is another drive.

    :returns: notes on the order of the bags
    :raises ValueError: two bags overlap in time
    """
    in_order = sorted(recorded, key=lambda each: each.start)
    _check_order(in_order)
    total, done, notes, before = sum(len(each.messages) for each in in_order), 0, [], None
    for bag in in_order:
        if before is not None and bag.start - before > LONGEST_BREAK:
            run.start_drive()
            notes.append(f"{bag.path}: begins {bag.start - before:.0f} s later: read as another drive")
        before, old = bag.end, 0
        for message in bag.messages:
            if isinstance(message, OdometryReading):
                old += not run.odometry(*message)
            else:
                run.observe(*message)
            done += 1
            if progress:
                progress(done / total)
        if old:
            notes.append(f"{bag.path}: {old} readings of odometry are not newer than those of the bag before")
    return notes


def _check_order(bags: Sequence[RecordedLandmarks]) -> None:
    for first, second in zip(bags, bags[1:]):
        if second.start < first.end - OVERLAP:
            raise ValueError(
                f"{second.path}: overlaps {first.path} in time; map one of them, then continue its map with "
                "the other"
            )


class _Drive:
    """Reads one bag.

    :raises BagError: a topic does not exist
    """

    def __init__(self, bag: BagFile, topics: LandmarkTopics, paths: Sequence[str]):
        self._bag, self._topics, self._paths = bag, topics, paths
        self._odometry = odometry_topic(bag, topics.odometry)
        if not self._odometry:
            what = f"it contains no {ODOMETRY}, or --odometry is none"
            raise bag.error(what, f"its topics are: {listed(bag.types)}")
        self._tree = read_transforms(bag)
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
        self._marker_params = parse_struct(
            sextant.MarkerLandmarkParams, dict(topics.marker_params), "marker_params", ": "
        )
        self._marker_map = sextant.read_marker_map(topics.marker_map) if topics.marker_map else None
        self._messages: List[Union[OdometryReading, SensorScan]] = []
        self._newest = 0  # stamp of odometry

    def _named(self, message_type: str, names: Sequence[str]) -> List[str]:
        """Topics of a type: the named ones, or else all."""
        found = [self._bag.named(name, message_type, message_type) for name in names]
        return found or list(self._bag.topics(message_type))

    def read(self) -> RecordedLandmarks:
        """:raises BagError: as read_landmarks()"""
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
        for topic in (self._odometry, *self._sources):
            self._losses.check(self._bag, topic)
        unused = {frame_name(name) for name in self._topics.mounts} - set(self._mounts)
        there = listed(self._mounts)
        notes = [
            f"no message has the frame '{name}' of mounts; the frames are: {there}" for name in sorted(unused)
        ]
        warnings = tuple(dict.fromkeys([*self._losses.notes(), *notes, *self._tree.notes]))
        return RecordedLandmarks(self._bag.path, self._bag.start, self._bag.end, self._messages, warnings)

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
        if stamp <= self._newest:
            raise DamagedMessage("its stamp is not newer than that of the last one")
        self._newest = stamp
        self._messages.append(OdometryReading(stamp, pose))

    def _add_observations(self, recorded: Recorded, message: Any) -> None:
        self._check_version(recorded.topic, message)
        stamp, frame = message.header.stamp.to_nsec(), frame_name(message.header.frame_id)
        if stamp <= 0:
            raise DamagedMessage("the stamp is zero")
        T = self._T_base_frame(frame, stamp)
        has_markers = self._bag.types[recorded.topic] == MARKERS
        if not has_markers:
            observations = landmark_observations(message, T)
        else:
            observations = marker_observations(message, T, self._marker_params, self._marker_map)
            for marker in message.markers:
                if not marker.size > 0.0:
                    self._losses.lost(
                        f"{recorded.topic}, marker {marker.id}",
                        "it has no size, set marker_size of its detector",
                    )
        self._messages.append(SensorScan(stamp, observations, planar_sensor_pose(T), has_markers))

    def _check_version(self, topic: str, message: Any) -> None:
        expected = {LANDMARKS: LandmarkObservations, MARKERS: MarkerArray}[self._bag.types[topic]]
        if message._md5sum != expected._md5sum:
            what = f"the messages on {topic} were recorded by another version of Sextant"
            raise self._bag.error(what, "read it with that version")

    def _mount(self, frame: str, tree: TransformTree) -> Optional[Mount]:
        given = {frame_name(name): np.asarray(T) for name, T in self._topics.mounts.items()}
        return mount_of(self._bag, frame, self._base, given, tree)

    def _whole_tree(self) -> TransformTree:
        """With the transforms of earlier bags: static ones are recorded once, in the first of a recording."""
        tree = TransformTree()
        for start, path in sorted(self._starts()):
            if start < self._bag.start:
                with BagFile(path) as bag:
                    read_transforms(bag, tree)
        self._tree = read_transforms(self._bag, tree)
        return self._tree

    def _starts(self) -> Iterator[Tuple[float, str]]:
        """Of all bags that can be read; what is wrong with the others is reported where they are read."""
        for path in self._paths:
            try:
                with BagFile(path) as bag:
                    yield bag.start, path
            except BagError:
                continue

    def _T_base_frame(self, frame: str, stamp: int) -> np.ndarray:
        if not frame:
            raise DamagedMessage("it has no frame_id")
        if frame not in self._mounts:
            self._mounts[frame] = self._mount(frame, self._tree) or self._mount(frame, self._whole_tree())
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

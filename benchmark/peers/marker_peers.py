# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Localization with printed markers by each package that rospack finds, on the same images."""

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, Iterator, List, Optional, Tuple

import numpy as np
import rospkg
import rospy
from ros_session import cpu_seconds, launched, process_id, ros_node, wait_for
from roslib.message import get_message_class
from tables import Table, Value

import sextant
from peers.marker_packages import OTHERS, SEXTANT, MarkerPackage, Result
from peers.shown_drive import Camera, ShownDrive, shown_drive
from sextant.evaluation.trajectory_metrics import summarize, trajectory_errors
from sextant.markers.map_formats import write_map

SIZES, RATE, COUNT, QUICK_COUNT = ((640, 480), (1280, 720)), 15.0, 300, 45  # pixels, Hz, images
START, LAST = 60.0, 1.0  # seconds until the first pose, and after the last image
COLUMNS = ["poses, %", "error, cm: mean", "95 %", "worst", "CPU an image, ms", "latency, ms: median"]
COLUMNS += ["Sextant's error / this", "CPU / this"]
MEAN, CPU = 1, 4  # columns that are compared


@dataclass
class Outcome:
    """Poses from one topic; T_map_camera (4, 4) by the image's stamp, nanoseconds."""

    result: Result
    poses: Dict[int, np.ndarray] = field(default_factory=dict)
    latencies: List[float] = field(default_factory=list)  # seconds
    truth: Dict[int, np.ndarray] = field(default_factory=dict)
    cpu: float = 0.0  # seconds of all nodes of the result

    def figures(self) -> List[float]:
        """Of all COLUMNS but the last two."""
        errors = 100.0 * trajectory_errors(self.truth, self.poses).position
        summary = summarize(errors)
        share, cpu = len(errors) / len(self.truth), self.cpu / len(self.truth)
        latency = np.median(self.latencies or [np.nan])
        return [100.0 * share, summary.mean, summary.p95, summary.worst, 1e3 * cpu, 1e3 * latency]


def is_installed(package: MarkerPackage) -> bool:
    """Whether rospack finds it."""
    return set(package.required) <= set(rospkg.RosPack().list())


def marker_tables(quick: bool) -> List[Table]:
    """A table for each size of the image, on a master of its own.

    :raises OSError: it could not be started
    """
    with ros_node() as folder:
        return [_table(folder, size, quick) for size in (SIZES[:1] if quick else SIZES)]


def _table(folder: Path, size: Tuple[int, int], quick: bool) -> Table:
    count, own, rows = QUICK_COUNT if quick else COUNT, {}, []
    for package in [*SEXTANT, *OTHERS]:
        if not is_installed(package):
            rows.append((f"{package.name}: rospack does not find it", ["-"] * len(COLUMNS)))
            continue
        for outcome in played(package, shown_drive(package.family, size, RATE, count), folder):
            figures = outcome.figures()
            ours = own.setdefault(package.family, figures)  # Sextant is the first with each family
            ratios = [ours[column] / figures[column] for column in (MEAN, CPU)] if ours is not figures else []
            rows.append((outcome.result.name, _cells(figures, ratios, None if quick else 1.0)))
    return Table(f"Markers, {size[0]} x {size[1]} at {RATE:g} Hz, {count} images", COLUMNS, rows)


def _cells(figures: List[float], ratios: List[float], bar: Optional[float]) -> list:
    cells = [Value(figure, digits) for figure, digits in zip(figures, (1, 2, 2, 1, 2, 1))]
    return [*cells, *([Value(ratio, at_most=bar) for ratio in ratios] or ["1", "1"])]


def played(package: MarkerPackage, drive: ShownDrive, folder: Path) -> List[Outcome]:
    """Starts a package and shows it the drive. :raises OSError: no pose came"""
    outcomes = [Outcome(result) for result in package.results]
    subscribers = [_subscriber(each, drive) for each in outcomes]
    camera = Camera(drive)
    launch_file = Path(__file__).with_name(f"{package.name}.launch")
    try:
        with launched(launch_file, _arguments(package, drive, folder)):
            _show(camera, drive, package.name, outcomes)
    finally:
        for each in [*subscribers, camera]:
            each.unregister()
    return outcomes


def _arguments(package: MarkerPackage, drive: ShownDrive, folder: Path) -> Dict[str, str]:
    own_map = folder / f"{package.name}.{'txt' if package.map_format == 'fiducial_slam' else 'yaml'}"
    sextant.write_marker_map(drive.map, str(folder / "map.yaml"))
    if package.map_format:
        write_map(drive.map, str(own_map), package.map_format)
    size, tags = drive.map.markers[0].size, [{"id": each.id, "size": each.size} for each in drive.map.markers]
    values = {
        "family": package.family,
        "size": size,
        "map": folder / "map.yaml",
        "own_map": own_map,
        "tags": tags,
    }
    return {name: str(value) for name, value in values.items()}


def _subscriber(outcome: Outcome, drive: ShownDrive) -> rospy.Subscriber:
    def on_message(message) -> None:
        now = rospy.Time.now()
        reading = outcome.result.read(message, drive)
        if reading is not None:
            stamp, T_map_base = reading
            outcome.poses[stamp] = T_map_base @ drive.T_base_camera
            outcome.latencies.append(1e-9 * (now.to_nsec() - stamp))

    topic, message_class = outcome.result.topic, get_message_class(outcome.result.type)
    return rospy.Subscriber(topic, message_class, on_message, queue_size=100, tcp_nodelay=True)


def _show(camera: Camera, drive: ShownDrive, package: str, outcomes: List[Outcome]) -> None:
    wait_for(f"a subscriber of the images ({package})", lambda: camera.has_subscribers, START)
    wait_for(f"the first pose of each topic ({package})", lambda: _answered(camera, outcomes), START)
    time.sleep(LAST)
    for each in outcomes:
        each.poses.clear()
        each.latencies.clear()
    before = [_cpu(each) for each in outcomes]
    truth = dict(_played_in_time(camera, drive))
    time.sleep(LAST)
    for each, start in zip(outcomes, before):
        each.cpu, each.truth = _cpu(each) - start, truth


def _answered(camera: Camera, outcomes: List[Outcome]) -> bool:
    camera.show(0)
    time.sleep(0.2)
    return all(each.poses for each in outcomes)


def _played_in_time(camera: Camera, drive: ShownDrive) -> Iterator[Tuple[int, np.ndarray]]:
    """Stamp and true T_map_camera of each image."""
    rate = rospy.Rate(RATE)
    for number, T_map_base in enumerate(drive.truth):
        rate.sleep()
        yield camera.show(number), T_map_base @ drive.T_base_camera


def _cpu(outcome: Outcome) -> float:
    return sum(cpu_seconds(process_id(node)) for node in outcome.result.nodes)

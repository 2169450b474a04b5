# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The nodelets from image to pose in one manager: what they cost against one plain search of the same frames,
how late and how far off the pose is."""

import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from ros_session import cpu_seconds, launched, process_id, ros_node, wait_for
from std_srvs.srv import SetBool
from tables import Table, Value
from tf2_ros import StaticTransformBroadcaster

from markers.chain_frames import ROUND, PlayedDrive, play_of
from markers.detector_speed import APRILTAG, ARUCO, PLAIN
from sextant.evaluation.trajectory_metrics import summarize, trajectory_errors
from sextant.messages.pose_messages import pose_from_message, transform_to_message

RATE = 30.0  # Hz
ROUNDS, QUICK_FRAMES = 3, 90
SHARE = 0.99  # of the images in which a pose can be computed
START = 120.0  # seconds to start all nodes and to decode the frames
EARLY = 0.1  # of a period, that a stamp may be early by rounding
DIAGNOSTICS_PERIOD = 1.0  # seconds
COLUMNS = ["poses, %", "late images", "CPU a frame, ms", "of the library's", "library's CPU, ms"]
COLUMNS += ["latency, ms: median", "95 %", "of the library's time", "library's time, ms"]
COLUMNS += ["joint, cm: mean", "joint, cm: 95 %"]


class Bars(NamedTuple):
    """CPU and median latency over those of the plain library, position errors in cm."""

    cpu: Optional[float] = None
    latency: Optional[float] = None
    mean: Optional[float] = None
    p95: Optional[float] = None
    share: Optional[float] = 100.0 * SHARE
    late: Optional[int] = 0  # images that the driver showed late: another program had the machine


NO_BARS = Bars(share=None, late=None)
BARS = {
    (1280, 720): {ARUCO: Bars(0.045, 0.3, 0.4, 1.2), APRILTAG: Bars(0.12, None, 0.4, 1.2)},
    (640, 480): {ARUCO: Bars(0.1, 0.3, 1.2, 3.2), APRILTAG: Bars(0.25, None, 1.2, 3.2)},
}


@dataclass
class Stage:
    """Time of one stage of a nodelet, ms."""

    total: float = 0.0
    longest: float = 0.0
    runs: int = 0

    def add(self, mean: float, longest: float, runs: int) -> None:
        self.total += mean * runs
        self.longest = max(self.longest, longest)
        self.runs += runs


@dataclass
class Run:
    """Result of one run of the chain."""

    poses: Dict[int, np.ndarray] = field(default_factory=dict)  # T_map_base by the image's stamp in ns
    latencies: List[float] = field(default_factory=list)  # seconds from an image's stamp to its pose
    stages: Dict[Tuple[str, str], Stage] = field(default_factory=dict)  # by nodelet's task and stage
    facts: Dict[str, Dict[str, str]] = field(default_factory=dict)  # newest diagnostics by task
    cpu: float = 0.0  # seconds of the manager

    def on_pose(self, message: PoseWithCovarianceStamped) -> None:
        self.latencies.append((rospy.Time.now() - message.header.stamp).to_sec())
        self.poses[message.header.stamp.to_nsec()] = pose_from_message(message.pose.pose)

    def on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            task = status.name.split(": ")[-1]
            rows = {row.key: row.value for row in status.values}
            self.facts[task] = rows
            for name in (key[: -len(": runs")] for key in rows if key.endswith(": runs")):
                stage = self.stages.setdefault((task, name), Stage())
                mean, longest, runs = (rows[f"{name}: {what}"] for what in ("mean ms", "max ms", "runs"))
                stage.add(float(mean), float(longest), int(runs))

    def fact(self, task: str, key: str) -> int:
        """A counter of the diagnostics; 0 while it is not there."""
        return int(self.facts.get(task, {}).get(key, 0))


def chain_tables(quick: bool) -> List[Table]:
    """Two tables a size, on a master of their own; a quick run is a short one of one size, without bars.

    :raises OSError: it could not be started
    """
    count = QUICK_FRAMES if quick else ROUND
    tables = []
    with ros_node() as folder:
        for size in list(BARS)[-1:] if quick else BARS:
            tables += _size_tables(folder, size, count, 1 if quick else ROUNDS, quick)
    return tables


def _size_tables(folder: Path, size: Tuple[int, int], count: int, rounds: int, quick: bool) -> List[Table]:
    load, rows, samples, stages = os.getloadavg()[0], [], {}, []
    what = f"{size[0]} x {size[1]} at {RATE:g} Hz, {count * rounds} frames"
    for family, bars in BARS[size].items():
        played = play_of(folder / f"{family}_{size[0]}", family, size, count)
        run = _run(played, family, rounds)
        rows.append((f"{family} / {PLAIN[family]}", _cells(run, played, rounds, NO_BARS if quick else bars)))
        samples[family] = 1e3 * np.array(run.latencies)
        stages.append(_stage_table(f"{family}, {what}", run))
    title = f"Chain from image to pose, {what}; load average before: {load:.1f}"
    return [Table(title, COLUMNS, rows, samples), *stages]


def _run(played: PlayedDrive, family: str, rounds: int) -> Run:
    tf = StaticTransformBroadcaster()
    tf.sendTransform(_mount(played.T_base_camera))
    settings = {"families": f"[{family}]", "rate": RATE}
    count, run = rounds * len(played.truth), Run()
    subscribers = [
        rospy.Subscriber("pose", PoseWithCovarianceStamped, run.on_pose, queue_size=100, tcp_nodelay=True),
        rospy.Subscriber("/diagnostics", DiagnosticArray, run.on_diagnostics, queue_size=100),
    ]
    with launched(Path(__file__).with_name("chain.launch"), {**played.arguments, **settings, "count": count}):
        _play(run, count)
    for subscriber in subscribers:
        subscriber.unregister()
    return run


def _mount(T_base_camera: np.ndarray) -> TransformStamped:
    message = TransformStamped(child_frame_id="camera_optical_frame")
    message.header.frame_id = "base_link"
    message.transform = transform_to_message(T_base_camera)
    return message


def _play(run: Run, count: int) -> None:
    wait_for("the marker map", lambda: run.fact("localization", "markers in the map") > 0, START)
    wait_for("the camera driver", lambda: "published" in run.facts.get("camera", {}), START)
    manager = process_id("/sextant_manager")
    before = cpu_seconds(manager)
    rospy.ServiceProxy("marker_detector/enable", SetBool)(True)
    wait_for("the first pose", lambda: run.poses, START)
    wait_for("the last image", lambda: run.fact("camera", "published") >= count, START + 2 * count / RATE)
    run.cpu = cpu_seconds(manager) - before
    time.sleep(2 * DIAGNOSTICS_PERIOD)  # the last second's stages


def _cells(run: Run, played: PlayedDrive, rounds: int, bars: Bars) -> List[Value]:
    poses, latency = numbered(run, played, rounds), 1e3 * np.array(run.latencies)
    truth = dict(enumerate(played.truth * rounds))
    position = 100.0 * trajectory_errors(truth, {k: pose for k, pose in poses.items() if k in truth}).position
    located = sum(number % len(played.truth) in played.locatable for number in poses)
    cpu, plain_cpu = 1e3 * run.cpu / len(truth), 1e3 * float(np.mean(played.plain_cpu))
    median, plain = float(np.median(latency)), 1e3 * float(np.median(played.plain_wall))
    return [
        Value(100.0 * located / (rounds * len(played.locatable)), 1, at_least=bars.share),
        Value(run.fact("camera", "late"), 0, at_most=bars.late),
        Value(cpu),
        Value(cpu / plain_cpu, 3, at_most=bars.cpu),
        Value(plain_cpu),
        Value(median),
        Value(np.percentile(latency, 95)),
        Value(median / plain, 3, at_most=bars.latency),
        Value(plain),
        Value(summarize(position).mean, at_most=bars.mean),
        Value(summarize(position).p95, at_most=bars.p95),
    ]


def numbered(run: Run, played: PlayedDrive, rounds: int) -> Dict[int, np.ndarray]:
    """Poses by the number of their image, computed from the stamp: the driver is never early, and less
    than half a period late on an idle machine. Counted from the last pose: while nodelets connect with one
    another, a first image may be lost."""
    stamps = sorted(run.poses)
    ticks = (np.array(stamps) - stamps[0]) * 1e-9 * RATE
    ticks -= (ticks - np.round(ticks)).min()
    ticks = np.floor(ticks + EARLY).astype(int)
    last = (rounds - 1) * len(played.truth) + played.locatable[-1]
    return {int(number): run.poses[stamp] for number, stamp in zip(ticks - ticks[-1] + last, stamps)}


def _stage_table(name: str, run: Run) -> Table:
    rows = [
        (f"{task}: {stage}", [Value(time.total / time.runs, 3), Value(time.longest, 3)])
        for (task, stage), time in sorted(run.stages.items())
    ]
    return Table(f"Time per stage, {name}, ms an image", ["mean", "max"], rows)

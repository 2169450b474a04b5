# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the nodelets keep up with 1280 x 720 at 30 Hz: rendered frames, image to pose in one manager."""

import os
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import numpy as np
import rospy
from chain_frames import PLAYED_FRAMES_A_RENDERED_ONE, drive_of, write_drive
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from ros_session import cpu_seconds, launched, process_id, ros_master, wait_for
from std_srvs.srv import SetBool
from tables import Table, Value
from tf2_ros import StaticTransformBroadcaster
from under_test import detector

from sextant.nodes.conversions import transform_to_message
from sextant.simulation.drive import SimulatedDrive

RATE = 30.0  # Hz
FRAMES = 1800
QUICK_FRAMES = 90
SHARE = 0.99  # of the frames that must have a pose
START = 120.0  # seconds to start all nodes and to decode the frames
SILENCE = 5.0  # seconds without a pose after which no more are waited for
DIAGNOSTICS_PERIOD = 1.0  # seconds

CHAINS = {"ArUco": ("DICT_4X4_50", 1.0), "AprilTag, decimate 2": ("tag36h11", 2.0)}  # family, decimate


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
    """What one run of the chain told."""

    latencies: Dict[int, float] = field(default_factory=dict)  # seconds by the image's stamp in ns
    stages: Dict[Tuple[str, str], Stage] = field(default_factory=dict)  # by nodelet's task and stage
    facts: Dict[str, Dict[str, str]] = field(default_factory=dict)  # newest diagnostics by task
    cpu: float = 0.0  # seconds of the manager

    def on_pose(self, message: PoseWithCovarianceStamped) -> None:
        now = rospy.Time.now()
        self.latencies[message.header.stamp.to_nsec()] = (now - message.header.stamp).to_sec()

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
    """Runs each chain on a master of its own. :raises OSError: it could not be started"""
    count, load = QUICK_FRAMES if quick else FRAMES, os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder, ros_master(Path(folder) / "logs"):
        rospy.init_node("benchmark", argv=["benchmark"], anonymous=True, disable_signals=True)
        try:
            runs = {
                name: _run(Path(folder) / family, family, decimate, count)
                for name, (family, decimate) in CHAINS.items()
            }
        finally:
            rospy.signal_shutdown("measured")
    bar = None if quick else SHARE * count
    return [_keeping_up(runs, count, bar, load), *(_stage_table(name, run) for name, run in runs.items())]


def _run(folder: Path, family: str, decimate: float, count: int) -> Run:
    drive = drive_of(family)
    find = detector(family, decimate=decimate)
    files = write_drive(folder, drive, find, count // PLAYED_FRAMES_A_RENDERED_ONE)
    tf = StaticTransformBroadcaster()
    tf.sendTransform(_mount(drive))
    arguments = {**files, "families": f"[{family}]", "decimate": decimate, "rate": RATE, "count": count}
    run = Run()
    subscribers = [
        rospy.Subscriber("pose", PoseWithCovarianceStamped, run.on_pose, queue_size=100, tcp_nodelay=True),
        rospy.Subscriber("/diagnostics", DiagnosticArray, run.on_diagnostics, queue_size=100),
    ]
    with launched(Path(__file__).with_name("chain.launch"), arguments):
        _play(run, count)
    for subscriber in subscribers:
        subscriber.unregister()
    return run


def _mount(drive: SimulatedDrive) -> TransformStamped:
    message = TransformStamped(child_frame_id="camera_optical_frame")
    message.header.frame_id = "base_link"
    message.transform = transform_to_message(drive.T_base_camera)
    return message


def _play(run: Run, count: int) -> None:
    wait_for("the marker map", lambda: run.fact("localization", "markers in the map") > 0, START)
    wait_for("the camera driver", lambda: "published" in run.facts.get("camera", {}), START)
    manager = process_id("/sextant_manager")
    before = cpu_seconds(manager)
    rospy.ServiceProxy("marker_detector/enable", SetBool)(True)
    wait_for("the first pose", lambda: run.latencies, START)
    seen, last = 0, time.monotonic()
    while len(run.latencies) < count and time.monotonic() < last + SILENCE:
        if len(run.latencies) > seen:
            seen, last = len(run.latencies), time.monotonic()
        time.sleep(0.1)
    run.cpu = cpu_seconds(manager) - before
    time.sleep(2 * DIAGNOSTICS_PERIOD)  # the last second's stages


def _keeping_up(runs: Dict[str, Run], count: int, bar: Optional[float], load: float) -> Table:
    columns = ["poses", "images a second", "latency, ms: mean", "95 %", "CPU of the manager, ms a frame"]
    rows = [(name, _keeping_up_cells(run, count, bar)) for name, run in runs.items()]
    title = f"Chain from image to pose, 1280 x 720 at {RATE:g} Hz, {count} frames"
    return Table(f"{title}; load of the machine before: {load:.1f}", columns, rows)


def _keeping_up_cells(run: Run, count: int, bar: Optional[float]) -> List[Value]:
    latencies, stamps = np.array(list(run.latencies.values())) * 1e3, sorted(run.latencies)
    return [
        Value(len(stamps), 0, at_least=bar),
        Value(run.fact("camera", "published") / ((stamps[-1] - stamps[0]) * 1e-9 + 1.0 / RATE)),
        Value(latencies.mean(), 1),
        Value(np.percentile(latencies, 95), 1),
        Value(run.cpu / count * 1e3, 1),
    ]


def _stage_table(name: str, run: Run) -> Table:
    stages = sorted(run.stages.items())
    rows = [
        (f"{task}: {stage}", [Value(time.total / time.runs, 3), Value(time.longest, 3)])
        for (task, stage), time in stages
    ]
    return Table(f"Time per stage, {name}, ms an image", ["mean", "max"], rows)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU time and memory of the nodes of building_demo.launch, without those of the simulator and of rviz.

They are measured from the first recognized place on, while the robot drives its rounds: what is done once for
a new map (describing its photos, triangulating points) is left out. Memory that processes share is counted in
each.
"""

import re
import time
from pathlib import Path
from typing import Dict, List, Optional

import numpy as np
import rosgraph
import rospy
import yaml
from ros_session import cpu_seconds, launched, process_id, resident_bytes, ros_node, wait_for
from tables import Row, Table, Value

from sextant.msg import MarkerArray, PlaceHypotheses

LAUNCH = Path(__file__).parents[2] / "launch" / "building_demo.launch"
IMAGES, ODOMETRY_PER_IMAGE = 15, 2  # images a second
PERIODS, QUICK_PERIODS, PERIOD = 120, 5, 1.0  # seconds of a period
SPACING, QUICK_SPACING = 2.0, 10.0  # metres between photos
START, QUICK_START = 600.0, 240.0  # seconds until the photos are rendered and described
OTHERS = ("/building_simulator", "/benchmark", "/rosout")  # beginnings of names
SHOWN = 0.005  # cores: nodes with less are in the sum only
CORES, KEPT = 1.0, 0.95  # of all nodes; share of the images
ALL = "all nodes"
ANONYMOUS = re.compile(r"_[^_]+_\d+_\d+$")  # what roslaunch's $(anon NAME) adds: host, process, random number
COLUMNS = ["cores (median)", "95 %", "memory, MB", "images/s"]


def cost_tables(quick: bool) -> List[Table]:
    """One table, on a master of its own; a quick run has no bars. :raises OSError: it could not be started"""
    with ros_node() as folder:
        params = folder / "simulator.yaml"
        rates = {"odometry_rate": ODOMETRY_PER_IMAGE * IMAGES, "images_every": ODOMETRY_PER_IMAGE}
        params.write_text(yaml.safe_dump(rates))
        spacing = str(QUICK_SPACING if quick else SPACING)
        given = {"folder": f"{folder}/building", "spacing": spacing, "simulator_params": str(params)}
        with launched(LAUNCH, given):
            return _measured(QUICK_PERIODS if quick else PERIODS, quick)


def _measured(periods: int, quick: bool) -> List[Table]:
    places: List = []
    subscriber = rospy.Subscriber("places/hypotheses", PlaceHypotheses, places.append, queue_size=1)
    wait_for("a recognized place", lambda: places, QUICK_START if quick else START)
    subscriber.unregister()
    images: List = []
    rospy.Subscriber("markers", MarkerArray, lambda _: images.append(1), queue_size=100)
    processes = _processes()
    begin, shown = time.monotonic(), len(images)
    cores = _cores(list(processes.values()), periods)
    rate = (len(images) - shown) / (time.monotonic() - begin)
    memory = np.array([resident_bytes(each) for each in processes.values()]) / 1e6
    rows = _rows(processes, cores, memory, rate, quick)
    return [Table(f"Nodes at {IMAGES} images/s of 640 x 480", COLUMNS, rows)]


def _processes() -> Dict[str, int]:
    """Process ids of the nodes by name."""
    topics, services = rosgraph.Master("/benchmark").getSystemState()[::2]
    names = {node for kind in (topics, services) for _, nodes in kind for node in nodes}
    return {name: process_id(name) for name in sorted(names) if not name.startswith(OTHERS)}


def _cores(processes: List[int], periods: int) -> np.ndarray:
    """(periods, processes) CPU seconds per second."""
    times, used = [time.monotonic()], [[cpu_seconds(each) for each in processes]]
    for _ in range(periods):
        time.sleep(PERIOD)
        times.append(time.monotonic())
        used.append([cpu_seconds(each) for each in processes])
    return np.diff(used, axis=0) / np.diff(times)[:, None]


def _rows(
    processes: Dict[str, int], cores: np.ndarray, memory: np.ndarray, rate: float, quick: bool
) -> List[Row]:
    names = [ANONYMOUS.sub("", name.strip("/")) for name in processes]
    members = {name: [k for k, other in enumerate(names) if other == name] for name in names}
    rows: List[Row] = [
        (name, [*_figures(cores[:, of].sum(axis=1)), Value(memory[of].sum(), 0), "-"])
        for name, of in members.items()
        if np.median(cores[:, of].sum(axis=1)) >= SHOWN
    ]
    most, least = (None, None) if quick else (CORES, KEPT * IMAGES)
    total = _figures(cores.sum(axis=1), most)
    return [*rows, (ALL, [*total, Value(memory.sum(), 0), Value(rate, 1, at_least=least)])]


def _figures(cores: np.ndarray, most: Optional[float] = None) -> List[Value]:
    return [Value(float(np.median(cores)), 2, at_most=most), Value(float(np.quantile(cores, 0.95)), 2)]

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a ROS master and launch files for a benchmark; all of them end with their context."""

import os
import signal
import socket
import subprocess
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Callable, Dict, Iterator, TypeVar
from xmlrpc.client import ServerProxy

import rosgraph
import rospy

from sextant.nodes.base.init_node import mend_rospy

mend_rospy()
END = 20.0  # time for a launch file to end its nodes, seconds
Result = TypeVar("Result")


def in_own_process(measure: Callable[..., Result], *arguments) -> Result:
    """Calls a function in a process of its own, as rospy starts once in a process; raises its errors."""
    with ProcessPoolExecutor(1) as executor:
        return executor.submit(measure, *arguments).result()


@contextmanager
def ros_node(use_sim_time: bool = False) -> Iterator[Path]:
    """Runs a master and makes this process a node, once in a process. Yields a temporary folder."""
    with tempfile.TemporaryDirectory() as folder, ros_master(Path(folder) / "logs"):
        rospy.set_param("/use_sim_time", use_sim_time)
        rospy.init_node("benchmark", argv=["benchmark"], anonymous=True, disable_signals=True)
        try:
            yield Path(folder)
        finally:
            rospy.signal_shutdown("measured")


@contextmanager
def ros_master(logs: Path) -> Iterator[None]:
    """Runs a roscore on a free port, and sets ROS_MASTER_URI and related variables of this process."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        port = probe.getsockname()[1]
    for name in ("ROS_NAMESPACE", "ROS_IP"):
        os.environ.pop(name, None)
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    os.environ["ROS_HOSTNAME"] = "localhost"
    os.environ["ROS_LOG_DIR"] = str(logs)
    with _running(["roscore", "-p", str(port)]):
        wait_for("the master", rosgraph.is_master_online, 30.0)
        yield


@contextmanager
def launched(path: Path, arguments: Dict[str, str]) -> Iterator[None]:
    """Runs a launch file with arguments."""
    with _running(["roslaunch", str(path), *(f"{name}:={value}" for name, value in arguments.items())]):
        yield


@contextmanager
def _running(command: list) -> Iterator[None]:
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            process.send_signal(signal.SIGINT)  # roslaunch then ends its nodes
            try:
                process.wait(END)
            except subprocess.TimeoutExpired:
                process.terminate()


def wait_for(what: str, condition: Callable[[], bool], timeout: float) -> None:
    """Waits until a condition is true.

    :param what: what is awaited, for the error
    :raises TimeoutError: the condition is not true within timeout seconds
    """
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what} did not come within {timeout:.0f} s")
        time.sleep(0.05)


def process_id(node: str) -> int:
    """Process id of the process that runs a node."""
    return ServerProxy(rosgraph.Master("/benchmark").lookupNode(node)).getPid("/benchmark")[2]


def cpu_seconds(pid: int) -> float:
    """User and system CPU time of a process, seconds (proc(5): fields 14 and 15)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident_bytes(pid: int) -> int:
    """Memory of a process that is not swapped out, bytes (proc(5): the second field of statm)."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

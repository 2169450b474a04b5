# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot and viewer in two network namespaces, between them a poor link: 2 Mbit/s, 2 % of the packets lost."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Dict, List, NamedTuple

import pytest

HELPERS = Path(__file__).resolve().parents[1]
ROBOT, VIEWER = "10.213.77.1", "10.213.77.2"
MASTER = f"http://{ROBOT}:11311"
POSE = "geometry_msgs/PoseWithCovarianceStamped"


def ip(*args):
    return subprocess.run(["ip", *args], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def why_not():
    """Why namespaces cannot be had here; empty: they can."""
    if os.geteuid() != 0:
        return "needs root: network namespaces"
    for command, package in (
        ("ip", "iproute2"),
        ("tc", "iproute2"),
        ("nft", "nftables"),
        ("xvfb-run", "xvfb"),
    ):
        if not shutil.which(command):
            return f"needs the command {command} (package {package})"
    command = ["unshare", "--mount", "--propagation", "slave", "true"]
    private = subprocess.run(command, capture_output=True, text=True)
    if private.returncode:  # a chroot: ip would leave its mounts behind
        return "no mounts of its own here: " + private.stderr.strip()
    name = f"sextant_try_{os.getpid()}"
    tried = ip("netns", "add", name)
    ip("netns", "del", name)
    return "no network namespaces here: " + tried.stdout.strip() if tried.returncode else ""


REASON = why_not()
pytestmark = pytest.mark.skipif(bool(REASON), reason=REASON)


def inside(namespace, *command):
    return ["ip", "netns", "exec", namespace, *command]


def environment(**more):
    kept = {
        key: value for key, value in os.environ.items() if key not in ("ROS_IP", "ROS_HOSTNAME", "DISPLAY")
    }
    return {**kept, "LIBGL_ALWAYS_SOFTWARE": "1", **more}


class System(NamedTuple):
    """What view.launch shows."""

    robot: List[str]  # arguments of roslaunch on the robot
    view: List[str]  # of view.launch, besides `system`
    pose: str  # topic
    topics: Dict[str, str]  # what the viewer has to receive besides: topic, type
    displayed: str  # a topic to which rviz subscribes
    images: List[str]  # that are transmitted compressed


DRAWING, PICTURE = "visualization_msgs/MarkerArray", "sensor_msgs/Image"
SYSTEMS = {
    "markers": System(
        ["demo.launch", "frames:=0", "plot:=none"],
        ["pose:=joint/pose", "visualization:=joint/visualization"],
        "joint/pose",
        {"markers": "sextant/MarkerArray", "marker_map": DRAWING, "laptop_image/image": PICTURE},
        "/marker_map",
        ["/markers/image"],
    ),
    "places": System(
        ["places_demo.launch", "spacing:=8.0"],
        [],
        "pose",
        {
            "places/overview": "nav_msgs/OccupancyGrid",
            "places/map": DRAWING,
            "laptop_image/image": PICTURE,
            "laptop_matches/image": PICTURE,
        },
        "/places/overview",
        ["/places/image", "/matches/image"],
    ),
    "landmarks": System(
        ["landmarks_demo.launch"], [], "pose", {"landmark_map": DRAWING}, "/landmark_map", []
    ),
    "ball": System(
        ["ball_task.launch", "speed:=0.5"],
        [],
        "pose",
        {"landmark_map": DRAWING, "laptop_image/image": PICTURE},
        "/landmark_map",
        ["/objects/image"],
    ),
}


@pytest.fixture
def namespaces():
    names = [f"sextant_{side}_{os.getpid()}" for side in ("robot", "viewer")]
    commands = [["netns", "add", name] for name in names]
    commands += [
        ["-n", names[0], "link", "add", "cable", "type", "veth", "peer", "name", "cable", "netns", names[1]]
    ]
    for name, address in zip(names, (ROBOT, VIEWER)):
        commands += [["-n", name, "addr", "add", address + "/24", "dev", "cable"]]
        commands += [["-n", name, "link", "set", device, "up"] for device in ("lo", "cable")]
    try:
        for command in commands:
            done = ip(*command)
            assert done.returncode == 0, f"ip {' '.join(command)}: {done.stdout}"
        for name in names:
            make_poor(name)
        yield names
    finally:
        for name in names:
            ip("netns", "del", name)


def make_poor(namespace):
    """Limits what leaves on the cable, and drops a part of what arrives."""
    lossy = "add table inet poor; add chain inet poor in { type filter hook input priority 0; }; "
    lossy += "add rule inet poor in iifname cable numgen random mod 100 < 2 drop"
    slow = "tc qdisc add dev cable root tbf rate 2mbit burst 16kb latency 300ms"
    for command in (slow.split(), ["nft", lossy]):
        subprocess.run(inside(namespace, *command), check=True, timeout=20)


@pytest.fixture
def start(tmp_path):
    running = []

    def start_process(command, env):
        log = open(tmp_path / f"{len(running)}.log", "w+")  # noqa: SIM115
        running.append(
            (subprocess.Popen(command, env=env, stdout=log, stderr=log, start_new_session=True), log)
        )

    yield start_process
    for process, _ in reversed(running):
        os.killpg(process.pid, signal.SIGINT)
    for process, log in reversed(running):
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
        log.seek(0)
        print(log.read())
        log.close()


def master_answers(namespace, seconds):
    env = environment(ROS_MASTER_URI=MASTER)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        done = subprocess.run(inside(namespace, "rostopic", "list"), env=env, capture_output=True)
        if done.returncode == 0:
            return True
        time.sleep(0.5)
    return False


def helper(namespace, name, *args):
    """A script beside the rooms of the tests, running on one side; it prints JSON."""
    env = environment(ROS_MASTER_URI=MASTER, ROS_HOSTNAME=ROBOT if "robot" in namespace else VIEWER)
    command = inside(namespace, sys.executable, str(HELPERS / name), *args)
    return subprocess.Popen(command, env=env, stdout=subprocess.PIPE, text=True)


def answer_of(process, timeout):
    output, _ = process.communicate(timeout=timeout)
    return json.loads(output.splitlines()[-1])


@pytest.fixture
def launched(namespaces, start):
    """Starts the robot and, some seconds later, when the latched topics have been published, the viewer."""
    robot, viewer = namespaces

    def launch(name):
        system = SYSTEMS[name]
        on_robot = environment(ROS_MASTER_URI=MASTER, ROS_HOSTNAME=ROBOT)
        start(inside(robot, "roslaunch", "sextant", *system.robot), on_robot)
        assert master_answers(viewer, 60)
        time.sleep(5)
        own = [f"system:={name}", "master:=" + MASTER, "hostname:=" + VIEWER, "name:=laptop"]
        view = ["xvfb-run", "-a", "roslaunch", "sextant", "view.launch", *own, *system.view]
        start(inside(viewer, *view), environment())
        return system

    return launch


@pytest.mark.slow
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_late_viewer_gets_everything_over_a_poor_link(name, namespaces, launched):
    robot, viewer = namespaces
    system = launched(name)
    topics = [f"{topic}:{kind}" for topic, kind in {**system.topics, system.pose: POSE}.items()]
    received = answer_of(helper(viewer, "late_listener.py", "120", "/laptop", system.displayed, *topics), 150)
    assert received["missing"] == []
    for image in system.images:
        assert on_laptop(received, image + "/compressed")
        assert not on_laptop(received, image)  # nothing raw is transmitted
    if name == "markers":  # what was drawn before is removed; a board and an id a marker
        assert {*"01234567", "camera_optical_frame"} <= set(received["frames"])
        assert received["sizes"]["marker_map"] == 1 + 2 * 8
    local, remote = received_poses(namespaces, system.pose)
    assert len(local) >= 5
    assert len(local & remote) >= 0.95 * len(local)


def on_laptop(received, topic):
    return [node for node in received["subscribers"].get(topic, []) if "laptop" in node]


def received_poses(namespaces, topic):
    """Stamps of the poses that were received on the robot, and of those on the viewer."""
    seconds = ("20", "30")  # the viewer records longer: either side may begin some seconds before the other
    recorders = [helper(side, "stamp_recorder.py", topic, each) for side, each in zip(namespaces, seconds)]
    local, remote = (set(answer_of(each, 90)) for each in recorders)
    begin, end = max(min(local), min(remote)), max(local)
    return {stamp for stamp in local if begin <= stamp < end - 1.0}, remote  # the last may be under way


@pytest.mark.slow
def test_a_lost_link_does_not_fill_the_robots_memory(namespaces, launched):
    robot, viewer = namespaces
    system = launched("markers")
    topics = [f"{topic}:{kind}" for topic, kind in system.topics.items()]
    listener = helper(viewer, "late_listener.py", "120", "/laptop", system.displayed, *topics)
    assert answer_of(listener, 150)["missing"] == []
    before = memory_of_nodes(robot)
    assert ip("-n", robot, "link", "set", "cable", "down").returncode == 0
    time.sleep(60)
    after = memory_of_nodes(robot)
    assert ip("-n", robot, "link", "set", "cable", "up").returncode == 0
    assert len(before) >= 4
    grown = {name: after[name] - before[name] for name in before}
    assert max(grown.values()) < 8.0, f"MB: {grown}"
    listener = helper(viewer, "late_listener.py", "60", "", "", f"{system.pose}:{POSE}")
    assert answer_of(listener, 90)["missing"] == []


def memory_of_nodes(namespace):
    """Resident memory in MB of the processes of a namespace that are nodes of ROS, by pid and command."""
    pids = ip("netns", "pids", namespace).stdout.split()
    found = {}
    for pid in pids:
        command = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
        if any(part.startswith("__name:=") for part in command):
            name = next(part for part in command if part.startswith("__name:="))
            status = Path(f"/proc/{pid}/status").read_text()
            found[pid, name] = int(status.split("VmRSS:")[1].split()[0]) / 1024
    return found

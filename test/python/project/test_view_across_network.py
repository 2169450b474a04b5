# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot and viewer in two network namespaces: each is reached by its address alone."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

HELPERS = Path(__file__).resolve().parents[1]
ROBOT, VIEWER = "10.213.77.1", "10.213.77.2"
MASTER = f"http://{ROBOT}:11311"


def ip(*args):
    return subprocess.run(["ip", *args], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def why_not():
    """Why namespaces cannot be had here; empty: they can."""
    if os.geteuid() != 0:
        return "needs root: network namespaces"
    if not shutil.which("ip"):
        return "needs the command ip (package iproute2)"
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
        yield names
    finally:
        for name in names:
            ip("netns", "del", name)


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
        if (
            subprocess.run(inside(namespace, "rostopic", "list"), env=env, capture_output=True).returncode
            == 0
        ):
            return True
        time.sleep(0.5)
    return False


@pytest.mark.slow
def test_a_late_viewer_gets_everything(namespaces, start):
    robot, viewer = namespaces
    view = [
        "roslaunch",
        "sextant",
        "view.launch",
        "master:=" + MASTER,
        "hostname:=" + VIEWER,
        "pose:=joint/pose",
        "visualization:=joint/visualization",
        "name:=laptop",
    ]
    rviz = ["/laptop"] if shutil.which("xvfb-run") else []
    if rviz:
        view = ["xvfb-run", "-a", *view]
    else:
        view.append("rviz:=false")
    demo = ["roslaunch", "sextant", "demo.launch", "frames:=0", "plot:=none"]
    start(inside(robot, *demo), environment(ROS_MASTER_URI=MASTER, ROS_HOSTNAME=ROBOT))
    assert master_answers(viewer, 30)
    time.sleep(5)  # the viewer comes late: the latched topics have been published
    start(inside(viewer, *view), environment())
    helper = [sys.executable, str(HELPERS / "late_listener.py")]
    listen = [*helper, "joint/pose", "laptop_image/image", "60", *rviz]
    answer = subprocess.run(
        inside(viewer, *listen),
        env=environment(ROS_MASTER_URI=MASTER, ROS_HOSTNAME=VIEWER),
        stdout=subprocess.PIPE,
        text=True,
        timeout=90,
    )
    received = json.loads(answer.stdout.splitlines()[-1])
    assert {*"01234567", "camera_optical_frame"} <= set(received["frames"])
    assert received["pose"] == "map"
    assert received["markers"] == "camera_optical_frame"
    assert received["boards"] == 1 + 2 * 8  # what was drawn before is removed; a board and an id a marker
    assert received["picture"] == [640, "bgr8"]
    assert "/laptop_image" in received["subscribers"]["/markers/image/compressed"]
    assert "/markers/image" not in received["subscribers"]  # nothing raw crosses the network
    assert set(rviz) <= set(received["subscribers"]["/marker_map"])

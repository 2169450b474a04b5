# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random faults in random order on all systems at once, between good input. Called by soak.sh.

After each fault all systems must answer good input again: within a second, or within RESTART seconds if nodes
or roscore were restarted in the last RETURN seconds. Fails when one does not, when a node ends unkilled, or
when memory grows.
"""

import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter, defaultdict
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numpy as np
import rosgraph
import rospy
import tf2_ros
from chaos_input import Landmarks, Markers, ObjectInput, Places
from made_photos import written_photos
from random_messages import changed
from ros_probe import until
from rosgraph_msgs.msg import Clock
from soak import WARM_UP, free_port, minutes_of, report, sample

from sextant.nodes.base.init_node import mend_rospy

RATE = 10.0  # of good input, Hz
ANSWER, RESTART = 1.0, 20.0  # s until good input is answered: after a fault; after a restart
RETURN = 10.0  # s after a restart in which nodes may still start or register again
FAULT = (0.1, 2.0)  # duration of a fault, s
REST = (0.2, 1.0)  # s of good input between faults
MAX_FAULTS = 3  # at the same time
SAMPLES = 10.0  # s between two samples of memory
GROWTH = 40.0  # MB that a node may grow by: a node holds more or fewer images, of up to 20 MB
PHOTOS = 6
JUMPS = (-1000.0, -10.0, -0.5, 0.5, 10.0, 1000.0)  # of the clock, s
MARKER_MAP = Path(__file__).parents[2] / "test" / "ros" / "two_markers.txt"
START = 60.0  # s until all nodes have started
MANAGER, LOADERS = "sextant_manager", ("marker_detector", "marker_locator")
STILL_LOADED = (
    255  # exit code of a nodelet's loader while the manager still has the nodelet of the killed loader
)
RETRIES = 5  # of a loader, until the manager or the registration_keeper notices that it was killed
ANONYMOUS = re.compile(r"(_[^_]+){3}$")  # what roslaunch appends to the name of a registration_keeper
ENDS_ITSELF = re.compile(
    r"([^\s/]+) is not (?:registered at the master: ends|loaded in its manager: its loader is ended)"
)
# It was started before the parameters of a restarted roscore were restored.
NO_PARAMETERS = re.compile(r"/([^\s/]+)/[^\s/]+: required, but not set")
END = re.compile(
    r"\[(?:[^\][]+/)?([^\][/]+)-\d+\] process has (?:finished cleanly|died \[pid \d+, exit code (-?\d+))"
)


class Robot:
    """Publishes the clock, and good or changed input of all systems, in a thread of its own."""

    def __init__(self, rng):
        self.systems = [Markers(), Landmarks(), Places(PHOTOS), ObjectInput()]
        self.faulty = set()  # topics whose messages are changed
        self.offset = 0.0  # of the clock, s
        self._rng, self._clock = rng, rospy.Publisher("/clock", Clock, queue_size=1)
        self._end = threading.Event()
        self._threads = [threading.Thread(target=each, daemon=True) for each in (self._tick, self._feed)]
        for thread in self._threads:
            thread.start()

    def now(self):
        return time.time() + self.offset

    def close(self):
        self._end.set()
        for thread in self._threads:
            thread.join()

    def _tick(self):
        while not self._end.wait(0.01):
            self._clock.publish(Clock(rospy.Time.from_sec(self.now())))

    def _feed(self):
        while not self._end.wait(1.0 / RATE):
            stamp = rospy.Time.from_sec(self.now())
            for system in self.systems:
                for topic, message in system.messages(stamp):
                    is_faulty = topic in self.faulty
                    system.publish(topic, changed(message, self._rng) if is_faulty else message)


class Machine:
    """roscore and the nodes of chaos.launch, and what can happen to them."""

    def __init__(self, folder, log):
        self.port, self._log = free_port(), log
        self.uri = f"http://localhost:{self.port}"
        os.environ["ROS_MASTER_URI"] = self.uri
        self.killed = []  # names of nodes
        self._start_core()
        arguments = [f"places:={folder}/park.txt", f"marker_map:={MARKER_MAP}"]
        launch = Path(__file__).with_name("chaos.launch")
        self.launch = subprocess.Popen(
            ["roslaunch", str(launch), *arguments], stdout=log, stderr=subprocess.STDOUT
        )

    def _start_core(self):
        self._core = subprocess.Popen(
            ["rosmaster", "--core", "-p", str(self.port)], stdout=self._log, stderr=subprocess.STDOUT
        )
        if not until(rosgraph.is_master_online):
            raise TimeoutError("roscore does not start")

    def restart_core(self):
        self._core.kill()
        self._core.wait()
        self._start_core()

    def pids(self):
        """{node: process} of the launched nodes."""
        found = {}
        for path in Path("/proc").glob("[0-9]*/cmdline"):
            try:
                words = path.read_bytes().decode(errors="replace").split("\0")
                parent = int(Path(path.parent, "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
            name = next((word[8:] for word in words if word.startswith("__name:=")), None)
            if name and parent == self.launch.pid:
                found[name] = int(path.parent.name)
        return found

    def kill(self, rng):
        """Kills one node; returns its name."""
        pids = self.pids()
        name = sorted(pids)[int(rng.integers(len(pids)))]
        os.kill(pids[name], signal.SIGKILL)
        self.killed.append(name)
        return name

    def close(self):
        try:
            self.launch.send_signal(signal.SIGINT)
            self.launch.wait(60)
        finally:
            self._core.kill()
            self._core.wait()


@contextmanager
def stalled_viewer(topics):
    """A remote machine whose link is down: it has subscribed to everything and takes nothing."""
    viewers = [
        subprocess.Popen(["rostopic", "echo", "--noarr", each], stdout=subprocess.DEVNULL) for each in topics
    ]
    time.sleep(1.5)
    for each in viewers:
        each.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        for each in viewers:
            each.kill()
            each.wait()


def answered(systems, since, limit):
    """{system: seconds} until good input of a stamp or later was answered; None: it was not."""
    begin, found = time.monotonic(), {}
    while time.monotonic() - begin < limit and len(found) < len(systems):
        for system in systems:
            if system not in found and system.answers_since(since):
                found[system] = time.monotonic() - begin
        time.sleep(0.02)
    return {system: found.get(system) for system in systems}


class Chaos:
    """Makes faults, and keeps what followed."""

    def __init__(self, robot, machine, rng):
        self._robot, self._machine, self._rng = robot, machine, rng
        self._begin = time.monotonic()
        self._restart = -np.inf  # time of the last restart of a node or of roscore, s
        self._end = ExitStack()  # of the faults of now
        self.times = defaultdict(list)  # {fault: seconds until all systems answered; inf: not all did}
        self.failures = []

    def run_once(self):
        """One to MAX_FAULTS faults at once, then good input, which must be answered."""
        others = (self._jump, self._kill, self._restart_core, self._stall)
        kinds = 3 * (self._damage,) + others
        number = int(self._rng.integers(1, MAX_FAULTS + 1))
        with self._end:
            faults = [kinds[int(i)]() for i in self._rng.choice(len(kinds), number, replace=False)]
            time.sleep(self._rng.uniform(*FAULT))
        is_restart = time.monotonic() - self._restart < RETURN
        self._check(faults, RESTART if is_restart else ANSWER)
        time.sleep(self._rng.uniform(*REST))

    def _check(self, faults, limit):
        since = rospy.Time.from_sec(self._robot.now())
        found = answered(self._robot.systems, since, limit)
        silent = [system.name for system, seconds in found.items() if seconds is None]
        for fault in faults:
            self.times[fault].append(np.inf if silent else max(found.values()))
        if silent:
            seconds = time.monotonic() - self._begin
            text = f"{', '.join(faults)}: no answer of {', '.join(silent)} within {limit:g} s"
            self.failures.append(f"after {seconds:.1f} s ({time.strftime('%H:%M:%S')}): {text}")
            print(self.failures[-1], flush=True)
            answered(self._robot.systems, since, RESTART)  # the next fault finds a working system

    def _damage(self):
        system = self._robot.systems[int(self._rng.integers(len(self._robot.systems)))]
        topic = list(system.topics)[int(self._rng.integers(len(system.topics)))]
        self._robot.faulty.add(topic)
        self._end.callback(self._robot.faulty.discard, topic)
        return f"damaged {topic}"

    def _jump(self):
        jump = JUMPS[int(self._rng.integers(len(JUMPS)))]
        self._robot.offset += jump
        return f"clock jump of {jump:g} s"

    def _kill(self):
        self._restart = time.monotonic()
        return f"killed {ANONYMOUS.sub('', self._machine.kill(self._rng))}"

    def _restart_core(self):
        self._machine.restart_core()
        self._restart = time.monotonic()
        return "roscore restarted"

    def _stall(self):
        self._end.enter_context(stalled_viewer([system.answer[0] for system in self._robot.systems]))
        return "link down"


def unexpected_ends(log, killed):
    """Lines of roslaunch about nodes that ended, but were not killed, and gave no reason for it.

    Loaders end with the manager, too.
    """
    expected, lines = Counter((name, -signal.SIGKILL) for name in killed), []
    expected.update((name, 0) for name in ENDS_ITSELF.findall(log))
    expected.update((name, 1) for name in NO_PARAMETERS.findall(log))
    for name in LOADERS:
        expected[name, 0] += expected[MANAGER, -signal.SIGKILL]
        expected[name, STILL_LOADED] = RETRIES * (expected[name, -signal.SIGKILL] + expected[name, 0])
    for line in log.splitlines():
        end = END.search(line)
        if end is None:
            continue
        key = end[1], int(end[2] or 0)
        expected[key] -= 1
        if expected[key] < 0:
            lines.append(line)
    return lines


class Memory(threading.Thread):
    """Samples all nodes."""

    def __init__(self, machine):
        super().__init__(daemon=True)
        self._rows = defaultdict(list)  # of soak.COLUMNS, by name and process
        self._machine, self._begin = machine, time.monotonic()

    def run(self):
        while True:
            seconds = time.monotonic() - self._begin
            for name, pid in self._machine.pids().items():
                with suppress(OSError, KeyError):  # it was killed
                    name = ANONYMOUS.sub("", name)
                    self._rows[name, pid].append([seconds, name, *sample(pid)])
            time.sleep(SAMPLES)

    def rows(self):
        """The rows of that process of each node that ran longest."""
        longest = {}
        for (name, _), rows in sorted(self._rows.items(), key=lambda each: len(each[1])):
            longest[name] = rows
        return [row for rows in longest.values() for row in rows if rows[-1][0] >= WARM_UP]


def print_times(times):
    """Prints how long the systems took to answer after each fault."""
    heads = ("number", "median, s", "worst", "no answer")
    print(f"{'fault (others may be at the same time)':42}" + "".join(f" {head:>10}" for head in heads))
    for fault, seconds in sorted(times.items()):
        good = [each for each in seconds if np.isfinite(each)]
        median, worst = (np.median(good), max(good)) if good else (np.nan, np.nan)
        print(f"{fault:42} {len(seconds):10d} {median:10.2f} {worst:10.2f} {len(seconds) - len(good):10d}")


def main():
    minutes, seed, log_path = minutes_of(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder, open(log_path, "w+", errors="replace") as log:
        written_photos(Path(folder), PHOTOS)
        machine = Machine(folder, log)
        try:
            chaos, memory = run(machine, 60 * minutes, seed)
        finally:
            machine.close()
        log.seek(0)
        ends = unexpected_ends(log.read(), machine.killed)
    print_times(chaos.times)
    print("\n".join(ends) or f"no node ended besides the {len(machine.killed)} that were killed")
    is_flat = report(memory.rows(), GROWTH, judge_threads=False)  # rospy has some for each connection
    print(f"the log of the nodes is {log_path}")
    sys.exit(0 if is_flat and not ends and not chaos.failures else 1)


def run(machine, seconds, seed):
    """(Chaos, Memory) after so many seconds of faults."""
    mend_rospy()
    rospy.init_node("chaos", disable_signals=True)
    robot = Robot(np.random.default_rng([seed, 0]))
    try:
        mounts = tf2_ros.StaticTransformBroadcaster()
        mounts.sendTransform([each for system in robot.systems for each in system.static_transforms()])
        started = answered(robot.systems, rospy.Time.from_sec(robot.now()), START)
        if None in started.values():
            sys.exit(f"chaos: not all systems have started: { {s.name: t for s, t in started.items()} }")
        chaos, memory = Chaos(robot, machine, np.random.default_rng([seed, 1])), Memory(machine)
        memory.start()
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            chaos.run_once()
        return chaos, memory
    finally:
        robot.close()


if __name__ == "__main__":
    main()

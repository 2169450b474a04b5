# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the demo for a long time and monitors memory and threads of its nodes. Called by soak.sh."""

import csv
import os
import re
import signal
import socket
import statistics
import subprocess
import sys
import time
from pathlib import Path
from xmlrpc.client import ServerProxy

PERIOD = 10.0  # s between two samples
WARM_UP = 60.0  # s that are ignored
SETTLED = 6  # samples whose median is the initial and the final level
GROWTH = 5.0  # MB that a node may grow by
START = 120.0  # s within which the nodes must be there
NODES = 6  # simulator, manager, detector's and locators' loaders, broadcaster, drive_recorder: at least
RECORDER = "/drive_recorder"  # stores all poses for its table: ignored
COLUMNS = ["seconds", "node", "rss_mb", "threads", "cpu_seconds"]


def free_port():
    with socket.socket() as unbound:
        unbound.bind(("localhost", 0))
        return unbound.getsockname()[1]


def node_pids(master):
    """{name: process} of the nodes that answer."""
    apis = {}
    for group in master.getSystemState("/soak")[2]:
        for _, nodes in group:
            apis.update({name: master.lookupNode("/soak", name)[2] for name in nodes})
    return {name: ServerProxy(api).getPid("/soak")[2] for name, api in apis.items()}


def sample(pid):
    """(MB in memory, threads, seconds of CPU) of a process."""
    status = Path(f"/proc/{pid}/status").read_text()
    rows = dict(re.findall(r"^(\w+):\s+(\d+)", status, re.M))
    kilobytes, threads = int(rows["VmRSS"]), int(rows["Threads"])
    times = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return kilobytes / 1024, threads, sum(map(int, times)) / os.sysconf("SC_CLK_TCK")


def started_nodes(master):
    """node_pids() when they are all there and no more come.

    :raises RuntimeError: they do not come
    """
    end, before = time.monotonic() + START, {}
    while time.monotonic() < end:
        time.sleep(5.0)
        try:
            pids = node_pids(master)
        except OSError:  # no master yet, or a node that is about to begin
            continue
        if len(pids) >= NODES and pids == before:
            return pids
        before = pids
    raise RuntimeError(f"the demo has not started within {START:.0f} s: {sorted(before)}")


def watch(pids, minutes, path):
    """Rows of COLUMNS, also written to a file as they come.

    :raises RuntimeError: a node has died
    """
    rows, begin = [], time.monotonic()
    with open(path, "w", newline="", buffering=1) as file:
        table = csv.writer(file)
        table.writerow(COLUMNS)
        while time.monotonic() - begin <= 60 * minutes:
            seconds = round(time.monotonic() - begin, 1)
            for name, pid in sorted(pids.items()):
                try:
                    rows.append([seconds, name, *sample(pid)])
                except (OSError, TypeError) as error:
                    raise RuntimeError(f"{name} died after {seconds:.0f} s") from error
                table.writerow(rows[-1])
            time.sleep(PERIOD)
    return rows


def verdict(rows, name):
    """(MB at the begin, at the end, most; threads at the begin, at the end; cores in use) of a node."""
    of_node = [row for row in rows if row[1] == name and row[0] >= WARM_UP]
    begin, end = of_node[:SETTLED], of_node[-SETTLED:]
    memory = [statistics.median(row[2] for row in part) for part in (begin, end)]
    threads = [max(row[3] for row in part) for part in (begin, end)]
    cores = (end[-1][4] - begin[0][4]) / max(end[-1][0] - begin[0][0], PERIOD)
    return (*memory, max(row[2] for row in of_node), *threads, cores)


def report(rows, growth=GROWTH, judge_threads=True):
    """Prints the table; whether memory (and threads, if they are judged) stayed what they were.

    :param growth: MB that a node may grow by
    """
    print(f"{'node':28} {'MB at 1 min':>12} {'at the end':>12} {'most':>8} {'threads':>12} {'cores':>6}")
    flat = True
    for name in sorted({row[1] for row in rows}):
        begin, end, most, first, last, cores = verdict(rows, name)
        judged = name != RECORDER
        grows = end - begin > growth or (judge_threads and last > first)
        bad = judged and grows
        flat &= not bad
        remark = "" if judged else "  records the drive: ignored"
        print(
            f"{name:28} {begin:12.1f} {end:12.1f} {most:8.1f} {first:5d} -> {last:3d} {cores:6.2f}"
            + ("  GROWS" if bad else remark)
        )
    threads = ", or more threads than at the beginning" if judge_threads else ""
    print("flat" if flat else f"NOT FLAT: more than {growth:.0f} MB{threads}")
    return flat


def minutes_of(text):
    """A duration that is long enough, minutes; otherwise the program ends."""
    if 60 * float(text) < WARM_UP + 2 * PERIOD:
        sys.exit("soak: at least 2 minutes, the first of which is ignored")
    return float(text)


def main():
    minutes, path = minutes_of(sys.argv[1]), sys.argv[2]
    port = free_port()
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    arguments = ["headless:=true", "frames:=0", "speed:=1.0", "plot:=none"]
    with open(path + ".log", "w") as log:
        demo = subprocess.Popen(
            ["roslaunch", "-p", str(port), "sextant", "demo.launch", *arguments], stdout=log, stderr=log
        )
        try:
            rows = watch(started_nodes(ServerProxy(os.environ["ROS_MASTER_URI"])), minutes, path)
        except RuntimeError as error:
            sys.exit(f"soak: {error}; the demo's log is {path}.log")
        finally:
            demo.send_signal(signal.SIGINT)
            demo.wait(60)
    print(f"{minutes:g} minutes, a sample every {PERIOD:g} s in {path}")
    sys.exit(0 if report(rows) else 1)


if __name__ == "__main__":
    main()

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Many bags in one process, in two, and on a cluster of two workers: how long, and whether all agree."""

import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Sequence

import genpy
import numpy as np
import openpyxl
import rosbag
from std_msgs.msg import Header
from tables import Row, Table, Value

import sextant
from mapping.simulated_series import DISTANCES, rendered_marker
from sextant.base.jobs import package_folder
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.simulation.camera import camera_calibration

FAMILY = "tag36h11"  # searched for in 30 ms of an image
BAGS = 8
COMMAND = [sys.executable, str(Path(__file__).resolve().parents[2] / "scripts/accuracy_statistics")]
PATIENCE = 60.0  # seconds


class Run(NamedTuple):
    """One call of the command."""

    seconds: float
    output: str
    cells: list  # of all sheets


def bag_tables(quick: bool) -> List[Table]:
    """Of accuracy_statistics; a quick run is two bags of a few images, without a bar."""
    bags, images = (2, 25) if quick else (BAGS, 200)
    with tempfile.TemporaryDirectory() as folder:
        write_series(Path(folder) / "series", bags, images)
        runs = {"--jobs 1": _run(folder), "--jobs 2": _run(folder, "--jobs", "2")}
        with _cluster(folder) as address:
            runs["two Dask workers"] = _run(folder, "--scheduler", address)
    return [Table(f"{bags} bags of {images} images", ["s", "of --jobs 1", "differs"], _rows(runs, quick))]


def _rows(runs: Dict[str, Run], quick: bool) -> List[Row]:
    one = runs["--jobs 1"]
    return [
        (
            name,
            [
                Value(run.seconds, 1),
                Value(run.seconds / one.seconds, at_most=0.6 if name == "--jobs 2" and not quick else None),
                Value(float((run.output, run.cells) != (one.output, one.cells)), 0, at_most=0),
            ],
        )
        for name, run in runs.items()
    ]


def write_series(folder: Path, bags: int, images: int) -> None:
    """A folder a distance, each with a bag of rendered images."""
    known = camera_calibration(640, 480)
    rendered = rendered_marker(known, FAMILY)
    for distance in DISTANCES[:bags]:
        T_marker_camera = sextant.pose_from_xyz_rpy([0.0, 0.0, distance], [np.pi, 0.0, 0.0])
        (folder / str(distance)).mkdir(parents=True)
        with rosbag.Bag(str(folder / str(distance) / "still.bag"), "w") as bag:
            for k in range(images):
                header = Header(stamp=genpy.Time.from_sec(1.0 + 0.1 * k), frame_id="camera")
                image = image_to_message(rendered(T_marker_camera, k), header)
                bag.write("/camera/image_raw", image, header.stamp)
                bag.write("/camera/camera_info", calibration_to_message(known, header), header.stamp)


def _run(folder: str, *options: str) -> Run:
    """:raises OSError: the command refused, or did not end"""
    output = Path(folder) / "out"
    shutil.rmtree(output, ignore_errors=True)
    output.mkdir()
    arguments = [f"{folder}/series", "-o", str(output / "accuracy"), "--family", FAMILY, *options]
    begin = time.perf_counter()
    try:
        done = subprocess.run([*COMMAND, *arguments], stdout=subprocess.PIPE, text=True, timeout=600)
    except subprocess.TimeoutExpired as error:
        raise OSError(str(error)) from None
    seconds = time.perf_counter() - begin
    if done.returncode:
        raise OSError(f"accuracy_statistics ended with exit code {done.returncode}")
    book = openpyxl.load_workbook(output / "accuracy.xlsx")
    return Run(seconds, done.stdout, [list(sheet.values) for sheet in book.worksheets])


@contextlib.contextmanager
def _cluster(folder: str) -> Iterator[str]:
    """Address of a Dask scheduler with two workers on this machine.

    :raises OSError: Dask is not installed, or does not start
    """
    path = os.pathsep.join([package_folder(), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path, "OMP_NUM_THREADS": "1"}
    contact = Path(folder) / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder, "env": environment}
    file = ["--scheduler-file", str(contact)]
    with contextlib.ExitStack() as stack:
        for command in _cluster_commands(file):
            process = stack.enter_context(subprocess.Popen(command, **quiet))
            stack.callback(process.kill)
        end = time.monotonic() + PATIENCE
        while not _address(contact):
            if time.monotonic() > end:
                raise OSError("the Dask scheduler did not start")
            time.sleep(0.1)
        yield _address(contact)


def _cluster_commands(file: Sequence[str]) -> List[List[str]]:
    local = ["--no-dashboard", *file]
    worker = ["dask-worker", "--no-nanny", "--nthreads", "1", *local]
    return [["dask-scheduler", "--host", "127.0.0.1", "--port", "0", *local], worker, worker]


def _address(contact: Path) -> str:
    """Empty while it is not there, or half written."""
    try:
        return json.loads(contact.read_text())["address"]
    except (FileNotFoundError, json.JSONDecodeError):
        return ""

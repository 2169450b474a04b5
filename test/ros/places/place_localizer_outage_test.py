#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import rostest
from made_photos import written_photos
from ros_probe import WAIT, until


class PlaceLocalizerOutageTest(unittest.TestCase):
    """With a master of its own, that goes away."""

    def begin(self, *command, **more):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **more)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def test_it_outlives_its_master(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        written_photos(Path(folder.name), 2)
        with socket.socket() as free:
            free.bind(("localhost", 0))
            port = str(free.getsockname()[1])
        master = self.begin("rosmaster", "--core", "-p", port)
        environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{port}"}
        given = f"_map_file:={folder.name}/park.txt"
        node = self.begin("rosrun", "sextant", "place_localizer", given, env=environment, text=True)
        self.assertTrue(until(lambda: "2 photos of 2 places" in node.stdout.readline(), WAIT))
        master.terminate()
        master.wait(WAIT)
        time.sleep(2.0)  # in which the diagnostics are due
        self.assertIsNone(node.poll())
        node.terminate()
        output, _ = node.communicate(timeout=WAIT)
        self.assertNotIn("Traceback", output)


if __name__ == "__main__":
    rostest.rosrun("sextant", "place_localizer_outage", PlaceLocalizerOutageTest)

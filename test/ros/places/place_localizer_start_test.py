#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import rostest
from made_photos import written_photos
from ros_probe import WAIT, until

KILLED = 15.0  # seconds that roslaunch waits after SIGINT
PHOTOS = [f"{number};{number}.png;1;1" for number in range(3)]


class PlaceLocalizerStartTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        written_photos(self.folder, len(PHOTOS))
        (self.folder / "text.png").write_text("text")

    def write(self, name, *rows, fields=""):
        (self.folder / name).write_text("\n".join([f"overview.png;1000;100{fields}", *PHOTOS, *rows]))
        return f"_map_file:={self.folder / name}"

    def start(self, name, given):
        node = subprocess.Popen(
            ["rosrun", "sextant", "place_localizer", f"__name:={name}", *given],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.addCleanup(node.communicate)
        self.addCleanup(node.kill)
        return node

    def test_what_stops_the_start_up_is_named(self):
        good, broken = self.write("good.txt"), self.write("broken.txt", fields=";frame=town")
        lacking = self.write("lacking.txt", "3;13.png;1;1", "4;14.png;1;1")
        spoilt, outside = (
            self.write("spoilt.txt", "3;text.png;1;1"),
            self.write("outside.txt", "3;../out.png;1;1"),
        )
        refused = [
            ([broken], "broken.txt:1: the fields after the size must be all of (frame, resolution, origin"),
            ([lacking], "lacking.txt: missing photos: 13.png, 14.png"),
            ([spoilt], "text.png: is not an image"),
            ([outside], "outside.txt:5: image '../out.png' is outside of the map's folder"),
            ([good, "_modus:=votes"], "/refused4/modus: unknown parameter; did you mean mode?"),
            ([good, "_mode:=votes", "_matcher:=BruteForce-Hamming"], "/refused5: matcher"),
        ]
        nodes = [self.start(f"refused{i}", given) for i, (given, _) in enumerate(refused)]
        for node, (_, reason) in zip(nodes, refused):
            output, _ = node.communicate(timeout=WAIT)
            self.assertEqual(node.returncode, 1, output)
            self.assertIn(reason, output)
            self.assertNotIn("Traceback", output)

    def test_a_signal_ends_it_while_the_photos_are_described(self):
        rows = [f"{number};{number}.png;1;1" for number in range(len(PHOTOS), 4000)]
        for row in rows:
            os.link(self.folder / "0.png", self.folder / row.split(";")[1])
        path = self.folder / "log"
        with open(path, "w") as log:
            given = [self.write("many.txt", *rows), "_jobs:=2"]
            node = subprocess.Popen(["rosrun", "sextant", "place_localizer", *given], stdout=log, stderr=log)
        self.addCleanup(node.wait)
        self.addCleanup(node.kill)
        self.assertTrue(until(lambda: "describing 4000 photos" in path.read_text(), WAIT))
        time.sleep(2.0)  # in which the other processes start
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(KILLED), 0)
        for word in ("ready after", "died", "Traceback"):
            self.assertNotIn(word, path.read_text())


if __name__ == "__main__":
    rostest.rosrun("sextant", "place_localizer_start", PlaceLocalizerStartTest)

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The launch file of a demo as it is, with its maps in a new folder."""

import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

# Debian 11: roslaunch calls a method that its Python does not have, when everything has ended.
OF_ROSLAUNCH = """Traceback (most recent call last):
  File "/usr/lib/python3/dist-packages/roslaunch/pmon.py", """


class DemoTest(unittest.TestCase):
    """Starts LAUNCH with ARGS; fails at the end if one of UNWANTED is in its output."""

    LAUNCH, ARGS = "", {}
    UNWANTED = ("SIGKILL", "Traceback")

    @classmethod
    def setUpClass(cls):
        folder = Path(tempfile.mkdtemp(prefix="a demo "))
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)  # a node may still write a cache there
        cls.folder, cls.log = folder / "map", folder / "log"
        args = [f"{name}:={value}" for name, value in cls.ARGS.items()]
        command = ["roslaunch", "sextant", cls.LAUNCH, f"folder:={cls.folder}", *args]
        with open(cls.log, "w") as log:
            cls.demo = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        cls.addClassCleanup(cls.stop)

    @classmethod
    def stop(cls):
        cls.demo.send_signal(signal.SIGINT)
        try:
            cls.demo.wait(60)
        finally:
            cls.demo.kill()
        log = cls.log.read_text().replace(OF_ROSLAUNCH, "")
        assert not any(each in log for each in cls.UNWANTED), log

# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Starts Python nodes with parameters that cannot be."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import rospy


def assert_refused(case, node, mistakes, **given):
    """Each mistake ends the node, /bad, with status 1 and a reason.

    :param case: unittest.TestCase
    :param node: module of sextant.nodes, with its room: "simulation.simulator"
    :param mistakes: (parameter, value as text, what the reason has in it)
    :param given: parameters that are right, as text
    """
    code = f"from sextant.nodes.{node} import main; main()"

    def start(number):
        parameter, value, _ = mistakes[number]
        options = {**given, parameter: value}
        command = [sys.executable, "-c", code, f"__name:=bad{number}"]
        command += [f"_{key}:={text}" for key, text in options.items()]
        return subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60, check=False
        )

    with ThreadPoolExecutor(os.cpu_count()) as starters:
        ended = list(starters.map(start, range(len(mistakes))))
    for number, (done, (*_, reason)) in enumerate(zip(ended, mistakes)):
        rospy.delete_param(f"/bad{number}")
        output = done.stdout.decode().replace(f"/bad{number}", "/bad")
        case.assertEqual(done.returncode, 1, output)
        case.assertIn(reason, output)
        case.assertIn("/bad", output)

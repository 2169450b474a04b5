# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Starts Python nodes with parameters that cannot be."""

import subprocess
import sys

import rospy

NAME = "bad"  # of the node


def assert_refused(case, node, mistakes, **given):
    """Each mistake ends the node with status 1 and a reason.

    :param case: unittest.TestCase
    :param node: module of sextant.nodes
    :param mistakes: (parameter, value as text, what the reason has in it)
    :param given: parameters that are right, as text
    """
    for name, value, reason in mistakes:
        options = {**given, name: value}
        code = f"from sextant.nodes.{node} import main; main()"
        command = [sys.executable, "-c", code, f"__name:={NAME}"]
        command += [f"_{key}:={text}" for key, text in options.items()]
        ended = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60, check=False
        )
        for key in options:
            rospy.delete_param(f"/{NAME}/{key}")
        output = ended.stdout.decode()
        case.assertEqual(ended.returncode, 1, output)
        case.assertIn(reason, output)
        case.assertIn(f"/{NAME}", output)
